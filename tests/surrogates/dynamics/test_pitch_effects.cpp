// Effects on the pitch against their closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

constexpr double inertia = 0.00735, mass = 3.954, depth = 0.0514;

Model bare(const std::string& more = "", const std::string& vehicle = "") {
    return read_model_text(
        "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.754\npitch_inertia = 0.00685\nadded_inertia_pitch = 0.0005\n"
        "base_depth = 0.0514\nbase_half_length = 0.0717\nnet_weight = 0.03\nroll_inertia = 0.005\nyaw_inertia = 0.007\n"
        "base_half_width = 0.05\n" +
            vehicle + more,
        "bare.toml", ".");
}

/// Accelerations of the centre of gravity (up) and of the pitch.
struct Rates {
    double up = 0, turn = 0;
};
Rates rates(const Model& model, const PitchState& y, double input = 0) {
    const HeavePitch plant(model);
    PitchState d{};
    Surroundings around;
    around.input = input;
    plant.rate(y, ContactState::free, d, around);
    const double slope = depth * std::cos(y[2]);
    return {d[1] - plant.arm(y[2]) * d[3] - slope * y[3] * y[3], d[3]};
}

/// What an effect adds to force and moment.
struct Added {
    double force = 0, moment = 0;
};
Added added(const EffectUse& use, const PitchState& y, double input = 0) {
    const Rates before = rates(bare(), y, input), after = rates(bare().with_effect(use), y, input);
    return {mass * (after.up - before.up), inertia * (after.turn - before.turn)};
}

const PitchState state{0.12, 0.03, 0.07, -0.2};

TEST(PitchEffects, AddTheMomentOfTheirFormula) {
    const double input = 0.04, s = std::sin(state[2]), c = std::cos(state[2]), q = state[3];
    const auto moment = [&](const char* name, const char* parameter, double value) {
        const Added one = added(make_use(name, {{parameter, value}}), state, input);
        EXPECT_NEAR(one.force, 0, 1e-14) << name;
        return one.moment;
    };
    EXPECT_NEAR(moment("pitch_damping", "coefficient", 0.003), -0.003 * q, 1e-14);
    EXPECT_NEAR(moment("pitch_quadratic_damping", "coefficient", 0.02), -0.02 * q * std::abs(q), 1e-14);
    EXPECT_NEAR(moment("pitch_stiffness", "stiffness", 0.02), -0.02 * s, 1e-14);
    EXPECT_NEAR(moment("moment_offset", "moment", 0.001), 0.001, 1e-14);
    EXPECT_NEAR(moment("input_arm", "arm", 0.01), 0.01 * c * input, 1e-14);
    EXPECT_NEAR(moment("pitch_sensor_bias", "bias", 0.01), 0, 1e-14);
}

TEST(PitchEffects, ATetherPullsAtItsPoint) {
    const double k = 1.5, gap = 0.1, ahead = 0.04, s = std::sin(state[2]), c = std::cos(state[2]);
    const Added one = added(make_use("tether_with_arm", {{"stiffness", k}, {"gap", gap}, {"arm", ahead}}), state);
    const double force = -k * (state[0] + ahead * s - gap);
    EXPECT_NEAR(one.force, force, 1e-13);
    EXPECT_NEAR(one.moment, (depth * s + ahead * c) * force, 1e-13);
    // at the middle of the base it is the tether of heave with its moment
    const Added middle = added(make_use("tether_with_arm", {{"stiffness", k}, {"gap", gap}, {"arm", 0}}), state);
    const Added plain = added(make_use("tether_stiffness", {{"stiffness", k}, {"gap", gap}}), state);
    EXPECT_NEAR(middle.force, plain.force, 1e-13);
    EXPECT_NEAR(middle.moment, depth * s * plain.force, 1e-13);
    // two of them add
    Model both = bare().with_effect(make_use("tether_with_arm", {{"stiffness", k}, {"gap", gap}, {"arm", ahead}}));
    both = both.with_effect(make_use("tether_with_arm", {{"stiffness", 0.7}, {"gap", 0.2}, {"arm", -0.03}}));
    const Added other = added(make_use("tether_with_arm", {{"stiffness", 0.7}, {"gap", 0.2}, {"arm", -0.03}}), state);
    EXPECT_NEAR(inertia * (rates(both, state).turn - rates(bare(), state).turn), one.moment + other.moment, 1e-13);
}

