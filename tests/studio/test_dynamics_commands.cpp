// The commands simulate, predict, region and linear as a user runs them.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "tests/support/support.h"

namespace underbody::test {

namespace {

class DynamicsCommands : public testing::Test {
protected:
    core::TemporaryFolder folder_;
    void SetUp() override {
        core::write_file(folder_.path() / "lift.csv",
                         "gap [mm], lift_force [N]\n1, 0.1\n2, 0.02\n5, -0.03\n10, -0.04\n20, -0.01\n50, 0.04\n100, 0.05\n300, 0.01\n");
        core::write_file(folder_.path() / "model.toml",
                         "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\n[drag.heave]\nlinear = 0.3\nquadratic = 6\n"
                         "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
    }
    nlohmann::json json(std::vector<std::string> arguments) {
        arguments.emplace_back("--json");
        const auto run = run_underbody(arguments, folder_.path());
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        return nlohmann::json::parse(run.output);
    }
};

TEST_F(DynamicsCommands, SimulateWritesTheMotionAndAPicture) {
    const auto run = run_underbody({"simulate", "model.toml", "--from", "gap=10mm", "--for", "20", "--step", "0.1", "--out", "run.csv", "--plot", "run.png"},
                                   folder_.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const core::Table table = core::read_csv(folder_.path() / "run.csv");
    EXPECT_EQ(table.rows(), 201U);
    EXPECT_NEAR(table.numbers("time").back(), 20, 1e-9);
    EXPECT_NEAR(table.numbers("gap").front(), .01, 1e-12);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "run.png"));
}

TEST_F(DynamicsCommands, SimulateRefusesAStartInTheGroundAndAStartWithoutAGap) {
    EXPECT_EQ(run_underbody({"simulate", "model.toml", "--from", "gap=-1mm"}, folder_.path()).exit_code, 3);
    EXPECT_EQ(run_underbody({"simulate", "model.toml", "--from", "heave_velocity=0"}, folder_.path()).exit_code, 2);
    const auto typo = run_underbody({"simulate", "model.toml", "--from", "gpa=1mm"}, folder_.path());
    EXPECT_NE(typo.exit_code, 0);
    EXPECT_NE(typo.errors.find("gap"), std::string::npos);
}

TEST_F(DynamicsCommands, RegionGivesClassesFractionsAndTheEndsOfGivenStarts) {
    const nlohmann::json map = json({"region", "model.toml", "--axes", "gap=0:0.3,heave_velocity=-0.1:0.1", "--grid", "60x60", "--out", "region.png"});
    double sum = 0;
    bool attractor = false;
    for (const auto& end : map["classes"]) {
        sum += end["fraction"].get<double>();
        attractor = attractor || end["kind"] == "attractor";
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_TRUE(attractor);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "region.png"));
    core::write_file(folder_.path() / "starts.csv", "gap [mm], heave_velocity [m/s]\n2.2, 0\n3, -0.2\n250, 0.1\n");
    const nlohmann::json ends = json({"region", "model.toml", "--starts", "starts.csv", "--table", "ends.csv"});
    ASSERT_EQ(ends["starts"].size(), 3U);
    EXPECT_EQ(ends["starts"][0]["class"], "A");
    EXPECT_EQ(ends["starts"][1]["class"], "contact");
    EXPECT_EQ(ends["starts"][2]["class"], "escape");
    EXPECT_EQ(core::read_csv(folder_.path() / "ends.csv").rows(), 3U);
}

TEST_F(DynamicsCommands, RegionWithFeedbackHoldsMore) {
    const std::vector<std::string> open{"region", "model.toml", "--axes", "gap=1mm:40mm,heave_velocity=-0.05:0.05", "--grid", "40x40"};
    std::vector<std::string> closed = open;
    closed.insert(closed.end(), {"--feedback", "gap_gain=20,velocity_gain=15,reference=10mm"});
    const auto safe = [](const nlohmann::json& map) {
        double sum = 0;
        for (const auto& end : map["classes"]) {
            sum += end["kind"] == "attractor" ? end["fraction"].get<double>() : 0.0;
        }
        return sum;
    };
    EXPECT_GT(safe(json(closed)), safe(json(open)));
}

TEST_F(DynamicsCommands, LinearNamesItsModes) {
    const nlohmann::json found = json({"linear", "model.toml"});
    ASSERT_GE(found["heave"].size(), 2U);
    EXPECT_TRUE(found["heave"][0]["stable"].get<bool>());
    EXPECT_EQ(found["heave"][0]["modes"][0]["name"], "heave");
    EXPECT_EQ(found["heave"][0]["controllability"]["rank"], 2);
}

TEST_F(DynamicsCommands, PredictGivesErrorsInUnitsOfNoise) {
    UNDERBODY_NEEDS_SHARED("examples/loop/example-02/model.toml");
    const std::string example = (shared_folder() / "examples/loop/example-02").string();
    const nlohmann::json found = json({"predict", example + "/model.toml", "--data", example, "--out", "pred.csv"});
    EXPECT_NEAR(found["channels"]["gap"]["in_noise"].get<double>(), 1, .15);
    EXPECT_EQ(found["channels"]["gap"]["unit"], "m");
    const core::Table table = core::read_csv(folder_.path() / "pred.csv");
    for (const char* column : {"window", "time", "gap", "gap_predicted"}) {
        EXPECT_NE(table.find(column), nullptr) << column;
    }
}

}  // namespace

}  // namespace underbody::test
