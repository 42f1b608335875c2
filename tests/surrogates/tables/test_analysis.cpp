#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/tables/analysis/collapse.h"
#include "surrogates/tables/analysis/compare.h"
#include "surrogates/tables/analysis/continuation.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/analysis/pitch.h"
#include "surrogates/tables/points/select.h"
#include "tests/support/support.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody {
namespace {

using namespace tables;
using test::csv;
using ::testing::HasSubstr;

ForceTable monotone(const core::Table& table, const std::string& quantity = "lift_force") {
    FitOptions options;
    options.kind = FitOptions::Kind::interpolation;
    return ForceTable::fit(table, quantity, options);
}

ForceTable spline(const core::Table& table, const std::string& quantity = "lift_force") {
    FitOptions options;
    options.kind = FitOptions::Kind::spline;
    return ForceTable::fit(table, quantity, options);
}

TEST(Continuation, FindsTheFoldsOfRefAAlongTheWeight) {
    ContinuationOptions options;
    options.parameter = "net_weight";
    options.lower = -0.03;
    options.upper = 0.03;
    const auto curve = continue_equilibria(test::ref_a_spline(), options);
    ASSERT_EQ(curve.folds.size(), 2u);
    EXPECT_NEAR(curve.folds[0].parameter, -0.014450036, 1e-8);
    EXPECT_NEAR(curve.folds[0].gap, 0.070125905, 1e-6);
    EXPECT_NEAR(curve.folds[1].parameter, 0.020000084, 1e-8);
    EXPECT_NEAR(curve.folds[1].gap, 0.45096077, 1e-6);
    // Every point of it is a balance.
    const auto table = test::ref_a_spline();
    for (const auto& branch : curve.branches) {
        for (const auto& b : branch) {
            ASSERT_NEAR(table.value(&b.gap), b.parameter, 1e-9);
        }
    }
    EXPECT_EQ(continuation_figure(table, curve).points.size(), 1u);
}

TEST(Continuation, FollowsSpeedSquared) {
    // F = (1 - h) u^2 = 0.5: h = 1 - 0.5/u^2.
    const auto table = monotone(csv("gap [m], lift_force [N]\n0, 1\n0.5, 0.5\n1, 0\n"));
    ContinuationOptions options;
    options.base.net_weight = 0.5;
    options.parameter = "speed";
    options.lower = 0.2;
    options.upper = 3;
    const auto curve = continue_equilibria(table, options);
    ASSERT_EQ(curve.branches.size(), 1u);
    EXPECT_TRUE(curve.folds.empty());
    for (const auto& b : curve.branches[0]) {
        EXPECT_NEAR(b.gap, 1 - 0.5 / (b.parameter * b.parameter), 1e-9);
        EXPECT_EQ(b.stability, Stability::stable);
    }
    std::swap(options.lower, options.upper);
    EXPECT_THROW(continue_equilibria(table, options), core::UsageError);
}

TEST(Pitch, HasItsStableWindowsAndTheTorqueThatTrimsThem) {
    // M = 4 p^3 - 0.1 p... restoring where 12 p^2 < 0.1.
    std::vector<double> p, m;
    for (int i = -40; i <= 40; ++i) {
        p.push_back(i * 0.005);
        m.push_back(4 * std::pow(p.back(), 3) - 0.1 * p.back() + 0.002);
    }
    core::Table data;
    data.add_numbers("pitch", "rad", p);
    data.add_numbers("pitch_moment", "N m", m);
    const auto windows = pitch_windows(spline(data, "pitch_moment"), {});
    ASSERT_EQ(windows.size(), 1u);
    EXPECT_NEAR(windows[0].lower, -std::sqrt(0.1 / 12), 1e-6);
    EXPECT_NEAR(windows[0].upper, std::sqrt(0.1 / 12), 1e-6);
    EXPECT_EQ(windows[0].side, "level");
    EXPECT_NEAR(windows[0].best_pitch, 0, 1e-3);
    EXPECT_NEAR(windows[0].stiffness, 0.1, 1e-4);
    EXPECT_NEAR(windows[0].trim_torque, -0.002, 1e-5);
}

TEST(Continuation, SeesNoFoldWhereTheForceEndsFlat) {
    // The monotone cubic has no slope at its last point here.
    const auto table = monotone(csv("gap [m], lift_force [N]\n1, 1\n2, 0.5\n5, 0.2\n10, 0.1\n20, 0.05\n50, 0.02\n"));
    const double end = 50;
    double slope = 1;
    (void)table.value(&end, &slope);
    ASSERT_NEAR(slope, 0, 1e-15);
    ContinuationOptions options;
    options.parameter = "net_weight";
    options.lower = 0.01;
    options.upper = 0.9;
    const auto curve = continue_equilibria(table, options);
    ASSERT_EQ(curve.branches.size(), 1u);
    EXPECT_TRUE(curve.folds.empty());
    EXPECT_NEAR(std::max(curve.branches[0].front().gap, curve.branches[0].back().gap), 50, 0.2);
    for (const auto& b : curve.branches[0]) {
        EXPECT_EQ(b.stability, Stability::stable);
    }
}

/// F = 1 - 2 (h - 0.5) + 3 p, M = -0.5 p + 0.2 (h - 0.5): both linear, so one balance for weight 1 at (0.5, 0), with K
/// = [[2, -3], [-0.2, 0.5]].
core::Table coupled_points() {
    const std::vector<double> h = {0.1, 0.3, 0.5, 0.7, 0.9}, q = {-0.2, -0.1, 0, 0.1, 0.2};
    core::Table data = test::grid_table(h, q, [](double a, double b) { return 1 - 2 * (a - 0.5) + 3 * b; });
    std::vector<double> m;
    for (const double a : h) {
        for (const double b : q) {
            m.push_back(-0.5 * b + 0.2 * (a - 0.5));
        }
    }
    data.add_numbers("pitch_moment", "N m", m);
    return data;
}

TEST(Pitch, CouplesWithHeaveAtThePointsWhereBothBalance) {
    const core::Table data = coupled_points();
    const auto lift = spline(data, "lift_force"), moment = spline(data, "pitch_moment");
    CoupledOptions options;
    options.net_weight = 1;
    auto found = coupled_equilibria(lift, moment, options);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].gap, 0.5, 1e-9);
    EXPECT_NEAR(found[0].pitch, 0, 1e-9);
    // Eigenvalues of K: 1.25 +- sqrt(0.5625 + 0.6).
    EXPECT_NEAR(found[0].eigenvalues[0].real(), 1.25 - std::sqrt(1.1625), 1e-8);
    EXPECT_NEAR(found[0].eigenvalues[1].real(), 1.25 + std::sqrt(1.1625), 1e-8);
    EXPECT_EQ(found[0].kind, "stable");
    EXPECT_EQ(found[0].frequency[0], 0);
    // Masses of 2 kg and 0.5 kg m^2: M^-1 K = [[1, -1.5], [-0.4, 1]], eigenvalues 1 +- sqrt(0.6).
    options.virtual_mass = 2;
    options.virtual_inertia = 0.5;
    found = coupled_equilibria(lift, moment, options);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].frequency[0], std::sqrt(1 - std::sqrt(0.6)) / (2 * M_PI), 1e-8);
    EXPECT_NEAR(found[0].frequency[1], std::sqrt(1 + std::sqrt(0.6)) / (2 * M_PI), 1e-8);
    // A torque of 0.02 N m nose up: K (dh, dp) = (0, 0.02), det K = 0.4.
    options.trim_torque = 0.02;
    found = coupled_equilibria(lift, moment, options);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].gap, 0.5 + 3 * 0.02 / 0.4, 1e-8);
    EXPECT_NEAR(found[0].pitch, 2 * 0.02 / 0.4, 1e-8);
    EXPECT_THROW(coupled_equilibria(lift, moment, {1, 0, 2, 0, {}}), core::UsageError);
    EXPECT_THROW(coupled_equilibria(lift, moment, {1, 0, 0, 0.5, {}}), core::UsageError);
    options.held = {{"gap", 0.5}};
    EXPECT_THROW(coupled_equilibria(lift, moment, options), core::UsageError);
}

