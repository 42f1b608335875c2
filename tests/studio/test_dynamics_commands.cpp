// The commands simulate, predict, region and linear as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
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
                         "gap [mm], lift_force [N]\n1, 0.1\n2, 0.02\n5, -0.03\n10, -0.04\n20, -0.01\n50, 0.04\n100, "
                         "0.05\n300, 0.01\n");
        core::write_file(
            folder_.path() / "model.toml",
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
    const auto run = run_underbody({"simulate", "model.toml", "--from", "gap=10mm", "--for", "20", "--step", "0.1",
                                    "--out", "run.csv", "--plot", "run.png"},
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
    const nlohmann::json map = json({"region", "model.toml", "--axes", "gap=0:0.3,heave_velocity=-0.1:0.1", "--grid",
                                     "60x60", "--out", "region.png"});
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
    const std::vector<std::string> open{"region", "model.toml", "--axes", "gap=1mm:40mm,heave_velocity=-0.05:0.05",
                                        "--grid", "40x40"};
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

// A place across the heading, which itself stays: two zeros with one eigenvector. Both were called east.
TEST_F(DynamicsCommands, LinearNamesWhatNothingBringsBackOnce) {
    const std::string evie = (source_folder() / "cases/evie/model.toml").string();
    std::vector<std::string> still;
    const nlohmann::json found = json({"linear", evie, "--at", "gap=10mm,speed=0.5m/s"});
    for (const auto& mode : found["body"]["modes"]) {
        if (mode["neutral"].get<bool>()) {
            still.push_back(mode["name"]);
        }
    }
    std::sort(still.begin(), still.end());
    EXPECT_EQ(still, (std::vector<std::string>{"east", "heading", "north"}));
}

TEST_F(DynamicsCommands, SimulateFollowsEvieInEveryMotion) {
    const std::string evie = (source_folder() / "cases/evie/model.toml").string();
    const nlohmann::json both =
        json({"simulate", evie, "--from", "gap=20mm,pitch=1deg", "--for", "2", "--step", "0.1", "--plot", "both.png"});
    EXPECT_EQ(both["pitch"].size(), 21U);
    EXPECT_NEAR(both["pitch"][0].get<double>(), .0174533, 1e-6);
    const nlohmann::json whole =
        json({"simulate", evie, "--motion", "body", "--from", "gap=20mm,speed=0.35m/s", "--thrust", "J1=0.2N,J2=0.2N",
              "--for", "1", "--step", "0.1", "--out", "body.csv", "--plot", "body.png"});
    EXPECT_EQ(whole["p"].size(), 11U);
    EXPECT_NEAR(core::read_csv(folder_.path() / "body.csv").numbers("J1").back(), .2, 1e-9);
    const nlohmann::json ground =
        json({"simulate", evie, "--motion", "surface", "--from", "speed=0.1m/s", "--hold", "heading=10deg,speed=0.1m/s",
              "--for", "20", "--step", "0.5", "--plot", "surface.png"});
    EXPECT_EQ(ground["end"], "time");
    EXPECT_NEAR(ground["psi"].back().get<double>(), .1745, .02);
    // Thrusts from a file, by the jets' names.
    core::write_file(folder_.path() / "thrusts.csv", "time [s], J1 [N], J2 [N]\n0, 0, 0\n1, 0.2, 0.1\n2, 0.2, 0.1\n");
    const nlohmann::json driven =
        json({"simulate", evie, "--from", "gap=30mm", "--inputs", "thrusts.csv", "--for", "2", "--step", "0.5"});
    EXPECT_LT(driven["r"].back().get<double>(), 0);  // the stronger starboard jet turns the bow to port
    const auto mixed = run_underbody(
        {"simulate", evie, "--motion", "heave", "--from", "gap=20mm", "--thrust", "J1=0.1N"}, folder_.path());
    EXPECT_EQ(mixed.exit_code, 2);
    const auto typo = run_underbody(
        {"simulate", evie, "--motion", "body", "--from", "gap=20mm", "--thrust", "J11=0.1N"}, folder_.path());
    EXPECT_NE(typo.exit_code, 0);
    EXPECT_NE(typo.errors.find("J1"), std::string::npos);
}

TEST_F(DynamicsCommands, LqrHoldsHeaveWhereTheFreeMotionLeaves) {
    const std::vector<std::string> free{"simulate", "model.toml", "--from", "gap=15mm", "--for", "60", "--step", "1"};
    std::vector<std::string> held = free;
    held.insert(held.end(), {"--lqr", "reference=15mm,gap=400"});
    EXPECT_NEAR(json(held)["gap"].back().get<double>(), .015, 3e-3);
    EXPECT_GT(std::abs(json(free)["gap"].back().get<double>() - .015), .005);
    std::vector<std::string> two = held;
    two.insert(two.end(), {"--feedback", "gap_gain=1"});
    EXPECT_EQ(run_underbody(two, folder_.path()).exit_code, 2);
    EXPECT_EQ(
        run_underbody({"simulate", "model.toml", "--from", "gap=15mm", "--lqr", "gap=4"}, folder_.path()).exit_code, 2);
}

TEST_F(DynamicsCommands, RegionsOfHeaveAndPitchSweepsAndStartsWithPitch) {
    const std::string evie = (source_folder() / "cases/evie/model.toml").string();
    const nlohmann::json map = json({"region", evie, "--axes", "gap=1mm:30mm,pitch=-3deg:3deg", "--grid", "16x12",
                                     "--for", "20", "--safe", "--out", "pitch.png"});
    double sum = 0;
    for (const auto& end : map["classes"]) {
        sum += end["fraction"].get<double>();
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "pitch.png"));
    core::write_file(folder_.path() / "starts.csv", "gap [mm], pitch [deg]\n1, 3\n20, 0\n");
    EXPECT_EQ(run_underbody({"region", evie, "--starts", "starts.csv"}, folder_.path()).exit_code, 3);  // in the ground
    core::write_file(folder_.path() / "starts.csv", "gap [mm], pitch [deg]\n5, 3\n20, 0\n");
    EXPECT_EQ(json({"region", evie, "--starts", "starts.csv", "--for", "20"})["starts"].size(), 2U);
    const nlohmann::json sweep =
        json({"region", "model.toml", "--axes", "gap=1mm:100mm,heave_velocity=-0.05:0.05", "--grid", "20x20", "--sweep",
              "input_force=-0.01:0.01", "--steps", "3", "--out", "sweep.png", "--shares", "shares.png"});
    ASSERT_EQ(sweep["regions"].size(), 3U);
    EXPECT_NEAR(sweep["regions"][1]["value"].get<double>(), 0, 1e-12);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "shares.png"));
}

