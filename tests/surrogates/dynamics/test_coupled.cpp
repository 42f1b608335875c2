// Heave alone, heave and pitch, and the whole body agree where they describe the same motion; effects, inputs,
// coupling.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/simulate/dormand_prince.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

/// A lift table over the gap on a body with everything that the coupled motions need, level and symmetric: its motion
/// from a level start stays in heave.
Model level_model(const std::string& more = "") {
    Model model = read_model_text(
        "[vehicle]\nmass = 2.2\nadded_mass_surge = 0.8\nadded_mass_sway = 1.3\nadded_mass_heave = 1.754\nnet_weight = "
        "0.01\n"
        "roll_inertia = 0.00485\npitch_inertia = 0.00685\nyaw_inertia = 0.00708\nbase_depth = 0.03\nbase_half_length = "
        "0.0717\n"
        "buoyancy_height = 0.01\n[drag.heave]\nlinear = 0.2\nquadratic = 12\n[drag.pitch]\nlinear = 0.01\n" +
            more,
        "level.toml", ".");
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    model.forces.push_back({"lift_force",
                            "ref-a.csv",
                            "ref-a.csv",
                            tables::ForceTable::fit(test::ref_a_table(), "lift_force", options),
                            {Channel::gap},
                            {},
                            1.0});
    return model;
}

std::vector<Model> with_each_effect() {
    std::vector<Model> all{level_model()};
    const std::pair<const char*, std::vector<ParameterValue>> uses[] = {
        {"constant_force", {{"force", .004}}},
        {"coulomb_friction", {{"force", .003}}},
        {"linear_damping", {{"coefficient", .3}}},
        {"quadratic_damping", {{"coefficient", 9}}},
        {"squeeze_film_damping", {{"coefficient", 2e-6}}},
        {"added_mass", {{"mass", .5}}},
        {"gap_dependent_added_mass", {{"mass", 2}, {"length", .03}}},
        {"tether_stiffness", {{"stiffness", .2}}},
        {"ambient_heave_current", {{"velocity", .004}}},
        {"periodic_disturbance", {{"amplitude", .004}, {"frequency", .4}}},
        {"surface_roughness", {{"near", .3}}},
        {"history_force", {{"area", .05}}},
    };
    for (const auto& [name, values] : uses) {
        std::vector<ParameterValue> known;
        for (const ParameterValue& value : values) {
            for (const EffectParameter& parameter : effect(name).info().parameters) {
                if (parameter.name == value.name) {
                    known.push_back(value);
                }
            }
        }
        EXPECT_EQ(known.size(), values.size()) << name;
        all.push_back(level_model().with_effect(make_use(name, known)));
    }
    return all;
}

TEST(Coupled, EveryEffectOfHeaveActsAlikeInHeaveAndPitchAndInTheWholeBody) {
    TrajectoryOptions heave_options;
    heave_options.duration = 12;
    heave_options.output_step = 1;
    BodyOptions body_options;
    body_options.duration = 12;
    body_options.output_step = 1;
    for (const Model& model : with_each_effect()) {
        const std::string name = model.effects.empty() ? "none" : model.effects[0].name;
        const Trajectory heave = simulate(model, .11, .01, {}, heave_options);
        const PitchTrajectory both = simulate(HeavePitch(model), {.11, .01, 0, 0}, heave_options);
        const RigidBody body(model);
        BodyState start{};
        start[state_w] = -.01;
        start[state_z] = body.height_for_gap(.11, 0);
        const BodyTrajectory whole = simulate_body(body, start, nullptr, body_options);
        ASSERT_EQ(heave.time.size(), both.time.size()) << name;
        ASSERT_EQ(heave.time.size(), whole.time.size()) << name;
        for (std::size_t i = 0; i < heave.time.size(); ++i) {
            EXPECT_NEAR(both.state[i][0], heave.gap[i], 1e-6) << name;
            EXPECT_NEAR(both.state[i][1], heave.heave_velocity[i], 1e-6) << name;
            EXPECT_NEAR(both.state[i][2], 0, 1e-12) << name;
            EXPECT_NEAR(whole.gap[i], heave.gap[i], 1e-6) << name;
        }
    }
}

