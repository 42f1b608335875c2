// underbody discover as a user runs it, and its model in underbody predict.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
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
