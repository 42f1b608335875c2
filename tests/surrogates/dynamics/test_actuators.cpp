// What the model declares between an input and the body acts wherever the input acts: recorded, constant, fed back.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/random.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

struct Case {
    const char* name;
    std::vector<EffectUse> uses;
};

std::vector<Case> actuators() {
    const EffectUse gain = make_use("input_gain", {{"gain", 0.6}}),
                    zone = make_use("input_dead_zone", {{"width", 0.002}}),
                    delay = make_use("input_delay", {{"delay", 0.7}}),
                    lag = make_use("actuator_lag", {{"time_constant", 0.9}});
    return {
        {"gain", {gain}}, {"dead zone", {zone}}, {"delay", {delay}}, {"lag", {lag}}, {"all", {gain, zone, delay, lag}}};
}

Model with(const Model& base, const std::vector<EffectUse>& uses) {
    Model model = base;
    for (const EffectUse& use : uses) {
        model = model.with_effect(use);
    }
    return model;
}

/// The same loop in the plainest way: short steps, the past as a list, the actuator written out.
double by_hand(const Model& model, const HeaveFeedback& feedback, double constant, double gap, double duration) {
    const HeavePlant plant(model);
    const Actuator& a = plant.terms.actuator;
    const double dt = 1e-4;
    double h = gap, w = 0, lagged = 0;
    std::vector<double> asked;
    for (long k = 0; static_cast<double>(k) * dt < duration - 1e-9; ++k) {
        asked.push_back(constant + feedback.command(h, w));
        const long then = std::max(0L, k - std::lround(a.delay / dt));
        const double u = asked[static_cast<std::size_t>(then)];
        const double felt = a.gain * (std::abs(u) > a.dead_zone ? u - std::copysign(a.dead_zone, u) : 0);
        lagged = k == 0 || a.lag == 0 ? felt : felt + (lagged - felt) * std::exp(-dt / a.lag);
        const double acceleration = plant.acceleration(h, w, {0, lagged});
        h += dt * (w + 0.5 * dt * acceleration);
        w += dt * acceleration;
    }
    return h;
}

TEST(Actuators, ActUnderFeedbackAndWithAConstantInputBesideIt) {
    const HeaveFeedback plain{1.5, 2.0, 0.1, 0}, limited{1.5, 2.0, 0.1, 0.006};
    for (const Case& one : actuators()) {
        const Model model = with(test::ref_a_model(0.05, 6), one.uses);
        for (const HeaveFeedback& feedback : {plain, limited}) {
            for (const double constant : {0.0, 0.004}) {
                InputSignals inputs;
                inputs.held[Channel::input_force] = constant;
                for (const double step : {0.0, 0.5}) {
                    TrajectoryOptions options;
                    options.duration = 15;
                    options.output_step = step;
                    const Trajectory motion =
                        simulate(model, 0.12, 0, inputs, options, core::Progress::none(), &feedback);
                    EXPECT_NEAR(motion.gap.back(), by_hand(model, feedback, constant, 0.12, 15), 2e-5)
                        << one.name << ", limit " << feedback.limit << ", constant " << constant << ", step " << step;
                }
            }
        }
        // It does something: the same loop without it ends elsewhere on its way.
        const double bare = by_hand(test::ref_a_model(0.05, 6), plain, 0.004, 0.12, 3);
        EXPECT_GT(std::abs(by_hand(model, plain, 0.004, 0.12, 3) - bare), 1e-4) << one.name;
    }
}

// The order in which they stand in the file says nothing: the dead zone is of the command, the gain of what it leaves.
TEST(Actuators, TheDeadZoneComesBeforeTheGainInWhicheverOrderTheyStand) {
    const EffectUse gain = make_use("input_gain", {{"gain", 0.5}}),
                    zone = make_use("input_dead_zone", {{"width", 0.002}});
    Conditions held;
    held[Channel::input_force] = 0.01;
    const Model bare = test::ref_a_model(0.05, 6);
    const double without = HeavePlant(bare).static_force(0.1);
    for (const auto& uses : {std::vector{gain, zone}, std::vector{zone, gain}}) {
        EXPECT_NEAR(HeavePlant(with(bare, uses), held).static_force(0.1) - without, 0.5 * (0.010 - 0.002), 1e-15);
    }
    // Two of a kind: gains multiply, dead zones add up.
    EXPECT_NEAR(HeavePlant(with(bare, {gain, zone, gain, zone}), held).static_force(0.1) - without,
                0.25 * (0.010 - 0.004), 1e-15);
}