TEST(Coupled, RecordedInputsMoveAllThreeMotionsAlike) {
    const Model model = level_model().with_effect(make_use("actuator_lag", {{"time_constant", .3}}));
    InputSignals inputs;
    for (int i = 0; i <= 100; ++i) {
        inputs.time.push_back(.1 * i);
    }
    inputs.signals.push_back({Channel::input_force, {}});
    for (const double t : inputs.time) {
        inputs.signals[0].values.push_back(.01 * std::sin(t));
    }
    TrajectoryOptions options;
    options.duration = 10;
    options.output_step = 1;
    const Trajectory heave = simulate(model, .2, 0, inputs, options);
    const PitchTrajectory both =
        simulate(HeavePitch(model, {}, {Channel::input_force}), {.2, 0, 0, 0}, options, core::Progress::none(), inputs);
    const RigidBody body(model, {}, {Channel::input_force});
    BodyState start{};
    start[state_z] = body.height_for_gap(.2, 0);
    BodyOptions body_options;
    body_options.output_step = 1;
    const BodyTrajectory whole = simulate_body(body, start, nullptr, body_options, core::Progress::none(), inputs);
    EXPECT_GT(std::abs(heave.gap.back() - .2), 1e-3);
    for (std::size_t i = 0; i < heave.time.size(); ++i) {
        EXPECT_NEAR(both.state[i][0], heave.gap[i], 1e-6);
        EXPECT_NEAR(whole.gap[i], heave.gap[i], 1e-6);
    }
}

/// Passive lift over gap that grows as speed squared, and a jet's that grows as voltage squared.
Model two_effects(Coupling::Kind law) {
    Model model = level_model();
    model.coupling = {law, .4};
    model.forces[0].scales = {{Channel::speed, .5, 2, 0}};
    model.forces.push_back(model.forces[0]);
    model.forces[1].scales = {{Channel::jet_voltage, 10, 2, 0}};
    model.forces[1].factor = 3;
    return model;
}

TEST(Coupled, PassiveAndJetLiftAddOrShelterAsTheModelSays) {
    Conditions held;
    held[Channel::speed] = .3;
    held[Channel::jet_voltage] = 8;
    const double h = .08, lone = level_model().forces[0].table.value(&h);
    for (const Coupling::Kind law : {Coupling::Kind::sum, Coupling::Kind::sheltered}) {
        const Model model = two_effects(law);
        const double left = law == Coupling::Kind::sum ? 1 : 1 / (1 + .75 * .75);
        const double expected = lone * .36 + 3 * lone * .64 * left;
        Conditions at = held;
        at[Channel::gap] = h;
        EXPECT_NEAR(static_value(model, "lift_force", at), expected, 1e-12);
        EXPECT_NEAR(HeavePlant(model, held).lift(h), expected, 1e-9);
        double lift = 0, moment = 0;
        HeavePitch(model, held).table_loads({h, 0, 0, 0}, {}, lift, moment);
        EXPECT_NEAR(lift, expected, 1e-12);
        BodyState y{};
        const RigidBody body(model, held);
        y[state_u] = .3;
        y[state_z] = body.height_for_gap(h, 0);
        EXPECT_NEAR(body.table_loads(y).lift, expected, 1e-12);
        // The same when speed and voltage come as records.
        InputSignals inputs;
        inputs.time = {0, 1, 2};
        inputs.signals = {{Channel::speed, {.3, .3, .3}}, {Channel::jet_voltage, {8, 8, 8}}};
        const HeavePlant varying = plant_for(model, inputs);
        const HeaveRun run(varying, inputs);
        EXPECT_NEAR(varying.lift(h, run.moment(1)), expected, 1e-9);
    }
}