TEST(PitchEffects, AShiftedCentreOfGravityIsADeclaredOne) {
    const std::string centres = "centre_of_buoyancy = [0, 0, 0]\n";
    const Model declared = bare("", "centre_of_gravity = [0, 0, 0.02]\n" + centres);
    const Model moved = bare("", "centre_of_gravity = [0.004, 0, 0.02]\n" + centres);
    const Model found = declared.with_effect(make_use("mass_centre_offset", {{"distance", 0.004}}));
    const HeavePitch a(moved), b(found);
    for (const double pitch : {-0.1, 0.0, 0.15}) {
        PitchState da{}, db{};
        a.rate({0.1, 0.02, pitch, 0.3}, ContactState::free, da);
        b.rate({0.1, 0.02, pitch, 0.3}, ContactState::free, db);
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(da[i], db[i], 1e-12);
        }
    }
}

TEST(PitchEffects, InertiaDividesAndMustStayPositive) {
    const Model more = bare("[drag.pitch]\nlinear = 0.004\n");
    const double before = rates(more, state).turn;
    const double after = rates(more.with_effect(make_use("added_pitch_inertia", {{"inertia", inertia}})), state).turn;
    EXPECT_NEAR(after, before / 2, 1e-12);
    EXPECT_THROW(HeavePitch(more.with_effect(make_use("added_pitch_inertia", {{"inertia", -2 * inertia}}))),
                 core::InputError);
}

/// Accelerations du, dv, dw, dq, dr of the whole body.
std::array<double, 5> body_rates(const Model& model, const BodyState& y, const std::vector<double>& thrust) {
    const RigidBody body(model);
    BodyState d{};
    Surroundings around;
    around.input = 0.04;
    body.rate(y, thrust, ContactState::free, d, around);
    return {d[0], d[1], d[2], d[3], d[4]};
}

TEST(PitchEffects, ActOnTheWholeBodyAsInHeaveWithPitch) {
    BodyState y{};
    y[state_theta] = state[2];
    y[state_q] = state[3];
    y[state_z] = RigidBody(bare()).height_for_gap(state[0], state[2]);
    for (const EffectUse& use : {make_use("pitch_damping", {{"coefficient", 0.003}}),
                                 make_use("pitch_quadratic_damping", {{"coefficient", 0.02}}),
                                 make_use("pitch_stiffness", {{"stiffness", 0.02}}),
                                 make_use("moment_offset", {{"moment", 0.001}}), make_use("input_arm", {{"arm", 0.01}}),
                                 make_use("tether_with_arm", {{"stiffness", 1.5}, {"gap", 0.1}, {"arm", 0.04}})}) {
        const std::array<double, 5> before = body_rates(bare(), y, {}),
                                    after = body_rates(bare().with_effect(use), y, {});
        const Added one = added(use, state, 0.04);
        EXPECT_NEAR(inertia * (after[3] - before[3]), one.moment, 1e-13) << use.name;
        EXPECT_NEAR(mass * (after[2] - before[2]), -one.force * std::cos(state[2]), 1e-13) << use.name;
        EXPECT_NEAR(after[4], before[4], 1e-13) << use.name;
    }
    EXPECT_THROW(RigidBody(bare().with_effect(make_use("added_pitch_inertia", {{"inertia", -0.0074}}))),
                 core::InputError);
}

TEST(PitchEffects, AShiftedCentreOfGravityOfTheWholeBodyIsADeclaredOne) {
    const auto jet = [](const char* place) {
        return std::string("[[jet]]\nname = \"a\"\nposition = ") + place +
               "\ndirection = [0.6, 0, -0.8]\nmaximum = 1\n";
    };
    const std::string centres = "centre_of_buoyancy = [0, 0, 0]\n";
    const Model declared = bare(jet("[0.05, 0.02, 0]"), "centre_of_gravity = [0, 0, 0.02]\n" + centres);
    const Model moved = bare(jet("[0.046, 0.017, 0]"), "centre_of_gravity = [0.004, 0.003, 0.02]\n" + centres);
    const Model found = declared.with_effect(make_use("mass_centre_offset", {{"distance", 0.004}}))
                            .with_effect(make_use("mass_centre_aside", {{"offset", 0.003}}));
    const BodyState y{0.3, 0.05, -0.02, 0.2, 0.4, 0.1, 0.7, 0, 0, -0.2};
    const std::array<double, 5> a = body_rates(moved, y, {0.3}), b = body_rates(found, y, {0.3});
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(a[i], b[i], 1e-12) << i;
    }
}

}  // namespace

}  // namespace underbody::dynamics
