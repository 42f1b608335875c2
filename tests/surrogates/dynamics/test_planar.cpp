// The region code on motions whose regions are known, closed loops, and sweeps.
#include <gtest/gtest.h>

#include <cmath>

#include "surrogates/dynamics/basin/planar_region.h"
#include "surrogates/dynamics/simulate/dormand_prince.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

TEST(PlanarRegion, OfTheReversedVanDerPolOscillatorIsTheInsideOfItsCycle) {
    const PlanarSystem reversed{[](const double* y, double* d) {
                                    d[0] = -y[1];
                                    d[1] = y[0] - (1 - y[0] * y[0]) * y[1];
                                },
                                {{0, 0}},
                                -6,
                                6,
                                -6,
                                6};
    const std::vector<core::NamedRange> axes{{"x", -3, 3}, {"y", -3.2, 3.2}};
    const PlanarRegion region = planar_region(reversed, axes, 160, 160, 200);
    // Forward in time the cycle attracts: follow it there and take its area as the reference.
    const PlanarSystem forward{[](const double* y, double* d) {
                                   d[0] = y[1];
                                   d[1] = (1 - y[0] * y[0]) * y[1] - y[0];
                               },
                               {{0, 0}},
                               -6,
                               6,
                               -6,
                               6};
    const PlanarRegion cycle = planar_region(forward, axes, 4, 4, 200);
    ASSERT_EQ(cycle.cycles.size(), 1U);
    EXPECT_NEAR(cycle.fraction("cycle 1"), 1, 1e-12);
    const double area = enclosed_area(cycle.cycles[0]);
    ASSERT_EQ(region.attractors.size(), 1U);
    EXPECT_NEAR(region.fraction("A") * 6 * 6.4 / area, 1, .01);
    EXPECT_NEAR(region.fraction("escape"), 1 - region.fraction("A"), 1e-3);
}

TEST(PlanarRegion, OfTheDampedPendulumHasTheAreaBetweenItsSeparatrices) {
    constexpr double pi = 3.14159265358979323846, damping = .3;
    const auto rate = [](const double* y, double* d) {
        d[0] = y[1];
        d[1] = -std::sin(y[0]) - damping * y[1];
    };
    const PlanarSystem pendulum{rate, {{0, 0}, {2 * pi, 0}, {-2 * pi, 0}, {4 * pi, 0}, {-4 * pi, 0}}, -20, 20, -20, 20};
    const std::vector<core::NamedRange> axes{{"angle", -pi, pi}, {"rate", -3, 3}};
    const PlanarRegion region = planar_region(pendulum, axes, 180, 180, 300);
    // Reference: the stable manifolds of the saddles at -pi and pi, backward in time; what lies between them belongs to
    // the middle.
    struct Backward {
        void operator()(double, const double* y, double* d) const {
            d[0] = -y[1];
            d[1] = std::sin(y[0]) + damping * y[1];
        }
    };
    const double lambda = -damping / 2 - std::sqrt(damping * damping / 4 + 1);
    const auto height = [&](double saddle, double side) {
        // Largest |rate| along the manifold as a function of the angle, sampled by the integrator's steps.
        std::vector<std::array<double, 2>> line;
        const Backward backward;
        DormandPrince<2, Backward> ode(backward, 0, {saddle + side * 1e-7, side * 1e-7 * lambda}, {1e-10, 1e-10}, 1e-3);
        while (std::abs(ode.y()[0]) < 4 && std::abs(ode.y()[1]) < 4 && ode.t() < 60 && ode.step(60)) {
            for (int k = 1; k <= 8; ++k) {
                line.push_back({ode.between(k / 8.0, 0), ode.between(k / 8.0, 1)});
            }
        }
        return line;
    };
    const auto upper = height(pi, -1), lower = height(-pi, 1);
    const auto at = [](const std::vector<std::array<double, 2>>& line, double x) {
        for (std::size_t i = 1; i < line.size(); ++i) {
            if ((line[i - 1][0] - x) * (line[i][0] - x) <= 0) {
                const double part = (x - line[i - 1][0]) / (line[i][0] - line[i - 1][0]);
                return line[i - 1][1] + part * (line[i][1] - line[i - 1][1]);
            }
        }
        return 0.0;
    };
    double area = 0;
    constexpr int strips = 4000;
    for (int i = 0; i < strips; ++i) {
        const double x = -pi + 2 * pi * (i + .5) / strips;
        area += (std::min(at(upper, x), 3.0) - std::max(at(lower, x), -3.0)) * 2 * pi / strips;
    }
    double middle = 0;
    for (std::size_t k = 0; k < region.attractors.size(); ++k) {
        middle = std::abs(region.attractors[k][0]) < .1 ? region.classes[k].fraction : middle;
    }
    EXPECT_NEAR(middle * 2 * pi * 6 / area, 1, .01);
    // Mirrored starts end at mirrored rests.
    std::size_t odd = 0;
    for (std::size_t j = 0; j < 180; ++j) {
        for (std::size_t i = 0; i < 180; ++i) {
            const auto gap = [&](std::size_t a, std::size_t b) {
                const EndClass& end = region.classes[static_cast<std::size_t>(region.index[b * 180 + a])];
                return end.kind == EndKind::attractor ? end.gap : 0.0;
            };
            odd += std::abs(gap(i, j) + gap(179 - i, 179 - j)) > 1e-6 ? 1 : 0;
        }
    }
    EXPECT_LT(odd, 20U);
}