TEST(Coupled, EnergyStaysWithAddedMassOverTheGap) {
    // Lift and weight away: only kinetic energy, which the growing mass hands between heave, pitch and surge.
    Model model = level_model();
    model.forces.clear();
    model.vehicle.net_weight = 0;
    model.vehicle.buoyancy_height = 0;
    model.drag_heave = model.drag_pitch = DragLaw{};
    model.vehicle.centre_of_gravity = Vector3{.03, .003, 0};
    model.vehicle.centre_of_buoyancy = Vector3{.03, .003, 0};
    model = model.with_effect(make_use("gap_dependent_added_mass", {{"mass", 3}, {"length", .05}}));
    const HeavePitch both(model);
    TrajectoryOptions options;
    options.duration = 2;
    options.output_step = .1;
    options.tolerance = 1e-12;
    const PitchState start{.15, -.03, .1, .2};
    const PitchTrajectory motion = simulate(both, start, options);
    for (const PitchState& y : motion.state) {
        EXPECT_NEAR(both.kinetic_energy(y) / both.kinetic_energy(start), 1, 1e-9);
    }
    EXPECT_GT(std::abs(motion.state.back()[3] - .2), 1e-4);
    const RigidBody body(model);
    BodyState y{};
    y[state_u] = .2;
    y[state_w] = .05;
    y[state_q] = .1;
    y[state_r] = .2;
    y[state_theta] = .1;
    y[state_z] = body.height_for_gap(.2, .1);
    BodyOptions body_options;
    body_options.duration = 2;
    body_options.tolerance = 1e-12;
    for (const BodyState& state : simulate_body(body, y, nullptr, body_options).state) {
        EXPECT_NEAR(body.kinetic_energy(state) / body.kinetic_energy(y), 1, 1e-9);
    }
}

TEST(Coupled, ProductsOfInertiaKeepEnergyAndInVacuumTheMomentum) {
    Model model = read_model_text(
        "[vehicle]\nmass = 2.2\nroll_inertia = 0.005\npitch_inertia = 0.007\nyaw_inertia = 0.0075\ninertia_product_xy "
        "= 0.0008\n"
        "inertia_product_xz = -0.0011\ninertia_product_yz = 0.0006\nbase_depth = 0.05\nbase_half_length = "
        "0.07\nnet_weight = 0\n",
        "tensor.toml", ".");
    BodyState y{};
    y[state_u] = .2;
    y[state_v] = .1;
    y[state_w] = -.05;
    y[state_q] = .4;
    y[state_r] = .5;
    y[state_theta] = .2;
    y[state_z] = -10;
    BodyOptions options;
    options.duration = 10;
    options.tolerance = 1e-13;
    const RigidBody vacuum(model);
    const Vector3 before = RigidBody::world_velocity(y);
    const BodyTrajectory motion = simulate_body(vacuum, y, nullptr, options);
    for (const BodyState& state : motion.state) {
        if (std::abs(state[state_theta]) > 1.3) {
            break;  // roll held at zero has no meaning standing on the nose
        }
        EXPECT_NEAR(vacuum.kinetic_energy(state) / vacuum.kinetic_energy(y), 1, 1e-10);
        const Vector3 now = RigidBody::world_velocity(state);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(now[k], before[k], 1e-10);
        }
    }
    model.vehicle.added_mass_surge = .8;
    model.vehicle.added_mass_sway = 1.3;
    model.vehicle.added_mass_heave = 1.5;
    const RigidBody wet(model);
    y[state_q] = .1;
    y[state_r] = .15;
    for (const BodyState& state : simulate_body(wet, y, nullptr, options).state) {
        if (std::abs(state[state_theta]) > 1.3) {
            break;
        }
        EXPECT_NEAR(wet.kinetic_energy(state) / wet.kinetic_energy(y), 1, 1e-10);
    }
}

