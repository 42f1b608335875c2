// Heave with feedback: its region, where it holds, and sweeps.
#include <gtest/gtest.h>

#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/linear/trim_error.h"
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

TEST(Feedback, CoulombFrictionIsNoDampingOfSmallMotions) {
    // Smoothed over 0.1 mm/s it would be 20 N s/m: an overdamped motion and gains that lean on it, beyond 0.1 mm/s
    // neither.
    const Model clean = test::ref_a_model(.3, 15);
    const Model rubs = clean.with_effect(make_use("coulomb_friction", {{"force", 0.002}}));
    const HeavePlant plain(clean), rubbing(rubs);
    EXPECT_TRUE(plain.left_out_of_small_motions().empty());
    ASSERT_EQ(rubbing.left_out_of_small_motions().size(), 1U);
    EXPECT_NE(rubbing.left_out_of_small_motions()[0].message.find("Coulomb friction of 2 mN"), std::string::npos);
    const auto without = heave_equilibria(plain), with = heave_equilibria(rubbing);
    ASSERT_EQ(without.size(), with.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
        EXPECT_NEAR(with[i].damping_ratio, without[i].damping_ratio, 1e-12);
        EXPECT_NEAR(rubbing.damping(with[i].gap), plain.damping(with[i].gap), 1e-9);
        EXPECT_NEAR(heave_system(rubbing, with[i].gap).a(0, 0), heave_system(plain, with[i].gap).a(0, 0), 1e-9);
    }
    const HeaveFeedback a = heave_lqr(plain, 0.05, 1, 100, 1), b = heave_lqr(rubbing, 0.05, 1, 100, 1);
    EXPECT_NEAR(a.velocity_gain, b.velocity_gain, 1e-9);
    EXPECT_NEAR(a.gap_gain, b.gap_gain, 1e-9);
    // the slope that the integrators need is still there
    EXPECT_GT(rubbing.resistance(0.05, 1e-5), plain.resistance(0.05, 1e-5));
}

TEST(Feedback, PolesOfLoopsWithDelayAndLag) {
    // x' = -x(t - pi/2): s + exp(-s pi/2) = 0 has +- i; with a lag of 1 s and no delay s^2 + s + 1.
    const Matrix none{{0}}, one{{1}};
    EXPECT_NEAR(rightmost_pole(none, one, one, std::acos(-1.) / 2, 0).real(), 0, 1e-9);
    EXPECT_NEAR(std::abs(rightmost_pole(none, one, one, std::acos(-1.) / 2, 0).imag()), 1, 1e-9);
    EXPECT_NEAR(rightmost_pole(none, one, one, 0, 1).real(), -0.5, 1e-12);
    EXPECT_NEAR(rightmost_pole(none, one, one, 1 / std::exp(1.), 0).real(), -std::exp(1.), 1e-3)
        << "a double pole at -e";
    const std::complex<double> both = rightmost_pole(none, one, one, 1, 0.5);  // s (1 + s/2) + exp(-s) = 0
    EXPECT_LT(std::abs(both * (1. + both / 2.) + std::exp(-both)), 1e-9);
}

TEST(Feedback, LqrIsForTheDeclaredActuator) {
    // M h'' = g u: k_h = sqrt(q_h), k_w = sqrt(q_w + 2 M k_h/g)
    const Model weak = test::free_model(4, 0, 0, 0).with_effect(make_use("input_gain", {{"gain", 0.2}}));
    const HeavePlant plant(weak);
    const HeaveFeedback gains = heave_lqr(plant, 1, 1, 100, 1);
    EXPECT_NEAR(gains.gap_gain, 10, 1e-6);
    EXPECT_NEAR(gains.velocity_gain, std::sqrt(1 + 2 * 4 * 10 / 0.2), 1e-6);
    EXPECT_TRUE(loop_remarks(plant, gains, true).empty());
    const HeavePlant dead(test::free_model(4, 0, 0, 0).with_effect(make_use("input_dead_zone", {{"width", 0.002}})));
    const core::Problems remarks = loop_remarks(dead, heave_lqr(dead, 1, 1, 100, 1), true);
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_NE(remarks[0].message.find("dead zone of 0.002 N"), std::string::npos) << remarks[0].message;
    EXPECT_NE(remarks[0].message.find("0.2 mm off the reference"), std::string::npos) << remarks[0].message;
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
