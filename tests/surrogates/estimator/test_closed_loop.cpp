// Oracle O88, separation, and what delay, saturation and noise do to the loop.
#include <gtest/gtest.h>

#include <cmath>

#include "cases/thesis/published.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/estimator/control/loop_region.h"

namespace underbody::estimator {
namespace {

using namespace thesis;

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
    const LoopRun with = close_loop(plant, law, LoopEstimator::with(filter), o);
    const LoopRun without = close_loop(plant, law, LoopEstimator::nothing(), o);
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
    EXPECT_NEAR(close_loop(plant, weak, LoopEstimator::nothing(), o).gap.back(), 0.417, 1e-3);
    const AugmentedModel m = p3();
    const auto filter = reduced_observer(m, reduced_gain(m, {-3, -4}), o.step).filter;
    EXPECT_NEAR(close_loop(plant, weak, LoopEstimator::with(filter), o).gap.back(), 0.0200, 2e-4);
}

// O64 with each estimator, its linear law learned from the plant.
TEST(HoldingAGap, WorksWithEveryEstimatorByName) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -1);
    for (const auto& name : loop_estimators()) {
        const LoopRun run = close_loop(plant, law, design_loop_estimator(name, plant, {}), {});
        EXPECT_NEAR(run.gap.back(), name == "none" ? 0.018260022 : 0.0200, name == "none" ? 1e-6 : 1e-5) << name;
        const std::size_t last = run.time.size() - 1;
        EXPECT_NEAR(run.total_estimate[last], run.ground_force[last] - run.drag_force[last], 1e-5) << name;
    }
}

TEST(HoldingAGap, NeedsOnlyTheGapWithAnEstimatorThatGivesTheVelocity) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.05, plant.virtual_mass, -.6, -.8);
    LoopOptions o;
    o.gap = 0.2;
    o.velocity_measured = false;
    o.feedback = Feedback::estimated;
    LoopDesign d;
    d.velocity_measured = false;
    for (const char* name : {"extended", "full", "latent", "kalman"}) {
        EXPECT_NEAR(close_loop(plant, law, design_loop_estimator(name, plant, d), o).gap.back(), 0.05, 1e-4) << name;
    }
    EXPECT_THROW(design_loop_estimator("reduced", plant, d), core::InputError);
    EXPECT_THROW(design_loop_estimator("extendet", plant, d), core::InputError);
    o.feedback = Feedback::measured;
    EXPECT_THROW(close_loop(plant, law, design_loop_estimator("extended", plant, d), o), core::InputError);
    EXPECT_THROW(close_loop(plant, law, design_loop_estimator("reduced", plant, {}), o), core::InputError);
}

TEST(HoldingAGap, RejectsAForceThatTheExtendedFilterDoesNotKnow) {
    const SeparatedPlant plant = reference_plant();
    SeparatedPlant other = plant;  // the believed table is 3 mN off and 20 % too flat
    other.ground_force = [f = plant.ground_force](double h, double& slope) {
        const double value = 0.8 * f(h, slope) + 0.003;
        slope *= 0.8;
        return value;
    };
    const ControlLaw law = hold_at(0.05, plant.virtual_mass, -1, -1);
    LoopEstimator e = design_loop_estimator("extended", plant, {});
    e.believed = other;
    const LoopRun run = close_loop(plant, law, e, {});
    EXPECT_NEAR(run.gap.back(), 0.05, 1e-5);
    LoopOptions loaded;
    loaded.disturbance = [](double t) { return t > 10 ? 0.004 : 0; };
    EXPECT_NEAR(close_loop(plant, law, design_loop_estimator("extended", plant, {}), loaded).gap.back(), 0.05, 1e-5);
    // Without an estimate the same force moves the gap by force over gain.
    const LoopRun bare = close_loop(plant, law, LoopEstimator::true_force(), loaded);
    EXPECT_NEAR(bare.gap.back() - 0.05, 0.004 / law.gap_gain, 1e-5);
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
    const LoopRun run = close_loop(plant, law, LoopEstimator::with(filter), o);
    EXPECT_GT(run.saturated, 0);
    EXPECT_NEAR(run.hold_error, 0, 1e-3);
    EXPECT_LT(run.hold_sigma, 2e-3);
    for (const double u : run.command) {
        EXPECT_LE(std::abs(u), law.limit);
    }
}