TEST(Coupled, TheCentresOfMassAndBuoyancySetTheTrim) {
    // Buoyancy 3 mm behind and 10 mm above: at rest where F_b (x cos - z sin) balances, tan(theta) = -3/10 nose down.
    Model model = level_model();
    model.forces.clear();
    model.vehicle.net_weight = 0;
    model.vehicle.buoyancy_height = 0;
    model.vehicle.centre_of_gravity = Vector3{.003, 0, .01};
    double force = 1, moment = 1;
    const HeavePitch plant(model);
    plant.statics(.1, std::atan2(-3, 10), force, moment);
    EXPECT_NEAR(force, 0, 1e-12);
    EXPECT_NEAR(moment, 0, 1e-12);
    const auto text = [](const std::string& more) {
        return "[vehicle]\nmass = 2.2\nlength = 0.2\nwidth = 0.15\n" + more;
    };
    EXPECT_THROW(read_model_text(text("buoyancy_height = 0.01\ncentre_of_gravity = [0, 0, 0.01]\n"), "m", "."),
                 core::InputError);
    EXPECT_THROW(read_model_text(text("centre_of_gravity = [20, 0, 0]\n"), "m", "."), core::InputError);
}

TEST(Coupled, LqrHoldsHeaveAndPitchWhereTheOpenLoopRunsAway) {
    const Model model = level_model();
    // 160 mm is the unstable zero of the table (weight moves it a little): open loop it leaves, closed it stays.
    HeavePitch plant(model);
    TrajectoryOptions options;
    options.duration = 60;
    options.output_step = 1;
    const PitchState start{.165, 0, .03, 0};
    EXPECT_GT(std::abs(simulate(plant, start, options).state.back()[0] - .16), .05);
    plant.close_loop(pitch_lqr(plant, .16, 0, {}));
    const PitchTrajectory held = simulate(plant, start, options);
    // The regulator does not cancel the force at its reference: it stays where they balance.
    EXPECT_NEAR(held.state.back()[0], .16, .005);
    EXPECT_NEAR(held.state.back()[1], 0, 1e-6);
    EXPECT_NEAR(held.state.back()[2], 0, 1e-6);
    for (const std::complex<double>& pole : closed_poles(HeavePitch(model), pitch_lqr(HeavePitch(model), .16, 0, {}))) {
        EXPECT_LT(pole.real(), 0);
    }
}

TEST(Coupled, ImpactsKeepMomentumAboutTheContactAndNeverAddEnergy) {
    core::Random random(8);
    for (int trial = 0; trial < 200; ++trial) {
        Model model = level_model();
        model.contact.restitution = trial % 4 == 0 ? 1 : random.uniform(0, 1);
        model.vehicle.centre_of_gravity = Vector3{random.uniform(-.02, .02), 0, 0};
        model.vehicle.buoyancy_height = 0;
        const HeavePitch plant(model);
        PitchState y{.05, random.uniform(-.1, .02), random.uniform(-.1, .1), random.uniform(-.5, .5)};
        const ContactState edge = y[2] > 0 ? ContactState::tail_edge : ContactState::nose_edge;
        const std::size_t which = y[2] > 0 ? 1 : 0;
        const double before = plant.edge_speeds(y)[which];
        if (before >= 0) {
            continue;
        }
        const PitchState after = plant.impact(y, edge);
        EXPECT_NEAR(plant.edge_speeds(after)[which], -model.contact.restitution * before, 1e-12);
        EXPECT_LE(plant.kinetic_energy(after), plant.kinetic_energy(y) * (1 + 1e-12));
        if (model.contact.restitution == 1) {
            EXPECT_NEAR(plant.kinetic_energy(after) / plant.kinetic_energy(y), 1, 1e-12);
        }
        // The impulse passes through the edge: it turns nothing about it.
        const double arm = (-model.vehicle.centre_of_gravity->at(0) + (which == 0 ? .0717 : -.0717)) * std::cos(y[2]) +
                           .03 * std::sin(y[2]);
        EXPECT_NEAR(plant.inertia() * (after[3] - y[3]),
                    arm * plant.mass() * (plant.centre_velocity(after) - plant.centre_velocity(y)), 1e-12);
    }
}

