#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"
#include "core/random.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/analysis/figures.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody {
namespace {

using tables::EquilibriumOptions;
using tables::FitOptions;
using tables::ForceTable;
using tables::Stability;
using test::csv;

ForceTable monotone(const core::Table& table) {
    FitOptions options;
    options.kind = FitOptions::Kind::interpolation;
    return ForceTable::fit(table, "lift_force", options);
}

TEST(Equilibria, OfRefAMatchTheOracles) {
    EquilibriumOptions options;
    options.virtual_mass = 1 / 0.2529;
    const auto found = equilibria(test::ref_a_spline(), options);
    ASSERT_EQ(found.all.size(), 2u);
    const auto& stable = found.all[0];
    const auto& unstable = found.all[1];
    EXPECT_NEAR(stable.gap, 0, 1e-6);
    EXPECT_EQ(stable.stability, Stability::stable);
    EXPECT_NEAR(stable.stiffness, 0.44735064, 1e-6);
    EXPECT_NEAR(stable.frequency * 2 * std::numbers::pi, 0.33635543, 1e-6);
    EXPECT_NEAR(unstable.gap, 0.16, 1e-6);
    EXPECT_EQ(unstable.stability, Stability::unstable);
    EXPECT_NEAR(unstable.stiffness, -0.20983183, 1e-6);
    EXPECT_NEAR(unstable.growth_rate, 0.23036161, 1e-6);
    EXPECT_NEAR(stable.barrier, 0.0014837219, 1e-8);
    EXPECT_NEAR(stable.kick_velocity, 0.027394644, 1e-8);
    EXPECT_NEAR(stable.kick_gap_up, 0.16, 1e-6);
    EXPECT_FALSE(stable.limited_by_range);
}

TEST(Equilibria, OfRefAWithAConstantForceMatchTheOracles) {
    EquilibriumOptions options;
    options.net_weight = -0.010;
    const auto found = equilibria(test::ref_a_spline(), options);
    ASSERT_EQ(found.all.size(), 2u);
    EXPECT_NEAR(found.all[0].gap, 0.03, 1e-6);
    EXPECT_NEAR(found.all[1].gap, 0.11331972, 1e-6);
    options.net_weight = -0.015;
    EXPECT_TRUE(equilibria(test::ref_a_spline(), options).all.empty());
}

TEST(Equilibria, OfALinearSpringHaveItsFrequencyAndKick) {
    const ForceTable spring = monotone(csv("gap [m], lift_force [N]\n0, 1\n0.5, 0.5\n1, 0\n"));
    EquilibriumOptions options;
    options.net_weight = 0.6;
    options.virtual_mass = 4;
    options.damping = 0.4;
    const auto found = equilibria(spring, options);
    ASSERT_EQ(found.all.size(), 1u);
    const auto& e = found.all[0];
    EXPECT_NEAR(e.gap, 0.4, 1e-12);
    EXPECT_NEAR(e.stiffness, 1, 1e-12);
    EXPECT_NEAR(e.frequency, 0.5 / (2 * std::numbers::pi), 1e-12);
    EXPECT_NEAR(e.damping_ratio, 0.1, 1e-12);
    EXPECT_TRUE(e.limited_by_range);
    EXPECT_NEAR(e.kick_velocity, 0.4 * 0.5, 1e-12) << "amplitude 0.4 m times 0.5 rad/s reaches the lower end";
    EXPECT_NEAR(e.kick_gap, 0.4, 1e-9);
}

TEST(Equilibria, AlternateBetweenStableAndUnstableWhateverTheWeight) {
    core::Random random(99);
    for (int trial = 0; trial < 300; ++trial) {
        std::vector<double> x, y;
        for (int i = 0; i < 9; ++i) {
            x.push_back(0.001 * (i + 1) * (i + 1));
            y.push_back(random.normal());
        }
        core::Table data;
        data.add_numbers("gap", "m", x);
        data.add_numbers("lift_force", "N", y);
        EquilibriumOptions options;
        options.net_weight = random.normal();
        options.virtual_mass = 3;
        const ForceTable table = monotone(data);
        const auto found = equilibria(table, options);
        int last = y.front() > options.net_weight ? 1 : -1;
        for (const auto& e : found.all) {
            ASSERT_NEAR(table.value(&e.gap), options.net_weight, 1e-12);
            ASSERT_EQ(e.stability, last > 0 ? Stability::stable : Stability::unstable);
            last = -last;
            ASSERT_GE(e.kick_gap, 0);
            ASSERT_LE(e.kick_gap_up, x.back() - e.gap + 1e-12);
        }
        ASSERT_EQ(last > 0, y.back() > options.net_weight);
    }
}

TEST(Equilibria, SurviveKicksJustBelowTheStatedOneAndNoneAbove) {
    const auto table = test::ref_a_spline();
    EquilibriumOptions options;
    options.virtual_mass = 3.954;
    options.net_weight = -0.005;
    const auto e = equilibria(table, options).all.at(0);
    const auto force = net_force(table, options);
    const auto survives = [&](double h, double w) {
        const double step = 2e-3;
        for (int i = 0; i < 60000; ++i) {
            // Velocity Verlet: conserves energy well enough for one per cent of a kick.
            w += 0.5 * step * force.value(h) / 3.954;
            h += step * w;
            w += 0.5 * step * force.value(h) / 3.954;
            if (h > 0.2) {
                return false;
            }
        }
        return true;
    };
    EXPECT_TRUE(survives(e.gap, 0.99 * e.kick_velocity));
    EXPECT_FALSE(survives(e.gap, 1.01 * e.kick_velocity));
    EXPECT_TRUE(survives(e.gap + 0.99 * e.kick_gap_up, 0));
    EXPECT_FALSE(survives(e.gap + 1.01 * e.kick_gap_up, 0));
}

TEST(Equilibria, AreMarginalWhereTheForceOnlyTouchesTheWeight) {
    EquilibriumOptions options;
    options.net_weight = 1;
    const auto touching = equilibria(monotone(csv("gap [m], lift_force [N]\n0, 3\n1, 1\n2, 2\n")), options);
    ASSERT_EQ(touching.all.size(), 1u);
    EXPECT_EQ(touching.all[0].stability, Stability::marginal);
    const auto flat = equilibria(monotone(csv("gap [m], lift_force [N]\n0, 3\n1, 1\n2, 1\n3, 0\n")), options);
    ASSERT_EQ(flat.all.size(), 1u);
    EXPECT_EQ(flat.all[0].stability, Stability::marginal);
    EXPECT_NEAR(flat.all[0].gap, 1.5, 1e-12);
    EXPECT_NEAR(flat.all[0].extent, 1, 1e-12);
}

TEST(Equilibria, OfATableOfTwoAxesHoldTheOther) {
    const auto table =
        monotone(test::grid_table({0, .5, 1}, {-.1, 0, .1}, [](double h, double p) { return 1 - h + 2 * p; }));
    EquilibriumOptions options;
    options.net_weight = 0.5;
    auto found = equilibria(table, options);
    ASSERT_EQ(found.all.size(), 1u);
    EXPECT_NEAR(found.all[0].gap, 0.5, 1e-9);
    EXPECT_FALSE(found.remarks.empty()) << "pitch 0 is a choice that must be said";
    options.held = {{"pitch", 0.1}};
    found = equilibria(table, options);
    EXPECT_NEAR(found.all.at(0).gap, 0.7, 1e-9);
    options.held = {{"pich", 0.1}};
    EXPECT_THROW(equilibria(table, options), core::UsageError);
}

TEST(Equilibria, FollowThePolicyOfAHeldAxis) {
    const auto data = test::grid_table({0.001, 0.002, 0.005, 0.01, 0.02}, {-0.05, 0, 0.05},
                                       [](double h, double p) { return 1e-3 / h + 2 * p; });
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    tables::EquilibriumOptions wanted;
    wanted.net_weight = 0.4;
    wanted.held = {{"pitch", 0.1}};
    const auto of = [&](const char* range) {
        options.range = tables::parse_range_policies(range);
        return tables::equilibria(tables::ForceTable::fit(data, "lift_force", options), wanted);
    };
    const auto holding = of("clamp");
    wanted.held = {{"pitch", 0.05}};
    const auto at_the_end = of("clamp");
    wanted.held = {{"pitch", 0.1}};
    ASSERT_EQ(holding.all.size(), 1u);
    EXPECT_DOUBLE_EQ(holding.all[0].gap, at_the_end.all[0].gap);
    ASSERT_EQ(holding.remarks.size(), 1u);
    EXPECT_EQ(holding.remarks[0].message, "pitch is outside the table by 0.05 rad: the end value is held");
    const auto going_on = of("pitch=extrapolate");
    ASSERT_EQ(going_on.all.size(), 1u);
    EXPECT_NEAR(1e-3 / going_on.all[0].gap, 0.4 - 0.2, 0.03) << "the linear part goes on";
    EXPECT_THROW(of("pitch=refuse"), core::InputError);
}

TEST(Equilibria, KnowHowSureTheyAre) {
    const auto table =
        monotone(csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 1, 0.02\n0.5, 0.5, 0.02\n1, 0, 0.02\n"));
    EquilibriumOptions options;
    options.net_weight = 0.5;
    options.draws = 100;
    const auto e = equilibria(table, options).all.at(0);
    EXPECT_NEAR(e.sigma, 0.02, 1e-9);
    ASSERT_TRUE(e.probability.has_value());
    EXPECT_GT(*e.probability, 0.97);
}

TEST(Equilibria, StateTheErrorOfTheirStiffness) {
    // Independent errors s of the points of a coarse grid: near the middle of a straight line the slope of the cubic
    // between two points h apart scatters by about s times the square root of 2 over h, at most half as much again.
    const auto table = monotone(
        csv("gap [m], lift_force [N], lift_force_sigma [N]\n0, 1, 0.01\n0.25, 0.75, 0.01\n0.5, 0.5, 0.01\n0.75, "
            "0.25, 0.01\n1, 0, 0.01\n"));
    EquilibriumOptions options;
    options.net_weight = 0.4;
    options.virtual_mass = 2;
    EXPECT_FALSE(equilibria(table, options).all.at(0).stiffness_sigma.has_value()) << "needs draws";
    options.draws = 400;
    const auto e = equilibria(table, options).all.at(0);
    const double expected = 0.01 * std::sqrt(2.0) / 0.25;
    ASSERT_TRUE(e.stiffness_sigma && e.frequency_sigma);
    EXPECT_GT(*e.stiffness_sigma, 0.3 * expected);
    EXPECT_LT(*e.stiffness_sigma, 1.6 * expected);
    EXPECT_NEAR(*e.frequency_sigma, 0.5 * e.frequency * *e.stiffness_sigma / e.stiffness, 0.1 * *e.frequency_sigma);
}

TEST(Equilibria, AreOfALiftAlone) {
    const auto refused = [](const char* heading) {
        const auto table = ForceTable::fit(csv(std::string("gap [m], ") + heading + "\n0, 1\n1, 0\n"),
                                           std::string(heading).substr(0, std::string(heading).find(' ')), {});
        try {
            equilibria(table, {});
        } catch (const core::UsageError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(refused("drag_force [N]"), testing::HasSubstr("balanced by the lift"));
    EXPECT_THAT(refused("pitch_moment [N m]"), testing::HasSubstr("a table of pitch_moment"));
    EXPECT_THAT(refused("z_force [N]"), testing::HasSubstr("z_force = -lift_force"));
    EXPECT_THAT(refused("thrust_up [N m]"), testing::HasSubstr("balanced by the lift"));
    EXPECT_EQ(refused("force_up [N]"), "") << "a name of the user's own, in N";
}

TEST(Equilibria, SayWhichWayTheTableEndsFirst) {
    // Stable at 0.2 and 0.9 with a repelling one at 0.6 between: above 0.9 nothing but the end of the table.
    const auto table =
        monotone(csv("gap [m], lift_force [N]\n0, 0.6\n0.2, 0.5\n0.4, 0.3\n0.6, 0.5\n0.75, "
                     "0.8\n0.9, 0.5\n1, 0.45\n"));
    EquilibriumOptions options;
    options.net_weight = 0.5;
    options.virtual_mass = 1;
    const auto found = equilibria(table, options);
    ASSERT_EQ(found.all.size(), 3u);
    EXPECT_TRUE(found.all[2].up_to_end);
    EXPECT_FALSE(found.all[2].down_to_end);
    EXPECT_TRUE(found.all[0].down_to_end);
    EXPECT_FALSE(found.all[0].up_to_end);
    EXPECT_LT(found.all[2].kick_velocity_up, found.all[2].kick_velocity);
}

TEST(Equilibria, ComeOutAsTheJsonOfTheInterface) {
    EquilibriumOptions options;
    options.virtual_mass = 4;
    const nlohmann::json json = equilibria(test::ref_a_spline(), options);
    for (const char* key : {"gap", "stable", "stiffness", "frequency", "kick_velocity", "sigma"}) {
        EXPECT_TRUE(json["equilibria"][0].contains(key)) << key;
    }
}

TEST(Figures, ShowCurveBandPointsAndEquilibria) {
    tables::FigureOptions options;
    options.equilibria = EquilibriumOptions{};
    options.equilibria->net_weight = 0.3;
    const auto table =
        monotone(csv("gap [mm], lift_force [N], lift_force_sigma [N]\n1, .66, .02\n2, .4, .02\n5, .27, .02\n20, .32, "
                     ".02\n50, .35, .02\n100, .28, .02\n"));
    const auto figure = curve_figure(table, options);
    ASSERT_EQ(figure.curves.size(), 1u);
    EXPECT_EQ(figure.bands.size(), 1u);
    EXPECT_EQ(figure.x.unit, "mm");
    EXPECT_NEAR(figure.curves[0].x.back(), 100, 1e-9);
    ASSERT_GE(figure.points.size(), 3u);
    EXPECT_EQ(figure.points[0].x.size(), 6u);
    EXPECT_EQ(figure.points[1].name, "stable");
    EXPECT_EQ(figure.points[1].x.size(), 2u);
    const auto map = tables::figure(
        monotone(test::grid_table({0, .5, 1}, {-.1, 0, .1}, [](double h, double p) { return 1 - h + 2 * p; })));
    EXPECT_EQ(map.maps.size(), 1u);
}

}  // namespace
}  // namespace underbody
