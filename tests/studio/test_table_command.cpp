#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

using test::run_underbody;
using ::testing::HasSubstr;

constexpr const char* lift = "gap [mm], lift_force [N], lift_force_sigma [N]\n1, .66, .01\n2, .4, .01\n3, .296, .01\n5, .27, .01\n10, .297, .01\n20, .324, .01\n50, .346, .01\n100, .281, .01\n";

TEST(TableCommand, GivesValuesEquilibriaAndTheirJson) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", lift);
    auto run = run_underbody({"--json", "table", "at", "lift.csv", "gap=5mm", "--kind", "interpolation"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_NEAR(nlohmann::json::parse(run.output)["value"].get<double>(), 0.27, 1e-12);
    run = run_underbody({"table", "equilibria", "lift.csv", "--weight", "0.3 N", "--mass", "3.954 kg", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    ASSERT_EQ(json["equilibria"].size(), 3u) << run.output;
    EXPECT_TRUE(json["equilibria"][0]["stable"].get<bool>());
    EXPECT_NEAR(json["equilibria"][0]["gap"].get<double>(), 0.003, 3e-4);
    EXPECT_FALSE(json["equilibria"][1]["stable"].get<bool>());
    EXPECT_GT(json["equilibria"][0]["kick_velocity"].get<double>(), 0);
    run = run_underbody({"table", "continue", "lift.csv", "--along", "net_weight=0.2:0.6", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_GE(nlohmann::json::parse(run.output)["folds"].size(), 2u);
}

TEST(TableCommand, SaysWhatIsWrong) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", lift);
    core::write_file(folder.path() / "one.csv", "gap [mm], lift_force [N]\n1, 2\n");
    EXPECT_EQ(run_underbody({"table", "fit", "one.csv"}, folder.path()).exit_code, 3);
    EXPECT_EQ(run_underbody({"table", "fit", "none.csv"}, folder.path()).exit_code, 3);
    EXPECT_EQ(run_underbody({"table", "fit", "lift.csv", "--kind", "magic"}, folder.path()).exit_code, 2);
    const auto swapped = run_underbody({"table", "continue", "lift.csv", "--along", "net_weight=0.6:0.2"}, folder.path());
    EXPECT_EQ(swapped.exit_code, 2);
    EXPECT_THAT(swapped.errors, HasSubstr("swapped"));
    const auto outside = run_underbody({"table", "at", "lift.csv", "gap=200mm"}, folder.path());
    EXPECT_EQ(outside.exit_code, 0);
    EXPECT_THAT(outside.errors, HasSubstr("outside the table by 100 mm"));
}

}  // namespace
}  // namespace underbody