TEST(Pitch, KnowsHowSureABalanceWithHeaveIs) {
    core::Table data = coupled_points();
    const auto sure = coupled_equilibria(spline(data, "lift_force"), spline(data, "pitch_moment"), {1, 0, 0, 0, {}});
    ASSERT_EQ(sure.size(), 1u);
    EXPECT_NEAR(sure[0].gap_sigma, 0, 1e-5);  // what the spline leaves open between its points
    data.add_numbers("lift_force_sigma", "N", std::vector<double>(data.rows(), 0.01));
    data.add_numbers("pitch_moment_sigma", "N m", std::vector<double>(data.rows(), 0.002));
    const auto lift = spline(data, "lift_force"), moment = spline(data, "pitch_moment");
    const auto found = coupled_equilibria(lift, moment, {1, 0, 0, 0, {}});
    ASSERT_EQ(found.size(), 1u);
    // K^-1 = [[0.5, 3], [0.2, 2]]/0.4 on errors of 0.01 N and 0.002 N m; and as the balances of shifted forces scatter.
    EXPECT_NEAR(found[0].gap_sigma, std::hypot(0.5 * 0.01, 3 * 0.002) / 0.4, 1e-6);
    EXPECT_NEAR(found[0].pitch_sigma, std::hypot(0.2 * 0.01, 2 * 0.002) / 0.4, 1e-6);
    core::Random random(3);
    double gap = 0, pitch = 0;
    const int draws = 400;
    for (int i = 0; i < draws; ++i) {
        const auto moved =
            coupled_equilibria(lift, moment, {1 - 0.01 * random.normal(), 0.002 * random.normal(), 0, 0, {}});
        ASSERT_EQ(moved.size(), 1u);
        gap += std::pow(moved[0].gap - 0.5, 2) / draws;
        pitch += std::pow(moved[0].pitch, 2) / draws;
    }
    EXPECT_NEAR(std::sqrt(gap) / found[0].gap_sigma, 1, 0.1);
    EXPECT_NEAR(std::sqrt(pitch) / found[0].pitch_sigma, 1, 0.1);
}

