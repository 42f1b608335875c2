// underbody discover as a user runs it, and its model in underbody predict.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "tests/support/support.h"
#include "tests/surrogates/discovery/make_data.h"

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
