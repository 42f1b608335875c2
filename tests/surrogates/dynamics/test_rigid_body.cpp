// The rigid body: energy, momentum, contact states, jets with lag.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

/// EVIE in ideal fluid (Lamb's added mass), neutrally buoyant unless told otherwise.
Model evie(double net_weight = 0, double friction = 0) {
    return read_model_text(
        "[vehicle]\nmass = 2.2\nadded_mass_surge = 0.79865194\nadded_mass_sway = 1.335082\nadded_mass_heave = "
        "1.4565619\n"
        "roll_inertia = 0.00485441\npitch_inertia = 0.00685484\nyaw_inertia = 0.00708337\nadded_inertia_roll = "
        "8.7418652e-06\n"
        "added_inertia_pitch = 0.0005086667\nadded_inertia_yaw = 0.00037700395\nbase_depth = 0.0514\nbase_half_length "
        "= 0.0717\n"
        "buoyancy_height = 0.005\nnet_weight = " +
            test::number(net_weight) + "\n[contact]\nfriction = " + test::number(friction) + "\n",
        "evie.toml", ".");
}

template <class Rate>
BodyState rk4(const BodyState& y, double step, const Rate& rate) {
    BodyState k1{}, k2{}, k3{}, k4{}, m{};
    const auto at = [&](const BodyState& k, double part) {
        for (std::size_t i = 0; i < y.size(); ++i) {
            m[i] = y[i] + part * step * k[i];
        }
        return m;
    };
    rate(y, k1);
    rate(at(k1, .5), k2);
    rate(at(k2, .5), k3);
    rate(at(k3, 1), k4);
    BodyState next = y;
    for (std::size_t i = 0; i < y.size(); ++i) {
        next[i] += step / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    return next;
}

TEST(RigidBody, KeepsItsEnergyInIdealFluidAndThePrintedEquationsDoNot) {  // O87
    const RigidBody body(evie());
    BodyState y{};
    y[state_u] = .35;
    y[state_v] = .02;
    y[state_r] = .1;
    y[state_z] = -10;
    BodyState printed = y;
    const double start = body.kinetic_energy(y);
    const auto rate = [&](const BodyState& s, BodyState& d) { body.rate(s, {}, ContactState::free, d); };
    const double m = 2.2, sx = 2.99865194, sy = 3.535082, sr = 0.0074603703, munk = -0.53643006;
    const auto as_printed = [&](const BodyState& s, BodyState& d) {
        d = {};
        d[state_u] = m * s[state_r] * s[state_v] / sx;
        d[state_v] = -m * s[state_r] * s[state_u] / sy;
        d[state_r] = munk * s[state_u] * s[state_v] / sr;
    };
    for (int i = 0; i < 10000; ++i) {
        y = rk4(y, 1e-3, rate);
        printed = rk4(printed, 1e-3, as_printed);
    }
    EXPECT_NEAR(body.kinetic_energy(y) / start, 1, 1e-10);
    const auto energy = [&](const BodyState& s) {
        return sx * s[state_u] * s[state_u] + sy * s[state_v] * s[state_v] + sr * s[state_r] * s[state_r];
    };
    BodyState first{};
    first[state_u] = .35;
    first[state_v] = .02;
    first[state_r] = .1;
    EXPECT_NEAR(energy(printed) / energy(first) - 1, 0.04426, 1e-4);
}

TEST(RigidBody, KeepsItsEnergyWhenPitchedToo) {
    const RigidBody body(evie());
    Model calm = evie();
    calm.vehicle.buoyancy_height = 0;
    const RigidBody free(calm);
    core::Random random(3);
    for (int trial = 0; trial < 5; ++trial) {
        BodyState y{};
        y[state_u] = random.uniform(-.4, .4);
        y[state_v] = random.uniform(-.1, .1);
        y[state_w] = random.uniform(-.1, .1);
        y[state_q] = random.uniform(-.2, .2);
        y[state_r] = random.uniform(-.3, .3);
        y[state_theta] = random.uniform(-.5, .5);
        y[state_z] = -10;
        BodyOptions options;
        options.duration = 10;
        options.tolerance = 1e-12;
        const BodyTrajectory motion = simulate_body(free, y, nullptr, options);
        const double start = free.kinetic_energy(y);
        for (const BodyState& state : motion.state) {
            if (std::abs(state[state_theta]) < 1.3) {
                EXPECT_NEAR(free.kinetic_energy(state) / start, 1, 1e-8);
            }
        }
    }
}

TEST(RigidBody, MirrorsItsMotionWhenTheStartIsMirrored) {
    const RigidBody body(evie());
    BodyState left{}, right{};
    left[state_u] = right[state_u] = .3;
    left[state_v] = .02;
    right[state_v] = -.02;
    left[state_r] = .05;
    right[state_r] = -.05;
    left[state_theta] = right[state_theta] = .1;
    left[state_z] = right[state_z] = -5;
    BodyOptions options;
    options.duration = 3;
    const BodyTrajectory a = simulate_body(body, left, nullptr, options),
                         b = simulate_body(body, right, nullptr, options);
    EXPECT_NEAR(a.state.back()[state_y], -b.state.back()[state_y], 1e-7);
    EXPECT_NEAR(a.state.back()[state_z], b.state.back()[state_z], 1e-7);
    EXPECT_NEAR(a.roll_rate.back(), -b.roll_rate.back(), 1e-7);
}

TEST(RigidBody, SlidesFlatAndStopsByFriction) {
    // mu N = 0.3 * 0.5 N on S_x: u falls by mu N/S_x a second
    const RigidBody body(evie(.5, .3));
    BodyState y{};
    y[state_u] = .2;
    y[state_z] = body.height_for_gap(0, 0);
    BodyOptions options;
    options.duration = 3;
    const BodyTrajectory motion = simulate_body(body, y, nullptr, options);
    EXPECT_EQ(motion.contact.front(), ContactState::flat);
    EXPECT_NEAR(motion.normal.front()[0] + motion.normal.front()[1], .5, 1e-9);
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
        if (motion.time[i] < 2) {
            EXPECT_NEAR(motion.state[i][state_u], .2 - .15 / 2.99865194 * motion.time[i], 2e-4);
        }
        EXPECT_NEAR(motion.gap[i], 0, 1e-7);
    }
    // The resultant moves forward while it slides: mu L_nw before the centre (docs/physics.md section 3.3, with M_y =
    // M_uu = 0).
    const auto& n = motion.normal.front();
    EXPECT_NEAR(.0717 * (n[0] - n[1]) / (n[0] + n[1]), .3 * .0514, 1e-3);
}

