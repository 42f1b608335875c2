// Heave against closed forms: springs, drag, impact, memory, inputs.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/plant/heave.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

TEST(Heave, OscillatesAtTheFrequencyOfItsSpringAndConservesEnergyWithoutDrag) {
    const Model model = test::spring_model(220.0, 2.2, 0, 0);
    TrajectoryOptions options;
    options.duration = 10;
    options.output_step = 0.05;
    const Trajectory motion = simulate(model, 0.12, 0, {}, options);
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
        EXPECT_NEAR(motion.gap[i], 0.1 + 0.02 * std::cos(10 * motion.time[i]), 5e-8);
    }
    const auto equilibria = heave_equilibria(HeavePlant(model));
    ASSERT_EQ(equilibria.size(), 1U);
    EXPECT_NEAR(equilibria[0].frequency, 10, 1e-6);  // O31
    EXPECT_NEAR(equilibria[0].gap, 0.1, 1e-9);
}

TEST(Heave, DecaysAsALinearDamperSays) {
    const Model model = test::spring_model(100.0, 4.0, 2.0, 0);
    TrajectoryOptions options;
    options.duration = 8;
    options.output_step = 0.1;
    const Trajectory motion = simulate(model, 0.11, 0, {}, options);
    const double rate = 2.0 / 8, omega = std::sqrt(25 - rate * rate);
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
        const double t = motion.time[i];
        const double expected =
            0.1 + 0.01 * std::exp(-rate * t) * (std::cos(omega * t) + rate / omega * std::sin(omega * t));
        EXPECT_NEAR(motion.gap[i], expected, 2e-8);
    }
}

TEST(Heave, SinksWithQuadraticDragAsTheTanhSays) {
    // m w' = -W + D w^2 while sinking: w = -v tanh(t D v / m), v = sqrt(W/D)
    const Model model = test::free_model(2.0, 0.5, 0, 5.0);
    TrajectoryOptions options;
    options.duration = 3;
    options.output_step = 0.25;
    const Trajectory motion = simulate(model, 5, 0, {}, options);
    const double v = std::sqrt(0.5 / 5.0);
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
        EXPECT_NEAR(motion.heave_velocity[i], -v * std::tanh(motion.time[i] * 5.0 * v / 2.0), 1e-8);
    }
}

TEST(Heave, StopsAtTheGroundAndBouncesByItsRestitution) {
    Model model = test::free_model(2.0, 0.5, 0, 0);
    TrajectoryOptions options;
    options.duration = 4;
    Trajectory motion = simulate(model, 0.5, 0, {}, options);
    ASSERT_EQ(motion.events.size(), 1U);
    EXPECT_NEAR(motion.events[0].time, 2, 1e-8);  // 0.5 = 0.25/2 t^2
    EXPECT_NEAR(motion.events[0].velocity, -0.5, 1e-8);
    EXPECT_NEAR(motion.gap.back(), 0, 1e-12);
    model.contact.restitution = 0.5;
    motion = simulate(model, 0.5, 0, {}, options);
    ASSERT_GE(motion.events.size(), 2U);
    EXPECT_NEAR(motion.events[1].time, 4, 1e-7);  // up and down again at half the speed: 2 * 0.25/0.25 s later
    EXPECT_THROW(simulate(model, -0.01, 0, {}, options), core::InputError);
}

/// A law over gap and velocity at once was left out of the damping of small motions, which simulate has.
TEST(Heave, ALawOverGapAndVelocityDampsSmallMotions) {
    constexpr double linear = 0.05, late = 0.4, mass = 1 / 0.2529;
    const Model model = test::ref_a_model(linear, 15, 0.01);
    const auto found = heave_equilibria(HeavePlant(model.with_effect(make_use("lift_lag", {{"time_constant", late}}))));
    int looked_at = 0;
    for (const HeaveEquilibrium& e : found) {
        if (e.gap < 0.05) {
            continue;  // below 2 mm the lag's own table ends
        }
        const double damping = linear - late * e.stiffness;  // F = -late L' w, and L' = -stiffness
        if (e.stable) {
            const double ratio = damping / (2 * std::sqrt(e.stiffness * mass));
            EXPECT_NEAR(e.damping_ratio, ratio, 0.02 * std::abs(ratio)) << e.gap;
        } else {
            const double half = damping / (2 * mass);
            EXPECT_NEAR(e.growth, -half + std::sqrt(half * half - e.stiffness / mass), 0.002 * e.growth) << e.gap;
        }
        ++looked_at;
    }
    EXPECT_EQ(looked_at, 2);
}

