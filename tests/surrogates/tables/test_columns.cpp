#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "surrogates/tables/analysis/compare.h"
#include "surrogates/tables/analysis/pitch.h"
#include "surrogates/tables/points/select.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody {
namespace {

using tables::ForceTable;
using testing::HasSubstr;

std::string refusal(const std::string& text, const std::vector<std::string>& axes = {}) {
    tables::FitOptions options;
    options.axes = axes;
    try {
        (void)ForceTable::fit(test::csv(text), "lift_force", options);
    } catch (const core::InputError& error) {
        return error.what() + std::string(" ") + error.hint();
    }
    return "no error";
}

/// An export in body axes (z down) has its forces under other names: all of them are forces when it is read back.
TEST(Columns, ForcesInBodyAxesAreForcesBesideAMoment) {
    core::Table table;
    table.add_numbers("gap", "m", {0.002, 0.004});
    table.add_numbers("z_force", "N", {-1, -2});
    table.add_numbers("z_force_sigma", "N", {0.1, 0.1});
    table.add_numbers("z_force_per_gap", "N/m", {0, 0});
    table.add_numbers("pitch_moment", "N m", {1, 2});
    table.add_numbers("x_force", "N", {-3, -4});
    EXPECT_EQ(tables::force_columns(table), (std::vector<std::string>{"z_force", "pitch_moment", "x_force"}));
}

TEST(Columns, AMisnamedAxisIsNamedWhereThePointsThenRepeat) {
    const std::string text = refusal(
        "Gap (mm), trim angle [deg], speed [m/s], lift_force [N]\n1,0,0.4,1\n2,0,0.4,2\n1,1,0.6,1.5\n2,1,0.6,2.5\n",
        {"speed"});
    EXPECT_THAT(text, HasSubstr("the column 'Gap (mm)' is not understood and not used: write 'gap [mm]'"));
    EXPECT_THAT(text, HasSubstr("the column 'trim angle' is not understood and not used: write 'pitch [deg]'"));
}

TEST(Columns, AMisnamedAxisIsNamedWhereNothingVaries) {
    EXPECT_THAT(refusal("Ride height [mm], lift_force [N]\n1,1\n2,2\n3,3\n"), HasSubstr("gap [mm]"));
}

TEST(Columns, AnUnusedAxisIsAWarningAndLabelsAreNot) {
    tables::FitOptions options;
    options.axes = {"gap"};
    const auto table = ForceTable::fit(
        test::csv(
            "gap [mm], velocity [m/s], case, lift_force [N], cells [1]\n1,0.1,a,1,10\n2,0.2,b,2,20\n3,0.3,c,3,30\n"),
        "lift_force", options);
    int warnings = 0;
    for (const auto& remark : table.remarks()) {
        warnings += remark.severity != core::Problem::Severity::note ? 1 : 0;
        EXPECT_EQ(remark.message.find("'case'"), std::string::npos);
    }
    EXPECT_EQ(warnings, 1);
    EXPECT_EQ(table.axes().size(), 1U);
}

TEST(Columns, RowsAreSelectedInTheWayOfTheCommandLineAndOfAStudy) {
    const auto table = test::csv("variant, pitch [deg], lift_force [N]\na,0,1\na,1,2\nb,0,3\n");
    for (const char* where :
         {"variant=a, pitch=0", "{variant = \"a\", pitch = 0}", "{ variant = 'a', pitch = \"0 deg\" }"}) {
        EXPECT_EQ(tables::selected_rows(table, where).rows(), 1U) << where;
    }
    EXPECT_EQ(tables::selected_rows(table, "variant=\"a|b\"").rows(), 3U);
}

TEST(Compare, PraisesNobodyWhereNothingRestores) {
    std::vector<std::pair<std::string, ForceTable>> all;
    for (const double slope : {1.0, 2.0}) {
        all.emplace_back(
            slope == 1 ? "a" : "b",
            ForceTable::fit(test::csv("gap [m], lift_force [N]\n0,0\n1," + std::to_string(slope) + "\n2," +
                                      std::to_string(2 * slope) + "\n3," + std::to_string(3 * slope) + "\n"),
                            "lift_force"));
    }
    for (const auto measure : {tables::Measure::restoring_slope, tables::Measure::restoring_width}) {
        tables::ComparisonOptions options;
        options.measure = measure;
        const auto result = tables::compare_tables(all, options);
        EXPECT_EQ(result.winner, "");
        EXPECT_FALSE(result.beyond_error);
        EXPECT_TRUE(nlohmann::json(result)["winner"].is_null());
    }
    EXPECT_EQ(tables::compare_tables(all, {"", {}, tables::Measure::highest}).winner, "b");
}

TEST(Pitch, HasItsWindowEdgeWhereTheMomentTurnsNotAtTheNearestPoint) {
    // M = -(p - 2.7)^2 (p + 6), degrees: turns at 2.7 and at -3.1.
    std::string text = "pitch [deg], pitch_moment [N m]\n";
    for (int p = -6; p <= 6; ++p) {
        text += std::to_string(p) + "," + std::to_string(-1e-3 * std::pow(p - 2.7, 2) * (p + 6)) + "\n";
    }
    const auto moment = ForceTable::fit(test::csv(text), "pitch_moment");
    const auto windows = tables::pitch_windows(moment, {});
    const double degree = M_PI / 180;
    ASSERT_EQ(windows.size(), 2U);
    EXPECT_NEAR(windows[0].lower, -6 * degree, 1e-9);
    EXPECT_EQ(windows[0].lower_sigma, 0);
    EXPECT_NEAR(windows[0].upper, -3.1 * degree, 1e-3 * degree);
    EXPECT_NEAR(windows[1].lower, 2.7 * degree, 1e-3 * degree);
    EXPECT_GT(windows[1].lower_sigma, 0);
    EXPECT_LT(windows[1].lower_sigma, 0.2 * degree);
    EXPECT_TRUE(nlohmann::json(windows[1]).contains("lower_sigma"));
}

TEST(Pitch, SaysHowSureAWindowEdgeIsFromTheErrorsOfThePoints) {
    std::string text = "pitch [deg], pitch_moment [N m], pitch_moment_sigma [N m]\n";
    for (int p = -6; p <= 6; ++p) {
        text += std::to_string(p) + "," + std::to_string(1e-3 * (p - 1.3) * (p - 1.3)) + ",0.0005\n";
    }
    const auto windows = tables::pitch_windows(ForceTable::fit(test::csv(text), "pitch_moment"), {});
    ASSERT_FALSE(windows.empty());
    // The slope is known to about sigma / (root of 13 / 2 points over a span of 4 degrees), over a curvature of 0.002:
    // some tenths of a degree.
    EXPECT_NEAR(windows[0].upper, 1.3 * M_PI / 180, 3 * windows[0].upper_sigma + 1e-4);
    EXPECT_GT(windows[0].upper_sigma, 0.005 * M_PI / 180);
    EXPECT_LT(windows[0].upper_sigma, 0.6 * M_PI / 180);
}

}  // namespace
}  // namespace underbody