TEST(RigidBody, TipsOntoItsNoseEdgeWhenTheJetsPushHardEnough) {
    Model model = evie(.5, 0);
    Jet down{"down", {.07, 0, 0}, {0, 0, 1}, 0, 10, 0};
    Jet aft{"aft", {-.07, 0, 0}, {0, 0, -1}, 0, 10, 0};
    model.jets = {down, aft};
    const RigidBody body(model);
    BodyState y{};
    y[state_z] = body.height_for_gap(0, 0);
    // Nose-down moment F 0.07 each; flat while the resultant stays within 71.7 mm: N = 0.5, M = 0.14 F < 0.5 * 0.0717
    for (const double thrust : {.2, .3}) {
        const ContactState state = body.settle(y, std::vector<double>{thrust, thrust}, ContactState::flat);
        EXPECT_EQ(state, .14 * thrust < .5 * .0717 ? ContactState::flat : ContactState::nose_edge) << thrust;
    }
    BodyOptions options;
    options.duration = .5;
    const auto command = [](double t, const BodyState&) {
        return t < .25 ? std::vector<double>{.3, .3} : std::vector<double>{.1, .1};
    };
    const BodyTrajectory motion = simulate_body(body, y, command, options);
    bool nose = false;
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
        nose = nose || motion.contact[i] == ContactState::nose_edge;
        EXPECT_GE(std::min(body.edge_gaps(motion.state[i])[0], body.edge_gaps(motion.state[i])[1]), -1e-7);
        EXPECT_GE(motion.normal[i][0], -1e-6);
        EXPECT_GE(motion.normal[i][1], -1e-6);
    }
    EXPECT_TRUE(nose);
    EXPECT_LT(motion.state[4][state_theta], 0);  // nose down
}

TEST(RigidBody, LandsOnTheGroundWithMomentumGoingIntoTheImpulseOnly) {
    const RigidBody body(evie(.5, 0));
    BodyState y{};
    y[state_u] = .1;
    y[state_w] = .03;
    y[state_z] = body.height_for_gap(0, 0);
    const BodyState after = body.impact(y, ContactState::flat);
    EXPECT_NEAR(after[state_w], 0, 1e-12);
    EXPECT_NEAR(after[state_u], .1, 1e-12);
    EXPECT_NEAR(after[state_q], 0, 1e-12);
    // On one edge the base turns down and the energy falls.
    y[state_theta] = .05;
    const BodyState tail = body.impact(y, ContactState::tail_edge);
    EXPECT_LT(tail[state_q], 0);
    EXPECT_NEAR(body.edge_speeds(tail)[1], 0, 1e-12);
    EXPECT_LT(body.kinetic_energy(tail), body.kinetic_energy(y));
}