TEST(Heave, RestsOnTheGroundUntilTheInputLiftsIt) {
    const Model model = test::free_model(2.0, 0.5, 0, 0);
    InputSignals inputs;
    inputs.time = {0, 1, 2, 10};
    inputs.signals = {{Channel::input_force, {0, 0, 1, 1}}};
    TrajectoryOptions options;
    options.duration = 4;
    const Trajectory motion = simulate(model, 0, 0, inputs, options);
    ASSERT_EQ(motion.events.size(), 2U);
    EXPECT_EQ(motion.events[1].kind, "lift_off");
    EXPECT_NEAR(motion.events[1].time, 1.5, 1e-9);
    // from then: a = (t - 1.5)/2 until 2 s, then 0.25
    EXPECT_NEAR(motion.gap.back(), 0.125 / 12 + 0.0625 * 2 + 0.25 * 2, 1e-6);
}

/// A jump written as two rows a microsecond apart made steps of a microsecond all along: ten million rows.
TEST(Heave, AJumpOfTheInputTakesNoTinySteps) {
    const Model model = test::free_model(2.0, 0.5, 0, 0);
    InputSignals inputs;
    inputs.time = {0, 2, 2.000001, 10};
    inputs.signals = {{Channel::input_force, {0, 0, 1, 1}}};
    TrajectoryOptions options;
    options.duration = 4;
    for (const double step : {0.0, 0.5}) {
        options.output_step = step;
        const Trajectory motion = simulate(model, 5, 0, inputs, options);
        EXPECT_LT(motion.time.size(), 1000U) << step;
        EXPECT_NEAR(motion.gap.back(), 4, 1e-6) << step;  // 2 s down at 0.25 m/s^2, then 2 s up
    }
}

TEST(Heave, WritesOneRowAnOutputStep) {
    TrajectoryOptions options;
    for (const double step : {.1, .3, .7, 1.0 / 3}) {
        options.duration = 60 * step;
        options.output_step = step;
        const Trajectory swinging = simulate(test::spring_model(100.0, 4.0, 1.0, 0), 0.15, 0, {}, options);
        EXPECT_EQ(swinging.time.size(), 61U) << step;
        EXPECT_DOUBLE_EQ(swinging.time.back(), options.duration);
        InputSignals inputs;  // resting on the ground
        inputs.time = {0, 100};
        inputs.signals = {{Channel::input_force, {0, .1}}};
        const Trajectory resting = simulate(test::free_model(2.0, 0.5, 0, 0), 0, 0, inputs, options);
        EXPECT_EQ(resting.time.size(), 61U) << step;
    }
}

TEST(Heave, EndsAtItsEquilibriumWhenAskedTo) {
    const Model model = test::spring_model(100.0, 4.0, 40.0, 0);
    TrajectoryOptions options;
    options.stop_at_equilibrium = true;
    const Trajectory motion = simulate(model, 0.15, 0, {}, options);
    EXPECT_EQ(motion.end, "equilibrium");
    EXPECT_NEAR(motion.gap.back(), 0.1, 1e-5);
    EXPECT_LT(motion.time.back(), 10);
}

TEST(Heave, KeepsEnergyWithAddedMassThatGrowsTowardTheGround) {
    Model model = test::spring_model(50.0, 2.0, 0, 0);
    model = model.with_effect(make_use("gap_dependent_added_mass", {{"mass", 5.0}, {"length", 0.02}}));
    TrajectoryOptions options;
    options.duration = 10;
    options.tolerance = 1e-11;
    const Trajectory motion = simulate(model, 0.17, 0, {}, options);
    const auto energy = [](double h, double w) {
        return 0.5 * (2.0 + 5.0 * 0.02 / (h + 0.02)) * w * w + 25 * (h - 0.1) * (h - 0.1);
    };
    const double start = energy(0.17, 0);
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
        EXPECT_NEAR(energy(motion.gap[i], motion.heave_velocity[i]) / start, 1, 5e-8);
    }
}