TEST(Integrators, TheExplicitPairHasOrderFiveAndItsInterpolantFour) {
    const auto rate = [](double, const double* y, double* d) {
        d[0] = y[1];
        d[1] = -y[0];
    };
    std::vector<double> ends, middles;
    for (const double step : {.4, .2, .1}) {
        DormandPrince<2, decltype(rate)> ode(rate, 0, {1, 0}, {1e3, 1e3}, step);
        ASSERT_TRUE(ode.step(10));
        ASSERT_NEAR(ode.t(), step, 1e-15);
        ends.push_back(std::abs(ode.y()[1] + std::sin(step)));
        middles.push_back(std::abs(ode.between(.5, 0) - std::cos(step / 2)) + 1e-18);
    }
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        EXPECT_GT(std::log2(ends[i] / ends[i + 1]), 5.7);  // one step: one order more
        EXPECT_GT(std::log2(middles[i] / middles[i + 1]), 3.7);
    }
}

TEST(Integrators, TheErrorOfCvodeFollowsItsTolerance) {
    const Model model = test::spring_model(20, 4, .3, 0);
    std::vector<double> errors;
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
        TrajectoryOptions options;
        options.duration = 10;
        options.output_step = 10;
        options.tolerance = tolerance;
        const Trajectory motion = simulate(model, .15, 0, {}, options);
        const double a = .3 / 8, w = std::sqrt(5 - a * a), t = 10;
        errors.push_back(
            std::abs(motion.gap.back() - .1 - .05 * std::exp(-a * t) * (std::cos(w * t) + a / w * std::sin(w * t))));
    }
    for (std::size_t i = 0; i + 1 < errors.size(); ++i) {
        EXPECT_LT(errors[i + 1], .1 * errors[i] + 1e-12);
    }
    EXPECT_LT(errors.back(), 1e-8);
}

TEST(Coupled, StaticEffectsAreNamedWhenAMotionLeavesThemOut) {
    const Model model = level_model().with_effect(make_use("gap_offset", {{"offset", 1e-4}}));
    TrajectoryOptions options;
    options.duration = .1;
    const Trajectory motion = simulate(model, .1, 0, {}, options);
    bool named = false;
    for (const core::Problem& remark : motion.remarks) {
        named = named || remark.message.find("gap_offset") != std::string::npos;
    }
    EXPECT_TRUE(named);
}

TEST(Coupled, HeaveVelocityIsHowFastTheGapGrowsInEveryMotion) {
    Model model = level_model();
    model.vehicle.centre_of_gravity = Vector3{.01, 0, 0};
    model.vehicle.buoyancy_height = 0;
    const HeavePitch plant(model);
    TrajectoryOptions options;
    options.duration = 2;
    options.output_step = .001;
    const PitchTrajectory motion = simulate(plant, {.11, .01, .05, .3}, options);
    double worst = 0;
    for (std::size_t i = 1; i + 1 < motion.time.size(); ++i) {
        const double slope =
            (motion.state[i + 1][0] - motion.state[i - 1][0]) / (motion.time[i + 1] - motion.time[i - 1]);
        worst = std::max(worst, std::abs(slope - motion.state[i][1]));
    }
    EXPECT_LT(worst, 1e-5);  // the difference over 2 ms itself
    EXPECT_GT(std::abs(plant.centre_velocity({.11, .01, .05, .3}) - .01),
              1e-3);  // that of the centre of mass is another
    const RigidBody body(model);
    BodyState start{};
    start[state_u] = .2;
    start[state_q] = .3;
    start[state_theta] = .05;
    start[state_w] = body.down_velocity_for(.01, start);
    start[state_z] = body.height_for_gap(.11, .05);
    EXPECT_NEAR(body.rise_of_base(start), .01, 1e-15);
    BodyState rate{}, later = start;
    body.rate(start, {}, ContactState::free, rate);
    for (std::size_t i = 0; i < later.size(); ++i) {
        later[i] += 1e-6 * rate[i];
    }
    EXPECT_NEAR((body.gap_at_base_centre(later) - .11) / 1e-6, .01, 1e-6);
}