TEST_F(DynamicsCommands, LinearSpeaksOfTheRunOnTheGroundAndOfTheJets) {
    const std::string evie = (source_folder() / "cases/evie/model.toml").string();
    const nlohmann::json found =
        json({"linear", evie, "--conditions", "speed=0.1m/s", "--at", "gap=5mm", "--gamma-chart", "gamma.png"});
    EXPECT_EQ(found["heave"].size(), 1U);
    EXPECT_NEAR(found["heave"][0]["gap"].get<double>(), .005, 1e-12);
    EXPECT_EQ(found["heave_pitch"][0]["lqr"]["poles"].size(), 4U);
    const auto& jets = found["surface"]["turning_jets"];
    EXPECT_NEAR(jets["gamma"].get<double>(), .6108652, 1e-5);
    EXPECT_NEAR(jets["beta_without_pitch"].get<double>(), jets["beta"].get<double>(), 1e-5);
    EXPECT_LT(jets["yaw_per_difference"]["zero"].get<double>(), 0);  // inward jets: minimum phase
    EXPECT_EQ(found["surface"]["controllability_by_jets"]["rank"], 4);
    EXPECT_EQ(found["body"]["states"].size(), 10U);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "gamma.png"));
}

TEST_F(DynamicsCommands, WrongModelsAreRefusedWithWhatToDo) {
    const auto errors = [&](const std::string& vehicle, const std::string& rest,
                            const std::vector<std::string>& more = {}) {
        core::write_file(folder_.path() / "wrong.toml", "[vehicle]\n" + vehicle + rest);
        std::vector<std::string> arguments{"simulate", "wrong.toml", "--from", "gap=10mm", "--for", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const auto run = run_underbody(arguments, folder_.path());
        EXPECT_EQ(run.exit_code, 3) << vehicle << rest;
        return run.errors;
    };
    EXPECT_NE(errors("mass = -2.2\n", "").find("accepted is"), std::string::npos);
    EXPECT_NE(errors("mass = \"2.2 N\"\n", "").find("kg"), std::string::npos);
    EXPECT_NE(errors("mass = 2.2\nlength = 203.2\nwidth = 152\n", "").find("mm"), std::string::npos);
    EXPECT_NE(errors("mass = 2200\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\n", "").find("displaces"),
              std::string::npos);
    EXPECT_NE(errors("mass = 2.2\nadded_mass_heave = \"1754 kg\"\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\n", "")
                  .find("vehicle.added_mass_heave = 1754 kg, but a hull of that size displaces"),
              std::string::npos);
    EXPECT_NE(
        errors(
            "mass = 2.2\nroll_inertia = 0.001\npitch_inertia = 0.002\nyaw_inertia = 0.002\ninertia_product_xz = 0.01\n",
            "")
            .find("positive definite"),
        std::string::npos);
    EXPECT_NE(errors("mass = 2.2\nmas = 2.2\n", "").find("mass"), std::string::npos);
    EXPECT_NE(errors("mass = 2.2\n", "[environment]\nkinematic_viscosity = 0.1\n").find("1.0e-6"), std::string::npos);
    EXPECT_NE(errors("mass = 2.2\n", "[contact]\nrestitution = 2\n").find("between 0"), std::string::npos);
    EXPECT_NE(errors("mass = 2.2\n", "[contact]\ngap = \"20 mm\"\n").find("ground"), std::string::npos);
    EXPECT_NE(errors("mass = 2.2\n", "", {"--motion", "body"}).find("inertia"), std::string::npos);
    // A film of ten micrometres is stiff, not fatal; a model without drag says that it never settles.
    core::write_file(
        folder_.path() / "film.toml",
        "[vehicle]\nmass = 2.2\nnet_weight = 0.1\n[[effect]]\nname = \"squeeze_film_damping\"\ncoefficient = 1e-7\n");
    const nlohmann::json film = json({"simulate", "film.toml", "--from", "gap=10e-6", "--for", "5"});
    EXPECT_LE(film["gap"].back().get<double>(), 1e-5);
    core::write_file(folder_.path() / "free.toml",
                     "[vehicle]\nmass = 2.2\n[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
    const auto free =
        run_underbody({"region", "free.toml", "--axes", "gap=1mm:400mm,heave_velocity=-0.05:0.05", "--grid", "20x20"},
                      folder_.path());
    EXPECT_NE(free.output.find("never settles"), std::string::npos) << free.output;
    EXPECT_NE(free.output.find("outside the range"), std::string::npos) << free.output;
    EXPECT_NE(free.output.find("cycle"), std::string::npos) << free.output;
}

TEST_F(DynamicsCommands, PredictSaysBesideTheErrorWhichColumnsItDidNotUse) {
    std::string run = "time [s], gap [m], vz [m/s]\n";
    for (int i = 0; i < 400; ++i) {
        run += std::to_string(0.02 * i) + ", " + std::to_string(0.002 + 1e-5 * (i * 7 % 11)) + ", 0\n";
    }
    core::write_file(folder_.path() / "runs/a.csv", run);
    core::write_file(folder_.path() / "runs/dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n");
    const auto text = run_underbody({"predict", "model.toml", "--data", "runs"}, folder_.path());
    ASSERT_EQ(text.exit_code, 0) << text.errors;
    const std::string said = "the column 'vz' is not used: if it is heave_velocity, name it 'heave_velocity [m/s]'";
    EXPECT_NE(text.output.find(said), std::string::npos) << text.output;
    EXPECT_EQ(json({"predict", "model.toml", "--data", "runs"})["remarks"].at(0), said);
}

TEST_F(DynamicsCommands, PredictSaysHowTheHorizonLiesToTheRuns) {
    std::string run = "time [s], gap [m]\n";
    for (int i = 0; i < 400; ++i) {
        run += std::to_string(0.02 * i) + ", " + std::to_string(0.002 + 1e-5 * (i * 7 % 11)) + "\n";
    }
    core::write_file(folder_.path() / "runs/a.csv", run);
    core::write_file(folder_.path() / "runs/dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n");
    const auto remarks = [&](const std::string& horizon) {
        return json({"predict", "model.toml", "--data", "runs", "--horizon", horizon})["remarks"].dump();
    };
    EXPECT_EQ(remarks("2s").find("horizon"), std::string::npos);
    EXPECT_NE(remarks("100s").find("every run is shorter than the horizon of 100 s: a prediction ends with its run, "
                                   "after 5.98 s at most"),
              std::string::npos)
        << remarks("100s");
    const auto short_one =
        run_underbody({"predict", "model.toml", "--data", "runs", "--horizon", "0.02s"}, folder_.path());
    EXPECT_EQ(short_one.exit_code, 3);
    EXPECT_NE(short_one.errors.find("too short for these runs: their samples lie 0.02 s apart"), std::string::npos)
        << short_one.errors;
    EXPECT_NE(short_one.errors.find("a longer horizon, 0.08 s or more"), std::string::npos) << short_one.errors;
    EXPECT_EQ(
        run_underbody({"predict", "model.toml", "--data", "runs", "--horizon", "0.08s"}, folder_.path()).exit_code, 0);
}

TEST_F(DynamicsCommands, PredictUsesARunThatStandsTwiceOnce) {
    std::string run = "time [s], gap [m]\n";
    for (int i = 0; i < 400; ++i) {
        run += std::to_string(0.02 * i) + ", " + std::to_string(0.002 + 1e-5 * (i * 7 % 11)) + "\n";
    }
    core::write_file(folder_.path() / "runs/a.csv", run);
    core::write_file(folder_.path() / "runs/dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n");
    const nlohmann::json once = json({"predict", "model.toml", "--data", "runs"});
    core::write_file(folder_.path() / "runs/b.csv", run);
    core::write_file(folder_.path() / "runs/dataset.toml",
                     "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n");
    const nlohmann::json twice = json({"predict", "model.toml", "--data", "runs"});
    EXPECT_EQ(twice["channels"], once["channels"]);
    EXPECT_NE(twice["remarks"].dump().find("b is the same as a, reading by reading: used once"), std::string::npos)
        << twice["remarks"];
}

TEST_F(DynamicsCommands, ConditionsThatNothingKnowsAreTold) {
    const std::string said = "nothing in the model depends on jet_voltage: 12 V changes no force";
    const std::vector<std::vector<std::string>> commands = {
        {"simulate", "model.toml", "--from", "gap=10mm", "--for", "1s", "--conditions", "jet_voltage=12V"},
        {"region", "model.toml", "--grid", "4x4", "--for", "1s", "--conditions", "jet_voltage=12V"},
        {"table", "at", "model.toml", "gap=10mm", "--where", "jet_voltage=12V"}};
    for (const auto& command : commands) {
        const auto run = run_underbody(command, folder_.path());
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        EXPECT_NE(run.output.find(said), std::string::npos) << command[0] << run.output;
        EXPECT_NE(json(command)["warnings"].dump().find(said), std::string::npos) << command[0];
    }
}

TEST_F(DynamicsCommands, GapsOfAHundredLengthsAreTold) {
    core::write_file(folder_.path() / "far.csv", "gap [m], lift_force [N]\n1, 0.1\n10, 0.02\n100, -0.03\n");
    core::write_file(folder_.path() / "far.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nlength = \"203.2 mm\"\n[drag.heave]\nlinear = 0.3\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"far.csv\"\n");
    const std::vector<std::vector<std::string>> commands = {
        {"simulate", "far.toml", "--from", "gap=20m", "--for", "1s"},
        {"linear", "far.toml", "--at", "gap=20m"},
        {"table", "equilibria", "far.toml"}};
    for (const auto& command : commands) {
        const nlohmann::json document = json(command);
        EXPECT_NE(document["warnings"].dump().find("are mostly more than 10 lengths of the vehicle"), std::string::npos)
            << command[0] << document["warnings"];
    }
}

TEST_F(DynamicsCommands, RegionRefusesWhatItWouldPassOver) {
    core::write_file(folder_.path() / "other.toml", core::read_file(folder_.path() / "model.toml"));
    const auto both = run_underbody(
        {"region", "model.toml", "--draws", "5", "--with", "other.toml", "--out", "both.png"}, folder_.path());
    EXPECT_EQ(both.exit_code, 2);
    EXPECT_NE(both.errors.find("--draws and --with ask for two different maps"), std::string::npos) << both.errors;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "both.png"));
    EXPECT_EQ(run_underbody({"region", "model.toml", "--with", "other.toml", "--safe"}, folder_.path()).exit_code, 2);
    EXPECT_EQ(run_underbody({"region", "model.toml", "--shares", "s.png"}, folder_.path()).exit_code, 2);
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

TEST_F(DynamicsCommands, LinearTakesAVehicleWithoutJets) {
    core::write_file(folder_.path() / "bare.toml",
                     "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.754\nroll_inertia = 0.005\npitch_inertia = "
                     "0.007\nyaw_inertia = 0.007\n"
                     "base_depth = 0.05\nbase_half_length = 0.07\nnet_weight = 0.05\n[drag.heave]\nlinear = 0.3\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
    const nlohmann::json found = json({"linear", "bare.toml", "--at", "gap=10mm"});
    EXPECT_EQ(found["body"]["controllability"]["rank"], 0);
    for (const auto& mode : found["body"]["modes"]) {
        EXPECT_FALSE(mode["name"].get<std::string>().empty());
    }
}

TEST_F(DynamicsCommands, ASwingWithoutDampingIsNeutralAndNotUnstable) {
    core::write_file(folder_.path() / "undamped.toml",
                     "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.754\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
    std::size_t swings = 0;
    const nlohmann::json found = json({"linear", "undamped.toml"});
    for (const auto& equilibrium : found["heave"]) {
        for (const auto& mode : equilibrium["modes"]) {
            if (mode["imaginary"].get<double>() != 0) {
                ++swings;
                EXPECT_TRUE(mode["neutral"].get<bool>()) << mode;
                EXPECT_NEAR(mode["damping_ratio"].get<double>(), 0, 1e-9);
            } else if (mode["real"].get<double>() > 1e-3) {
                EXPECT_FALSE(mode["neutral"].get<bool>()) << mode;
            }
        }
    }
    EXPECT_GT(swings, 0U);
    const auto text = run_underbody({"linear", "undamped.toml"}, folder_.path()).output;
    EXPECT_NE(text.find("damping ratio 0  neutral\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("-0 +-"), std::string::npos) << text;
}

TEST_F(DynamicsCommands, LinearSaysThatHeaveAloneHoldsThePitch) {
    const std::string evie = (source_folder() / "cases/evie/model.toml").string();
    const auto run = run_underbody({"linear", evie}, folder_.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_NE(run.output.find("pitch held at 0"), std::string::npos) << run.output;
    EXPECT_NE(run.output.find("free to pitch"), std::string::npos) << run.output;
    const nlohmann::json found = json({"linear", evie});
    const bool stable = std::any_of(found["heave_pitch"].begin(), found["heave_pitch"].end(),
                                    [](const auto& e) { return e["stable"].template get<bool>(); });
    EXPECT_EQ(found["stable_in_heave_and_pitch"].get<bool>(), stable);
    EXPECT_EQ(run.output.find("no balance is stable") != std::string::npos, !stable) << run.output;
}

TEST_F(DynamicsCommands, GivenStartsEndAsTheCellsOfTheMapDo) {
    const nlohmann::json map = json({"region", "model.toml", "--axes", "gap=2mm:290mm,heave_velocity=-0.06:0.06",
                                     "--grid", "20x15", "--table", "cells.csv"});
    const core::Table cells = core::read_csv(folder_.path() / "cells.csv");
    core::Table starts;
    starts.add_numbers("gap", "m", cells.numbers("gap"));
    starts.add_numbers("heave_velocity", "m/s", cells.numbers("heave_velocity"));
    core::write_csv(folder_.path() / "starts.csv", starts);
    const nlohmann::json ends = json({"region", "model.toml", "--starts", "starts.csv"});
    int differ = 0;
    for (std::size_t i = 0; i < cells.rows(); ++i) {
        differ += ends["starts"][i]["class"] != cells.text("class")[i] ? 1 : 0;
    }
    EXPECT_EQ(cells.rows(), 300U);
    EXPECT_EQ(differ, 0);
}

TEST_F(DynamicsCommands, TheToleranceActsInEveryMotion) {
    const std::string evie = (source_folder() / "cases/evie/model.toml").string();
    for (const std::vector<std::string>& motion :
         std::vector<std::vector<std::string>>{{"--motion", "surface", "--from", "speed=0.1m/s,sway_velocity=0.02m/s"},
                                               {"--motion", "body", "--from", "gap=20mm,speed=0.2m/s"}}) {
        const auto rows = [&](const char* tolerance) {
            std::vector<std::string> arguments{"simulate", evie, "--for", "2", "--tolerance", tolerance};
            arguments.insert(arguments.end(), motion.begin(), motion.end());
            return json(arguments)["u"].size();
        };
        EXPECT_GT(rows("1e-11"), rows("1e-4") + 5) << motion[1];
    }
}

}  // namespace

}  // namespace underbody::test
