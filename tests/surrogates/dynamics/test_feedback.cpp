// Heave with feedback: its region, where it holds, and sweeps.
#include <gtest/gtest.h>

#include <cmath>

#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

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
