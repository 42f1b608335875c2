// underbody discover as a user runs it, and its model in underbody predict.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "tests/support/support.h"
#include "tests/surrogates/discovery/make_data.h"
#include "tests/surrogates/discovery/surface_rig.h"
#include "tests/surrogates/discovery/write_runs.h"

using namespace underbody;

TEST(DiscoverCommand, WritesReportModelAndJsonAndThePredictionGetsBetter) {
    core::TemporaryFolder folder("discover");
    test::write_bench(
        folder.path(), [](double h, double v) { return test::lift_of(h) * v * v / 100 + 0.004; }, 3);
    const test::ProgramRun run =
        test::run_underbody({"discover", "model.toml", "--data", ".", "--out", "found", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const nlohmann::json json = nlohmann::json::parse(run.output);
    EXPECT_EQ(json["verdict"], "effect");
    EXPECT_EQ(json["effects"][0]["name"], "force_bias");
    const std::string page = core::read_file(folder.path() / "found" / "report.html");
    EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
    const auto error = [&](const std::string& model) {
        const test::ProgramRun predict =
            test::run_underbody({"predict", model, "--data", ".", "--out", "pred.csv", "--json"}, folder.path());
        EXPECT_EQ(predict.exit_code, 0) << predict.errors;
        return nlohmann::json::parse(predict.output)["channels"]["lift_force"]["rmse"].get<double>();
    };
    EXPECT_LT(error("found/model.toml"), 0.5 * error("model.toml"));
}

TEST(DiscoverCommand, RefusesAFolderWithoutDataWithExitCodeThree) {
    core::TemporaryFolder folder("discover");
    test::heave_model(folder.path());
    const test::ProgramRun run =
        test::run_underbody({"discover", "model.toml", "--data", ".", "--out", "found", "--json"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_NE(run.output.find("dataset.toml"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "found"));
}

TEST(DiscoverCommand, ReducesTheLogOfALoadCellByItsPumpOffBlocks) {
    core::TemporaryFolder folder("discover");
    std::string log = "time [s], gap [mm], jet_voltage [V], lift_force [mN]\n";
    int row = 0;
    for (const double volt : {0.0, 8.0, 0.0}) {
        for (int k = 0; k < 20; ++k, ++row) {
            // a zero of 490 mN that drifts by 1 mN in 20 s, and 12 mN of lift
            log += test::written(0.2 * row) + ", 5, " + test::written(volt) + ", " +
                   test::written(490 + 0.01 * row + (volt > 0 ? 12 : 0)) + "\n";
        }
    }
    core::write_file(folder.path() / "log.csv", log);
    const test::ProgramRun run =
        test::run_underbody({"discover", "--reduce", "log.csv", "--out", "bench.csv", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const core::Table table = core::read_csv(folder.path() / "bench.csv");
    ASSERT_EQ(table.rows(), 1U);
    EXPECT_NEAR(table.numbers("lift_force")[0], 0.012, 1e-9);
    EXPECT_NEAR(nlohmann::json::parse(run.output)["drift_rate"].get<double>(), 5e-5, 1e-9);
}

TEST(DiscoverCommand, AsksForAModelAndDataWithExitCodeTwo) {
    core::TemporaryFolder folder("discover");
    const test::ProgramRun run = test::run_underbody({"discover", "--out", "found"}, folder.path());
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.errors.find("--data"), std::string::npos) << run.errors;
}

namespace {

/// Runs on the ground as a user has them, the last held out: port and starboard jets turned by 0.05 rad.
class OnTheGround : public testing::Test {
protected:
    void SetUp() override {
        test::SurfaceRig rig;
        rig.jet_angle = 0.05;
        data_ = test::surface_rig_runs(rig, 4, 61);
        test::surface_rig_model(folder_.path());
        write();
        core::write_file(folder_.path() / "runs" / "dataset.toml",
                         core::read_file(folder_.path() / "runs" / "dataset.toml") + "use = \"test\"\n");
    }
    void write() const { test::write_runs(data_, folder_.path() / "runs", "surface", "on the ground"); }
    test::ProgramRun run(const std::vector<std::string>& words) const {
        return test::run_underbody(words, folder_.path());
    }
    test::ProgramRun predict(const std::string& model, const std::string& runs) const {
        return run({"predict", model, "--data", runs, "--out", "predicted.csv", "--json"});
    }
    /// Another heading of a column in the first run.
    void rename(const std::string& from, const std::string& to) const {
        const std::filesystem::path file = folder_.path() / "runs" / "run-1.csv";
        std::string text = core::read_file(file);
        ASSERT_NE(text.find(from), std::string::npos);
        core::write_file(file, text.replace(text.find(from), from.size(), to));
    }
    core::TemporaryFolder folder_{"ground"};
    dynamics::Measurements data_;
};

}  // namespace

TEST_F(OnTheGround, DiscoverNamesWhatIsMissingAndPredictStatesTheSameError) {
    const test::ProgramRun found =
        run({"discover", "model.toml", "--data", "runs", "--out", "found", "--placebo", "0", "--json"});
    ASSERT_EQ(found.exit_code, 0) << found.errors;
    const nlohmann::json json = nlohmann::json::parse(found.output);
    ASSERT_EQ(json["verdict"], "effect") << json["sentence"];
    EXPECT_EQ(json["motion"], "surface");
    EXPECT_EQ(json["effects"][0]["name"], "jet_misalignment");
    EXPECT_NEAR(json["effects"][0]["parameters"]["angle"]["value"].get<double>(), 0.05, 0.002);
    ASSERT_EQ(json["axes"].size(), 3U);
    EXPECT_EQ(json["axes"][2]["quantity"], "yaw_moment");
    // the held-out run alone
    data_.runs = {data_.runs.back()};
    std::filesystem::create_directories(folder_.path() / "last");
    test::write_runs(data_, folder_.path() / "last", "surface", "the last run");
    for (const bool after : {false, true}) {
        const test::ProgramRun predicted = predict(after ? "found/model.toml" : "model.toml", "last");
        ASSERT_EQ(predicted.exit_code, 0) << predicted.errors;
        const nlohmann::json channels = nlohmann::json::parse(predicted.output)["channels"];
        std::size_t compared = 0;
        for (const nlohmann::json& error : json["errors"]) {
            if (error["horizon_s"] == 2) {
                const double own = error[after ? "after" : "before"]["rmse"];
                EXPECT_NEAR(channels[error["channel"].get<std::string>()]["rmse"], own, 1e-6 * own) << error["channel"];
                ++compared;
            }
        }
        EXPECT_EQ(compared, 3U);
    }
}

TEST_F(OnTheGround, BadInputIsSaid) {
    const auto refused = [&](const std::string& words) {
        const test::ProgramRun run = predict("model.toml", "runs");
        EXPECT_EQ(run.exit_code, 3);
        EXPECT_NE(run.errors.find(words), std::string::npos) << run.errors;
        write();
    };
    rename("thrust_port [N]", "thrust_prot [N]");
    refused("did you mean 'thrust_prot'?");
    rename("thrust_port [N]", "thrust_port [m]");
    refused("the thrust thrust_port is in 'm'");
    rename("position_y [m]", "position_north [m]");
    refused("needs the column position_y");
    rename("thrust_port [N]", "thrust_port [kN]");
    refused("while the jet is declared for 0 to 0.5 N");
    core::Table table;
    for (const core::Column& column : data_.runs[0].table.columns()) {
        std::vector<double> values = column.numbers;
        for (double& value : values) {
            value *= column.name == "thrust_port" ? 2 : 1;
        }
        table.add_numbers(column.name, column.unit, values);
    }
    table.add_numbers("thrust_stern", "N", std::vector<double>(table.rows(), 0.1));
    data_.runs[0].table = table;
    write();
    const test::ProgramRun told = predict("model.toml", "runs");
    ASSERT_EQ(told.exit_code, 0) << told.errors;
    for (const char* words : {"the column thrust_stern is not used: the model has no jet 'stern'",
                              "while the jet is declared for 0 to 0.5 N"}) {
        EXPECT_NE(told.errors.find(words), std::string::npos) << told.errors;
        EXPECT_NE(told.output.find(words), std::string::npos) << told.output;
    }
}

// Of one run nothing can be held out: what that means for the error stands with it, in the JSON too.
TEST(DiscoverCommand, SaysOfOneRunThatItsErrorIsOfTheDataItWasFittedTo) {
    core::TemporaryFolder folder("one-run");
    test::SurfaceRig rig;
    rig.thrust_gain = 0.9;
    test::surface_rig_model(folder.path());
    test::write_runs(test::surface_rig_runs(rig, 1, 62), folder.path() / "runs", "surface", "one run");
    const test::ProgramRun run = test::run_underbody(
        {"discover", "model.toml", "--data", "runs", "--out", "found", "--placebo", "0", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const nlohmann::json json = nlohmann::json::parse(run.output);
    EXPECT_NE(json["error"]["held_out"].get<std::string>().find("the same runs that were fitted"), std::string::npos);
    bool said = false;
    for (const nlohmann::json& warning : json["warnings"]) {
        said = said || warning.dump().find("with 1 run nothing can be held out") != std::string::npos;
    }
    EXPECT_TRUE(said) << json["warnings"];
    EXPECT_EQ(json["sentence"].get<std::string>().find("held-out"), std::string::npos) << json["sentence"];
}