TEST(Pitch, DrawsTheLinesOfBalanceThroughTheirCommonPoints) {
    const core::Table data = coupled_points();
    const auto figure = coupled_figure(spline(data, "lift_force"), spline(data, "pitch_moment"), {1, 0.02, 0, 0, {}});
    ASSERT_EQ(figure.curves.size(), 2u);
    // h = 0.5 + 1.5 p, and p = 0.04 + 0.4 (h - 0.5).
    for (std::size_t i = 0; i < figure.curves[0].x.size(); ++i) {
        EXPECT_NEAR(figure.curves[0].x[i], 0.5 + 1.5 * figure.curves[0].y[i], 1e-9);
    }
    for (std::size_t i = 0; i < figure.curves[1].x.size(); ++i) {
        EXPECT_NEAR(figure.curves[1].y[i], 0.04 + 0.4 * (figure.curves[1].x[i] - 0.5), 1e-9);
    }
    ASSERT_EQ(figure.points.size(), 1u);
    EXPECT_EQ(figure.points[0].name, "stable");
    EXPECT_NEAR(figure.points[0].x.at(0), 0.65, 1e-8);
    EXPECT_NEAR(figure.points[0].y.at(0), 0.1, 1e-8);
}

TEST(Comparison, NamesTheWinnerAndWhereVariantsDifferBeyondTheirErrors) {
    const auto a = monotone(
        csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 1, .01\n0.25, .75, .01\n0.5, .5, .01\n1, 0, .01\n"));
    const auto b = monotone(
        csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 2, .01\n0.25, 1.5, .01\n0.5, 1, .01\n1, 0, .01\n"));
    const auto result = compare_tables({{"flat", a}, {"steep", b}}, {});
    EXPECT_EQ(result.winner, "steep");
    EXPECT_EQ(result.unit, "N/m");
    EXPECT_TRUE(result.beyond_error);
    ASSERT_EQ(result.differences.size(), 1u);
    EXPECT_NEAR(result.differences[0].largest, 1, 1e-9);
    EXPECT_NEAR(result.differences[0].beyond_error.at(0).first, 0, 1e-9);
    EXPECT_LT(result.differences[0].beyond_error.back().second, 0.999);
}

TEST(Comparison, NamesNoWinnerWhereNothingRestores) {
    const auto a =
        monotone(csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 1, .01\n0.5, 1.5, .01\n1, 2, .01\n"));
    const auto b =
        monotone(csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 1, .01\n0.5, 1.7, .01\n2, 3, .01\n"));
    const auto slopes = compare_tables({{"a", a}, {"b", b}}, {});
    EXPECT_EQ(slopes.winner, "") << "both lifts rise with the gap";
    EXPECT_FALSE(slopes.beyond_error);
    EXPECT_EQ(slopes.lower, 0);
    EXPECT_EQ(slopes.upper, 1) << "over the gaps that both have";
    ComparisonOptions width;
    width.measure = Measure::restoring_width;
    EXPECT_EQ(compare_tables({{"a", a}, {"b", b}}, width).winner, "");
    ComparisonOptions largest;
    largest.measure = Measure::largest;
    const auto strongest = compare_tables({{"a", a}, {"b", b}}, largest);
    EXPECT_EQ(strongest.winner, "b");
    EXPECT_NEAR(strongest.values[0], 2, 1e-9);
}

TEST(Comparison, SaysNothingOfErrorsThatThePointsDoNotState) {
    const auto a = monotone(csv("gap [m], lift_force [N]\n0, 1\n0.5, .8\n1, .2\n"));
    const auto b = monotone(csv("gap [m], lift_force [N]\n0, 1\n0.5, .801\n1, .199\n"));
    const auto result = compare_tables({{"a", a}, {"b", b}}, {});
    EXPECT_FALSE(result.errors_known);
    EXPECT_FALSE(result.beyond_error);
    ASSERT_EQ(result.differences.size(), 1u);
    EXPECT_TRUE(result.differences[0].beyond_error.empty()) << "at the points the interpolation has no error";
    EXPECT_TRUE(nlohmann::json(result)["differences"][0]["sigma"].is_null());
}

TEST(Comparison, AsksADragForNoRestoringSlope) {
    const auto a = monotone(csv("gap [m], drag_force [N], drag_force_sigma [N]\n0, 1, .01\n0.5, .7, .01\n1, .5, .01\n"),
                            "drag_force");
    const auto b = monotone(csv("gap [m], drag_force [N], drag_force_sigma [N]\n0, 2, .01\n0.5, 1.7, .01\n1, 1, .01\n"),
                            "drag_force");
    const auto result = compare_tables({{"a", a}, {"b", b}}, {});
    EXPECT_EQ(result.measure, "lowest mean");
    EXPECT_EQ(result.winner, "a");
    ComparisonOptions slope;
    slope.measure = Measure::restoring_slope;
    EXPECT_THROW(compare_tables({{"a", a}, {"b", b}}, slope), core::UsageError);
    EXPECT_TRUE(restores_along("pitch_moment", "pitch"));
    EXPECT_FALSE(restores_along("pitch_moment", "gap"));
}

TEST(Comparison, ShowsTheCurvesBesideABandThatIsManyTimesWider) {
    const auto narrow =
        monotone(csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 1, .01\n0.5, .8, .01\n1, .5, .01\n"));
    const auto wide = monotone(csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 1.1, 5\n0.5, .9, 5\n1, .6, 5\n"));
    const auto figure = comparison_figure({{"narrow", narrow}, {"wide", wide}});
    EXPECT_GT(figure.y.lower, 0);
    EXPECT_LT(figure.y.upper, 1.5);
    EXPECT_THAT(figure.caption, testing::HasSubstr("are cut"));
    const auto plain = comparison_figure({{"a", narrow}, {"b", narrow}});
    EXPECT_EQ(plain.y.lower, plain.y.upper) << "fit to the data";
}

TEST(Collapse, HoldsForTheSquareLawAndSaysTheExponentWhereItDoesNot) {
    const auto made = [](double exponent) {
        std::string text = "gap [mm], speed [m/s], lift_force [N], lift_force_sigma [N]\n";
        for (const double u : {0.5, 1.0}) {
            for (const double h : {1.0, 2.0, 3.0, 5.0, 8.0}) {
                const double f = std::pow(u, exponent) * (1 + 2 / h);
                text += std::to_string(h) + "," + std::to_string(u) + "," + std::to_string(f) + "," +
                        std::to_string(0.005 * f) + "\n";
            }
        }
        return csv(text);
    };
    EXPECT_TRUE(collapse(made(2), "lift_force", {}).holds);
    const auto off = collapse(made(1.8), "lift_force", {});
    EXPECT_FALSE(off.holds);
    EXPECT_NEAR(off.exponent, 1.8, 0.01);
}

TEST(Collapse, PutsSizesOnOneCurveOfTheLiftCoefficientOverGapByLength) {
    // F = 1/2 rho U^2 S C_L(h/c) with C_L(e) = 0.05/(e + 0.02): docs/physics.md section 4.4. Bodies of one and of two
    // lengths, speeds apart too.
    const auto made = [](double extra) {
        std::string text = "gap [mm], length [mm], width [mm], speed [m/s], lift_force [N], lift_force_sigma [N]\n";
        for (const double length : {200.0, 400.0}) {
            for (const double share : {0.005, 0.01, 0.02, 0.05, 0.1, 0.2}) {
                const double u = 0.5 + 0.001 * length;
                const double area = M_PI / 4 * length * 0.75 * length * 1e-6;
                double f = 0.5 * 998 * u * u * area * 0.05 / (share + 0.02);
                f *= length > 300 && share < 0.015 ? 1 + extra : 1;
                std::ostringstream line;
                line.precision(12);
                line << share * length << "," << length << "," << 0.75 * length << "," << u << "," << f << ","
                     << 0.01 * f << "\n";
                text += line.str();
            }
        }
        return csv(text);
    };
    CollapseOptions options;
    options.by = "length";
    const auto fits = collapse(made(0), "lift_force", options);
    EXPECT_TRUE(fits.holds) << fits.verdict;
    EXPECT_EQ(fits.coefficient, "C_L");
    EXPECT_EQ(fits.abscissa, "gap_over_length");
    EXPECT_NEAR(fits.points.numbers("C_L")[0], 0.05 / 0.025, 1e-9);
    EXPECT_NEAR(fits.exponent, 2, 1e-3);
    // The larger body off by a fifth at small gaps only: that is where it must be said.
    const auto off = collapse(made(0.2), "lift_force", options);
    EXPECT_FALSE(off.holds);
    ASSERT_EQ(off.groups.size(), 1u);
    ASSERT_EQ(off.groups[0].beyond.size(), 1u);
    EXPECT_NEAR(off.groups[0].beyond[0].first, 0.005, 1e-9);
    EXPECT_NEAR(off.groups[0].beyond[0].second, 0.01, 1e-9);
    EXPECT_EQ(collapse_figure(off).points.size(), 2u);
}

TEST(Collapse, PutsJetForcesOnTheSquareOfVoltageOrFlow) {
    std::string text = "gap [m], jet_voltage [V], jet_flow [m^3/s], lift_force [N]\n";
    for (const double volts : {6.0, 12.0}) {
        for (const double h : {0.1, 0.2, 0.4, 0.8}) {
            text += std::to_string(h) + "," + std::to_string(volts) + "," + core::format_number(2e-6 * volts) + "," +
                    core::format_number(1e-4 * volts * volts * (1 - h)) + "\n";
        }
    }
    for (const char* by : {"jet_voltage", "jet_flow"}) {
        CollapseOptions options;
        options.by = by;
        const auto result = collapse(csv(text), "lift_force", options);
        EXPECT_TRUE(result.holds) << result.verdict;
        EXPECT_NEAR(result.exponent, 2, 1e-9);
    }
    CollapseOptions options;
    options.by = "voltage";
    EXPECT_THROW(collapse(csv(text), "lift_force", options), core::UsageError);
    options.by = "jet_flow";
    options.length = -1;
    EXPECT_THROW(collapse(csv(text), "lift_force", options), core::UsageError);
}

TEST(Collapse, FindsTheSharedCfdBelowTheSquareLaw) {
    UNDERBODY_NEEDS_SHARED("cfd/forces.csv");
    const auto points = selected_rows(core::read_csv(test::shared_folder() / "cfd/forces.csv"),
                                      "variant=ellipse, mesh=medium, pitch=0");
    const auto result = collapse(points, "lift_force", {});
    EXPECT_FALSE(result.holds);
    ASSERT_EQ(result.groups.size(), 1u);
    EXPECT_NEAR(result.groups[0].mean_ratio, 0.858, 0.005) << "its README: 14 % below the square law";
}

TEST(Kinks, AreNamedWithThePointThatCausesThem) {
    const auto table = ForceTable::fit(
        csv("gap [mm], lift_force [N], lift_force_sigma [N]\n1,1,.05\n2,.8,.05\n3,.83,.05\n4,.6,.05\n5,.4,.05\n"),
        "lift_force");
    std::string remarks;
    for (const auto& r : table.remarks()) {
        remarks += r.message + "\n";
    }
    EXPECT_THAT(remarks, HasSubstr("the turn at gap 2 mm"));
    EXPECT_THAT(remarks, HasSubstr("not supported"));
}

TEST(Kinks, AreNamedWithAllTheirAxes) {
    const auto table =
        ForceTable::fit(csv("gap [mm], pitch [deg], lift_force [N], lift_force_sigma [N]\n1,0,1,.05\n2,0,.8,.05\n"
                            "3,0,.83,.05\n1,2,1.1,.05\n2,2,.9,.05\n3,2,.94,.05\n"),
                        "lift_force");
    std::string remarks;
    for (const auto& r : table.remarks()) {
        remarks += r.message + "\n";
    }
    EXPECT_THAT(remarks, HasSubstr("the turn at gap 2 mm, pitch 0 deg (0.03 N)"));
    EXPECT_THAT(remarks, HasSubstr("the turn at gap 2 mm, pitch 2 deg (0.04 N)"));
}

}  // namespace
}  // namespace underbody