TEST(Feedback, WidensTheRegion) {
    const Model model = test::ref_a_model(.3, 15);
    RegionOptions options;
    options.axes = {{"gap", -.04, .6}, {"heave_velocity", -.06, .06}};
    options.columns = options.rows = 40;
    const StabilityRegion open = stability_region(model, options);
    const HeavePlant plant(model);
    const HeaveFeedback lqr = heave_lqr(plant, 0, 1, 100, 1);
    options.feedback = std::make_shared<HeaveFeedback>(lqr);
    const StabilityRegion closed = stability_region(model, options);
    EXPECT_GT(closed.fraction("A"), open.fraction("A"));
    EXPECT_EQ(closed.count(EndKind::undecided), 0U);
    // The gains alone, without the table: k_h = sqrt(q_h), k_w = sqrt(q_w + 2 S k_h) (O20)
    const HeaveFeedback bare = heave_lqr(HeavePlant(test::free_model(1 / .2529, 0, 0, 0)), 1, 1, 100, 1);
    EXPECT_NEAR(bare.gap_gain, 10, 1e-6);
    EXPECT_NEAR(bare.velocity_gain, 8.9488905, 1e-6);
    // With little force to give it holds less.
    HeaveFeedback weak = lqr;
    weak.limit = .004;
    options.feedback = std::make_shared<HeaveFeedback>(weak);
    const StabilityRegion limited = stability_region(model, options);
    EXPECT_LT(limited.fraction("A"), closed.fraction("A"));
}

TEST(Feedback, HoldsItsHeightOffByWhatItDoesNotCancel) {  // O88 on the nonlinear motion, physics-notes oracle 64
    const double s = 1 / .2529;
    HeavePlant plant(test::ref_a_model());
    close_loop(plant, {s, 2 * s, .02, 0});
    const auto found = heave_equilibria(plant);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].gap, 0.018260022, 1e-8);
}

TEST(Feedback, SweepsTheVoltage) {
    Model model = test::ref_a_model(0, 15, .005);
    model.forces[0].scales = {{Channel::jet_voltage, 10, 2, 0}};
    const EquilibriumSweep sweep = equilibrium_sweep(model, {}, Channel::jet_voltage, 4, 12, 9);
    ASSERT_EQ(sweep.value.size(), 9U);
    // Scaling by (V/10)^2 against a constant weight: the highest stable gap rises with the voltage.
    double before = 0;
    for (const auto& found : sweep.equilibria) {
        double highest = 0;
        for (const HeaveEquilibrium& e : found) {
            highest = e.stable ? std::max(highest, e.gap) : highest;
        }
        EXPECT_GE(highest, before - 1e-12);
        before = highest;
    }
    EXPECT_EQ(equilibrium_figure(sweep).points.size(), 2U);
}

}  // namespace

}  // namespace underbody::dynamics