TEST(HoldingAGap, InACurrentWithDampingEffectsAndAnActuatorItHoldsWhatItIsAskedTo) {
    dynamics::Model model = dynamics::read_model_text(
        "[vehicle]\nmass = 4\nnet_weight = 0.02\n[drag.heave]\nlinear = 0.3\nquadratic = 6\n", "loop.toml", ".");
    for (const auto& use :
         {dynamics::make_use("ambient_heave_current", {{"velocity", 0.03}}),
          dynamics::make_use("linear_damping", {{"coefficient", 0.8}}),
          dynamics::make_use("quadratic_damping", {{"coefficient", 4.0}}),
          dynamics::make_use("coulomb_friction", {{"force", 0.001}}), dynamics::make_use("input_gain", {{"gain", 0.8}}),
          dynamics::make_use("input_delay", {{"delay", 0.06}}),
          dynamics::make_use("actuator_lag", {{"time_constant", 0.1}})}) {
        model = model.with_effect(use);
    }
    SeparatedPlant plant = separate(model, {});
    EXPECT_TRUE(plant.remarks.empty());
    plant.lower = 0;
    plant.upper = 1;
    const ControlLaw law = hold_at(0.1, plant.virtual_mass, -1, -1);
    LoopOptions o;
    o.gap = 0.12;
    o.velocity_noise = 1e-5;
    o.gap_noise = 1e-5;
    for (const char* name : {"extended", "disturbance"}) {
        const LoopRun run = close_loop(plant, law, design_loop_estimator(name, plant, {}), o);
        // The gain of the actuator makes the loop softer; what remains of the cancelled forces is a fifth of them.
        EXPECT_LT(std::abs(run.hold_error), 4e-3) << name;
        EXPECT_LT(run.total_force_error.value(), 2e-3) << name;
        EXPECT_NEAR(run.drag_force.back(), dynamics::HeavePlant(model).resistance(run.gap.back(), run.velocity.back()),
                    1e-12);
    }
    LoopOptions slow = o;
    dynamics::Model late = model.with_effect(dynamics::make_use("input_delay", {{"delay", 3.0}}));
    SeparatedPlant delayed = separate(late, {});
    delayed.lower = 0;
    delayed.upper = 1;
    const LoopRun swing = close_loop(delayed, law, design_loop_estimator("extended", delayed, {}), slow);
    EXPECT_GT(swing.hold_sigma,
              10 * close_loop(plant, law, design_loop_estimator("extended", plant, {}), o).hold_sigma);
}

TEST(Separation, HoldsForTheControllerAndTheReducedObserver) {
    const AugmentedModel m = p3();
    const Separation s = separation(m, hold_at(.02, thesis_virtual_mass(), -1, -2), reduced_gain(m, {-3, -4}));
    EXPECT_EQ(s.loop.size(), 6U);
    EXPECT_LT(s.mismatch, 1e-7);
    EXPECT_NEAR(s.observer[0].real(), -3, 1e-9);
}

class LoopRegionOfTheReferencePlant : public ::testing::Test {
protected:
    SeparatedPlant plant = [] {
        SeparatedPlant p = reference_plant();
        p.contact_gap = -.05;
        return p;
    }();
    ControlLaw weak() const {
        ControlLaw law;
        law.velocity_gain = .9;
        law.gap_gain = .05;
        law.reference_gap = .05;
        return law;
    }
    static LoopRegionOptions grid(double reach = 1) {
        LoopRegionOptions g;
        g.axes = {{"gap", 0, reach}, {"heave_velocity", -.03, .03}};
        g.columns = 10;
        g.rows = 6;
        g.refine = false;
        return g;
    }
};