TEST(Heave, FastRunsAgreeWithCvodeForEveryEffect) {
    const Model base = test::ref_a_model();
    InputSignals inputs;
    for (int i = 0; i <= 500; ++i) {
        inputs.time.push_back(0.02 * i);
    }
    std::vector<double> u;
    for (const double t : inputs.time) {
        u.push_back(0.01 * std::sin(1.3 * t) + 0.004 * std::cos(3.1 * t));
    }
    inputs.signals = {{Channel::input_force, u}};
    const std::vector<EffectUse> uses{
        make_use("constant_force", {{"force", 0.003}}),
        make_use("coulomb_friction", {{"force", 0.004}}),
        make_use("linear_damping", {{"coefficient", 0.3}}),
        make_use("quadratic_damping", {{"coefficient", 8.0}}),
        make_use("squeeze_film_damping", {{"coefficient", 2e-5}}),
        make_use("added_mass", {{"mass", 0.7}}),
        make_use("gap_dependent_added_mass", {{"mass", 2.0}, {"length", 0.05}}),
        make_use("tether_stiffness", {{"stiffness", 0.05}, {"gap", 0.2}}),
        make_use("ambient_heave_current", {{"velocity", 0.01}}),
        make_use("periodic_disturbance", {{"amplitude", 0.01}, {"frequency", 0.4}, {"phase", 0.5}}),
        make_use("input_gain", {{"gain", 0.8}}),
        make_use("input_dead_zone", {{"width", 0.003}}),
        make_use("input_delay", {{"delay", 0.25}}),
        make_use("actuator_lag", {{"time_constant", 0.4}}),
        make_use("surface_roughness", {{"near", 0.3}, {"far", 0.2}, {"length", 0.1}}),
        make_use("history_force", {{"area", 2.0}}),
    };
    for (const EffectUse& use : uses) {
        const Model model = base.with_effect(use);
        TrajectoryOptions options;
        options.duration = 10;
        options.output_step = 0.02;
        const Trajectory exact = simulate(model, 0.12, 0.004, inputs, options);
        const HeavePlant plant = plant_for(model, inputs);
        const HeaveRun run(plant, inputs);
        std::vector<double> gap(run.samples()), velocity(run.samples());
        run.simulate(plant, 0, run.samples() - 1, 0.12, 0.004, gap, velocity);
        double worst = 0;
        for (std::size_t i = 0; i < gap.size(); ++i) {
            worst = std::max(worst, std::abs(gap[i] - exact.gap[i]));
        }
        EXPECT_LT(worst, 2e-6) << use.name;
    }
}

TEST(Heave, RungeKuttaOfTheFastRunIsOfFourthOrder) {
    const Model model = test::spring_model(100.0, 4.0, 1.0, 0);
    const auto error = [&](double step) {
        InputSignals inputs;
        inputs.time = {0, 2};
        const HeavePlant plant(model);
        const HeaveRun run(plant, inputs, step);
        std::vector<double> gap(2);
        run.simulate(plant, 0, 1, 0.11, 0, gap, {});
        const double rate = 1.0 / 8, omega = std::sqrt(25 - rate * rate);
        return std::abs(gap[1] - 0.1 -
                        0.01 * std::exp(-rate * 2) * (std::cos(omega * 2) + rate / omega * std::sin(omega * 2)));
    };
    const double order = std::log2(error(0.02) / error(0.01));
    EXPECT_NEAR(order, 4, 0.1);
}

TEST(Heave, TheHistoryKernelIsTheInverseRoot) {
    const HistoryKernel& kernel = history_kernel();
    for (double t = 0.02; t < 100; t *= 1.5) {
        double sum = 0;
        for (std::size_t i = 0; i < history_states; ++i) {
            sum += kernel.weight[i] * std::exp(-kernel.rate[i] * t);
        }
        EXPECT_NEAR(sum * std::sqrt(t), 1, 0.04) << t;
    }
    // All of it from 0 to t: 2 sqrt(t).
    const double t = 2.0;
    double integral = kernel.mass;
    for (std::size_t i = 0; i < history_states; ++i) {
        integral += kernel.weight[i] / kernel.rate[i] * (1 - std::exp(-kernel.rate[i] * t));
    }
    EXPECT_NEAR(integral / (2 * std::sqrt(t)), 1, 0.02);
}

TEST(Heave, FindsTheEquilibriaOfTheReferenceTable) {
    const auto equilibria = heave_equilibria(HeavePlant(test::ref_a_model()));
    ASSERT_EQ(equilibria.size(), 2U);
    EXPECT_TRUE(equilibria[0].stable);
    EXPECT_NEAR(equilibria[0].gap, 0, 1e-9);
    EXPECT_NEAR(equilibria[1].gap, 0.16, 1e-9);
    EXPECT_NEAR(equilibria[0].frequency, 0.33635543, 1e-6);  // O55
    EXPECT_NEAR(equilibria[1].growth, 0.23036161, 1e-6);
}

}  // namespace

}  // namespace underbody::dynamics