TEST(Coupled, ImpactsSlideWithFrictionOrStickAndNeverAddEnergy) {
    core::Random random(9);
    int slid = 0, stuck = 0;
    for (int trial = 0; trial < 300; ++trial) {
        Model model = level_model();
        model.vehicle.added_mass_surge = .8;
        model.vehicle.added_mass_sway = 1.3;
        model.contact.friction = random.uniform(.05, 2);
        model.contact.slip_speed = 1e-7;
        const RigidBody body(model);
        BodyState y{};
        y[state_u] = random.uniform(-.4, .4);
        y[state_v] = random.uniform(-.2, .2);
        y[state_theta] = random.uniform(-.1, .1);
        y[state_q] = random.uniform(-.3, .3);
        y[state_r] = random.uniform(-.3, .3);
        y[state_w] = body.down_velocity_for(-random.uniform(.01, .1), y);
        y[state_z] = body.height_for_gap(.0717 * std::abs(std::sin(y[state_theta])), y[state_theta]);
        const std::size_t edge = y[state_theta] > 0 ? 1 : 0;
        if (body.edge_speeds(y)[edge] >= 0) {
            continue;
        }
        const ContactState touching = edge == 0 ? ContactState::nose_edge : ContactState::tail_edge;
        const BodyState after = body.impact(y, touching);
        EXPECT_NEAR(body.edge_speeds(after)[edge], 0, 1e-9);
        EXPECT_LE(body.kinetic_energy(after), body.kinetic_energy(y) * (1 + 1e-9));
        const std::array<double, 2> was = body.slip(y, edge), is = body.slip(after, edge);
        const double before = std::hypot(was[0], was[1]);
        // The push of the ground alone may turn a slow slip round; friction never does.
        Model smooth = model;
        smooth.contact.friction = 0;
        const std::array<double, 2> pushed = body.slip(RigidBody(smooth).impact(y, touching), edge);
        if (was[0] * pushed[0] + was[1] * pushed[1] < 0) {
            continue;
        }
        EXPECT_GE(was[0] * is[0] + was[1] * is[1], -1e-9 * before * before);
        (was[0] * is[0] + was[1] * is[1] > 1e-6 * before * before ? slid : stuck) += 1;
    }
    EXPECT_GT(slid, 20);
    EXPECT_GT(stuck, 5);
    // A flat drop in a run: the speed falls by friction times what stops the fall.
    Model model = level_model();
    model.contact.friction = .4;
    model.contact.slip_speed = 1e-7;
    model.vehicle.base_depth = 1e-6;  // no lever: the drop stays flat
    const RigidBody body(model);
    BodyState y{};
    y[state_u] = .35;
    y[state_w] = .05;
    y[state_z] = body.height_for_gap(0, 0);
    const BodyState after = body.impact(y, ContactState::flat);
    double slope = 0;
    const double fall = body.vertical().inertia(0, slope) * .05,
                 mass = model.vehicle.mass + model.vehicle.added_mass_surge;
    EXPECT_NEAR(after[state_u], .35 - .4 * fall / mass, 1e-6);
}

TEST(Coupled, EveryModeOfTheWholeBodyHasAName) {
    const RigidBody body(level_model());
    BodyState trim{};
    trim[state_u] = .1;
    trim[state_z] = body.height_for_gap(.11, 0);
    const LinearSystem system = linearise_body(body, trim, {});
    const auto found =
        modes(system, {"surge", "sway", "heave", "pitch", "yaw", "pitch", "heading", "north", "east", "heave"});
    EXPECT_GE(found.size(), 6U);
    for (const Mode& mode : found) {
        EXPECT_FALSE(mode.name.empty()) << mode.value;
    }
    const Controllability none = controllability(system);  // a body without jets
    EXPECT_EQ(none.rank, 0);
    EXPECT_EQ(none.uncontrollable.size(), 10U);
}

}  // namespace

}  // namespace underbody::dynamics