TEST(Actuators, ActOnAConstantInputInEveryMotion) {
    const Model model = with(test::ref_a_model(0.05, 6), {make_use("input_gain", {{"gain", 0.5}}),
                                                          make_use("input_dead_zone", {{"width", 0.002}})});
    Conditions held;
    held[Channel::input_force] = 0.01;  // 0.5 (0.010 - 0.002) reach the body
    Conditions felt;
    felt[Channel::input_force] = 0.004;
    const HeavePlant declared(model, held), bare(test::ref_a_model(0.05, 6), felt);
    EXPECT_NEAR(declared.static_force(0.1), bare.static_force(0.1), 1e-15);
    ASSERT_EQ(heave_equilibria(declared).size(), heave_equilibria(bare).size());
    EXPECT_NEAR(heave_equilibria(declared)[0].gap, heave_equilibria(bare)[0].gap, 1e-12);
    RegionOptions options;
    options.axes = {{"gap", 0.01, 0.3}, {"heave_velocity", -0.05, 0.05}};
    options.columns = options.rows = 30;
    options.held = held;
    RegionOptions plain = options;
    plain.held = felt;
    EXPECT_EQ(stability_region(model, options).index, stability_region(test::ref_a_model(0.05, 6), plain).index);
    InputSignals inputs;
    inputs.held = held;
    TrajectoryOptions duration;
    duration.duration = 5;
    InputSignals direct;
    direct.held = felt;
    EXPECT_NEAR(simulate(model, 0.1, 0, inputs, duration).gap.back(),
                simulate(test::ref_a_model(0.05, 6), 0.1, 0, direct, duration).gap.back(), 1e-9);
}

TEST(Actuators, ADelayChangesTheMapAndItsClassesAreThoseOfTheMotion) {
    const Model base = test::ref_a_model(0.05, 6);
    RegionOptions options;
    options.axes = {{"gap", 0.02, 0.5}, {"heave_velocity", -0.08, 0.08}};
    options.columns = 16;
    options.rows = 12;
    options.duration = 60;
    options.refine = false;
    options.feedback = std::make_shared<HeaveFeedback>(HeaveFeedback{1.5, 2.0, 0.1, 0.02});
    const StabilityRegion bare = stability_region(base, options);
    for (const Case& one : {Case{"delay", {make_use("input_delay", {{"delay", 3.0}})}},
                            Case{"lag", {make_use("actuator_lag", {{"time_constant", 3.0}})}}}) {
        const Model model = with(base, one.uses);
        const StabilityRegion slow = stability_region(model, options);
        int differ = 0, wrong = 0, asked = 0;
        for (std::size_t k = 0; k < slow.index.size(); ++k) {
            const EndClass& end = slow.classes[static_cast<std::size_t>(slow.index[k])];
            differ += end.name != bare.classes[static_cast<std::size_t>(bare.index[k])].name ? 1 : 0;
            if (k % 7 != 0) {
                continue;
            }
            const double gap = 0.02 + 0.48 * (static_cast<double>(k % 16) + 0.5) / 16,
                         velocity = -0.08 + 0.16 * (static_cast<double>(k / 16) + 0.5) / 12;
            TrajectoryOptions motion;
            motion.duration = 60;
            motion.stop_at_contact = true;
            motion.escape_gap = slow.escape_gap;
            const std::string ends =
                simulate(model, gap, velocity, {}, motion, core::Progress::none(), options.feedback.get()).end;
            ++asked;
            wrong += (ends == "contact") != (end.kind == EndKind::contact) ||
                             (ends == "escape") != (end.kind == EndKind::escape)
                         ? 1
                         : 0;
        }
        EXPECT_GT(differ, 8) << one.name;
        EXPECT_LE(wrong, 1) << one.name << " of " << asked;
    }
}

TEST(Actuators, HeaveAndPitchClosesTheSameLoop) {
    for (const Case& one : actuators()) {
        Model model = with(test::ref_a_model(0.05, 6), one.uses);
        model.vehicle.pitch_inertia = 0.02;
        model.vehicle.base_depth = 0.05;
        model.vehicle.base_half_length = 0.07;
        const HeaveFeedback feedback{1.5, 2.0, 0.1, 0.006};
        HeavePitch both(model);
        PitchFeedback pitch;
        pitch.force_gain = {1.5, 2.0, 0, 0};
        pitch.reference[0] = 0.1;
        pitch.force_limit = 0.006;
        both.close_loop(pitch);
        for (const double step : {0.0, 0.25}) {
            TrajectoryOptions options;
            options.duration = 10;
            options.output_step = step;
            const Trajectory heave = simulate(model, 0.12, 0.01, {}, options, core::Progress::none(), &feedback);
            const PitchTrajectory coupled = simulate(both, {0.12, 0.01, 0, 0}, options);
            EXPECT_NEAR(coupled.state.back()[0], heave.gap.back(), 2e-7) << one.name << ", step " << step;
        }
        RegionOptions map;
        map.axes = {{"gap", 0.02, 0.4}, {"heave_velocity", -0.08, 0.08}};
        map.columns = 8;
        map.rows = 6;
        map.duration = 40;
        map.refine = false;
        map.feedback = std::make_shared<HeaveFeedback>(feedback);
        RegionOptions pitch_map = map;
        pitch_map.motion = RegionOptions::Motion::heave_pitch;
        const StabilityRegion alone = stability_region(model, map), together = stability_region(model, pitch_map);
        int differ = 0;
        for (std::size_t k = 0; k < alone.index.size(); ++k) {
            const EndKind a = alone.classes[static_cast<std::size_t>(alone.index[k])].kind,
                          b = together.classes[static_cast<std::size_t>(together.index[k])].kind;
            differ +=
                (a == EndKind::contact) != (b == EndKind::contact) || (a == EndKind::escape) != (b == EndKind::escape)
                    ? 1
                    : 0;
        }
        EXPECT_EQ(differ, 0) << one.name;
    }
}

}  // namespace

}  // namespace underbody::dynamics