TEST(RigidBody, FallsTiltedAndComesToRestFlat) {
    Model model = evie(.5, .2);
    model.drag_heave.quadratic = 30;
    model.drag_pitch.quadratic = .05;
    const RigidBody body(model);
    BodyState y{};
    y[state_theta] = .1;
    y[state_z] = body.height_for_gap(.03, .1);
    BodyOptions options;
    options.duration = 20;
    const BodyTrajectory motion = simulate_body(body, y, nullptr, options);
    EXPECT_EQ(motion.contact.back(), ContactState::flat);
    EXPECT_NEAR(motion.gap.back(), 0, 1e-6);
    EXPECT_NEAR(motion.state.back()[state_theta], 0, 1e-6);
    EXPECT_GE(motion.events.size(), 2U);
}

TEST(RigidBody, JetsFollowTheirCommandWithTheirLag) {
    Model model = evie();
    model.jets = {Jet{"push", {0, 0, 0}, {1, 0, 0}, 0, 1, .5}};
    const RigidBody body(model);
    BodyState y{};
    y[state_z] = -10;
    BodyOptions options;
    options.duration = 2;
    const BodyTrajectory motion = simulate_body(
        body, y, [](double t, const BodyState&) { return std::vector<double>{t > 0 ? .3 : 0.0}; }, options);
    // S_x u' = F, F = 0.3 (1 - exp(-t/0.5))
    EXPECT_NEAR(motion.state.back()[state_u], .3 / 2.99865194 * (2 - .5 * (1 - std::exp(-4))), 1e-6);
}

// A row stands for what acts from then on: whoever takes the rows for a log holds each thrust up to the next one.
TEST(RigidBody, ARowAtASampleOfTheControllerHasItsNewThrust) {
    Model model = evie();
    model.jets = {Jet{"push", {0, 0, 0}, {1, 0, 0}, 0, 1, 0}};
    const RigidBody body(model);
    BodyState y{};
    y[state_z] = -10;
    BodyOptions options;
    options.duration = 2;
    options.output_step = options.command_step = .1;
    const auto command = [](double t) { return .5 + .4 * std::sin(3 * t); };
    const BodyTrajectory motion = simulate_body(
        body, y, [&](double t, const BodyState&) { return std::vector<double>{command(t)}; }, options);
    ASSERT_EQ(motion.time.size(), 21U);
    double speed = 0;  // S_x u' = F
    for (std::size_t k = 0; k + 1 < motion.time.size(); ++k) {
        EXPECT_NEAR(motion.thrust[k][0], command(motion.time[k]), 1e-9) << k;
        EXPECT_NEAR(motion.state[k][state_u], speed, 1e-6) << k;
        speed += .1 * motion.thrust[k][0] / 2.99865194;
    }
}

TEST(RigidBody, LinearisesToTheSurfaceModel) {
    const RigidBody body(evie());
    BodyState y{};
    y[state_u] = .35;
    y[state_z] = -10;
    const LinearSystem s = linearise_body(body, y, {});
    EXPECT_NEAR(s.a(state_v, state_r), -2.99865194 * .35 / 3.535082, 1e-6);
    EXPECT_NEAR(s.a(state_r, state_v), -0.53643006 * .35 / 0.0074603703, 1e-4);
    EXPECT_NEAR(s.a(state_q, state_w), 0.65790996 * .35 / (0.00685484 + 0.0005086667),
                1e-4);  // Munk in pitch destabilises
    const std::vector<Mode> found =
        modes(s, {"surge", "sway", "heave", "pitch", "yaw", "pitch", "heading", "x", "y", "depth"});
    double fastest = 0;
    for (const Mode& mode : found) {
        if (mode.name.find("sway") != std::string::npos) {
            fastest = std::max(fastest, mode.value.real());
        }
    }
    EXPECT_NEAR(fastest, 2.733428287, 1e-5);
}

TEST(RigidBody, RefusesWhatCannotBe) {
    Model model = evie();
    model.vehicle.yaw_inertia = std::nan("");
    EXPECT_THROW(RigidBody{model}, core::InputError);
    EXPECT_THROW(
        read_model_text("[vehicle]\nmass = 2.2\nroll_inertia = 0.001\npitch_inertia = 0.001\nyaw_inertia = 0.1\n", "m",
                        "."),
        core::InputError);
    const RigidBody body(evie());
    BodyState y{};
    y[state_z] = 0;
    EXPECT_THROW(simulate_body(body, y, nullptr, {}), core::InputError);
}

}  // namespace

}  // namespace underbody::dynamics