TEST_F(LoopRegionOfTheReferencePlant, IsWiderWithCancellationThanWithout) {
    LoopOptions o;
    o.duration = 300;
    o.step = 0.1;
    LoopDesign d;
    d.step = 0.1;
    const auto with = loop_region(plant, weak(), design_loop_estimator("disturbance", plant, d), o, grid());
    const auto without = loop_region(plant, weak(), LoopEstimator::nothing(), o, grid());
    EXPECT_GT(with.fraction("held"), 0.9);
    EXPECT_LT(without.fraction("held"), 0.3);
    // What is parked lies at a root of the static balance.
    const auto points = hold_points_without_cancellation(plant, weak());
    for (const auto& c : without.classes) {
        if (c.name.rfind("parked", 0) == 0) {
            EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const HoldPoint& p) {
                return p.stable && std::abs(p.gap - c.gap) < 2e-3;
            })) << c.gap;
        }
    }
    double sum = 0;
    for (const auto& c : without.classes) {
        sum += c.fraction;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
}

// Without estimator, limit, lag and noise the loop is a spring and a damper on the plant: the open-loop room's own map.
TEST_F(LoopRegionOfTheReferencePlant, EqualsTheEnergyArgumentWhereThatHolds) {
    LoopOptions o;
    o.duration = 400;
    o.step = 0.02;
    ControlLaw law = weak();
    law.reference_gap = 0;
    law.cancel = false;
    const auto region = loop_region(plant, law, LoopEstimator::nothing(), o, grid(0.5));
    const auto points = hold_points_without_cancellation(plant, law);
    const auto energy = [&](double h, double w) {
        double work = 0, slope = 0;
        const int n = 400;
        for (int i = 0; i < n; ++i) {
            const double x = h * (i + .5) / n;
            work += (plant.ground_force(x, slope) - law.gap_gain * x) * h / n;
        }
        return 0.5 * plant.virtual_mass * w * w - work;
    };
    double barrier = INFINITY;
    for (const auto& p : points) {
        barrier = p.gap > 0.05 && !p.stable ? std::min(barrier, energy(p.gap, 0)) : barrier;
    }
    ASSERT_TRUE(std::isfinite(barrier));
    int inside = 0;
    for (std::size_t i = 0; i < region.index.size(); ++i) {
        const double h = 0.5 * (static_cast<double>(i % 10) + .5) / 10,
                     w = -.03 + .06 * (static_cast<double>(i / 10) + .5) / 6;
        if (h < 0.16 && energy(h, w) < 0.98 * barrier) {
            ++inside;
            EXPECT_EQ(region.classes[static_cast<std::size_t>(region.index[i])].name, "held") << h << " " << w;
        }
    }
    EXPECT_GT(inside, 3);
}

TEST_F(LoopRegionOfTheReferencePlant, ShrinksWithTheLimitAndIsTheSameTwiceWithNoise) {
    LoopOptions o;
    o.duration = 60;
    o.step = 0.1;
    o.actuator_lag = 0.2;
    o.gap_noise = 2e-4;
    o.velocity_noise = 2e-4;
    LoopDesign d;
    d.step = 0.1;
    ControlLaw law = hold_at(0.05, plant.virtual_mass, -.5, -.6);
    const LoopEstimator e = design_loop_estimator("extended", plant, d);
    law.limit = 0.1;
    const auto wide = loop_region(plant, law, e, o, grid());
    law.limit = 0.008;
    const auto narrow = loop_region(plant, law, e, o, grid());
    EXPECT_GT(wide.fraction("held"), narrow.fraction("held") + 0.1);
    EXPECT_EQ(loop_region(plant, law, e, o, grid()).index, narrow.index);
}

}  // namespace
}  // namespace underbody::estimator
