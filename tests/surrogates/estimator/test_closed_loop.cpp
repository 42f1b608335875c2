// Oracle O88, separation, and what delay, saturation and noise do to the loop.
#include <gtest/gtest.h>

#include <cmath>

#include "surrogates/estimator/closed_loop.h"
#include "surrogates/estimator/published.h"

namespace underbody::estimator {
namespace {

AugmentedModel p3() {
    const AugmentedModel m = published_8_47();
    return corrected(m, Correction::p3, heave_rows(m.layout, thesis_virtual_mass(), 0));
}

TEST(HoldingAGap, IsOffWithoutCancellationAndRightWithIt) {
    const SeparatedPlant plant = reference_plant();
    const double s = plant.virtual_mass;
    const ControlLaw law = hold_at(0.02, s, -1, -1);  // k_w = 2 S, k_h = S
    EXPECT_NEAR(law.velocity_gain, 2 * s, 1e-12);
    EXPECT_NEAR(law.gap_gain, s, 1e-12);
    const auto points = hold_points_without_cancellation(plant, law);
    ASSERT_EQ(points.size(), 1U);
    EXPECT_NEAR(points[0].gap, 0.018260022, 1e-7);  // O88
    const AugmentedModel m = p3();
    LoopOptions o;
    const auto filter = reduced_observer(m, reduced_gain(m, {-3, -4}), o.step).filter;
    const LoopRun with = close_loop(plant, law, ForceSource::filter, filter, o);
    const LoopRun without = close_loop(plant, law, ForceSource::none, {}, o);
    EXPECT_NEAR(with.gap.back(), 0.0200, 1e-4);
    EXPECT_NEAR(without.gap.back(), 0.018260, 1e-6);
    const std::size_t last = with.time.size() - 1;
    EXPECT_LT(std::abs(with.total_estimate[last] - (with.ground_force[last] - with.drag_force[last])), 1e-5);
}

TEST(HoldingAGap, ParksFarAwayWithWeakGainsUnlessTheForceIsCancelled) {
    const SeparatedPlant plant = reference_plant();
    ControlLaw weak;
    weak.velocity_gain = .9;
    weak.gap_gain = .05;
    weak.reference_gap = .02;
    LoopOptions o;
    o.duration = 900;
    o.step = 0.05;
    EXPECT_NEAR(close_loop(plant, weak, ForceSource::none, {}, o).gap.back(), 0.417, 1e-3);
    const AugmentedModel m = p3();
    const auto filter = reduced_observer(m, reduced_gain(m, {-3, -4}), o.step).filter;
    EXPECT_NEAR(close_loop(plant, weak, ForceSource::filter, filter, o).gap.back(), 0.0200, 2e-4);
}

TEST(HoldingAGap, WorksWithEveryEstimator) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.05, plant.virtual_mass, -1, -1.2);
    const AugmentedModel m = p3();
    LoopOptions o;
    o.gap = 0.1;
    const std::vector<std::string> sensors{"heave_velocity", "gap"};
    const Matrix l = full_gain(m, sensors, {-3, -4, -5, -6});
    const LinearFilter filters[] = {reduced_observer(m, reduced_gain(m, {-3, -4}), o.step).filter, full_observer(m, sensors, l, o.step).filter,
                                    disturbance_observer(plant.virtual_mass, 0, 5, o.step).filter,
                                    kalman_observer(m, sensors, {0, 0, 1e-5, 1e-5}, {1e-4, 1e-4}, o.step).filter};
    for (const auto& filter : filters) {
        const LoopRun run = close_loop(plant, law, ForceSource::filter, filter, o);
        EXPECT_NEAR(run.hold_error, 0, 1.5e-4) << filter.name;
        EXPECT_LT(run.total_force_error, 3e-4) << filter.name;
    }
}

TEST(HoldingAGap, SurvivesSaturationLagAndNoise) {
    SeparatedPlant plant = reference_plant();
    plant.bias = -0.005;
    plant.contact_gap = -0.05;
    ControlLaw law = hold_at(0.05, plant.virtual_mass, -.6, -.8);
    law.limit = 0.03;
    LoopOptions o;
    o.gap = 0.3;
    o.actuator_lag = 0.2;
    o.velocity_noise = 2e-4;
    o.gap_noise = 5e-4;
    const LinearFilter filter = disturbance_observer(plant.virtual_mass, plant.bias, 2, o.step).filter;
    const LoopRun run = close_loop(plant, law, ForceSource::filter, filter, o);
    EXPECT_GT(run.saturated, 0);
    EXPECT_NEAR(run.hold_error, 0, 1e-3);
    EXPECT_LT(run.hold_sigma, 2e-3);
    for (const double u : run.command) {
        EXPECT_LE(std::abs(u), law.limit);
    }
}

TEST(Separation, HoldsForTheControllerAndTheReducedObserver) {
    const AugmentedModel m = p3();
    const Separation s = separation(m, hold_at(.02, thesis_virtual_mass(), -1, -2), reduced_gain(m, {-3, -4}));
    EXPECT_EQ(s.loop.size(), 6U);
    EXPECT_LT(s.mismatch, 1e-7);
    EXPECT_NEAR(s.observer[0].real(), -3, 1e-9);
}

TEST(LoopRegion, IsWiderWithCancellationThanWithout) {
    SeparatedPlant plant = reference_plant();
    plant.contact_gap = -.05;
    ControlLaw law;
    law.velocity_gain = .9;
    law.gap_gain = .05;
    law.reference_gap = .05;
    LoopOptions o;
    o.duration = 300;
    o.step = 0.1;
    const LinearFilter filter = disturbance_observer(plant.virtual_mass, 0, 4, o.step).filter;
    const LoopRegion with = loop_region(plant, law, ForceSource::filter, filter, o, 10, 6, 0, 1, -.03, .03);
    const LoopRegion without = loop_region(plant, law, ForceSource::none, {}, o, 10, 6, 0, 1, -.03, .03);
    EXPECT_GT(with.holds, 0.9);
    EXPECT_LT(without.holds, 0.3);
}

}  // namespace
}  // namespace underbody::estimator
