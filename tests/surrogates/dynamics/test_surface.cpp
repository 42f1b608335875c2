// Motion on the ground, jets that hold it, allocation within limits, and the model of EVIE that ships.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/hold_with_jets.h"
#include "surrogates/dynamics/simulate/surface_motion.h"
#include "tests/support/support.h"
#include "tests/surrogates/dynamics/closed_forms.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

Model sled(double friction, double net_weight = .5) {
    return read_model_text(
        "[vehicle]\nmass = 2.2\nadded_mass_surge = 0.79865194\nadded_mass_sway = 1.335082\nadded_mass_heave = "
        "1.4565619\n"
        "roll_inertia = 0.00485441\npitch_inertia = 0.00685484\nyaw_inertia = 0.00708337\nadded_inertia_roll = "
        "8.7418652e-06\n"
        "added_inertia_pitch = 0.0005086667\nadded_inertia_yaw = 0.00037700395\nbase_depth = 0.0514\nbase_half_length "
        "= 0.0717\n"
        "net_weight = " +
            test::number(net_weight) +
            "\n[drag.surge]\nquadratic = 2\n[contact]\nfriction = " + test::number(friction) + "\nslip_speed = 1e-5\n",
        "sled.toml", ".");
}

Model with_jets(Model model) {
    EvieJets layout;
    layout.alpha = .349;
    layout.gamma = .611;
    layout.turn_x = .08;
    layout.turn_y = .05;
    layout.turn_z = .03;
    layout.beta = pitch_free_elevation(.08, .03, .611);
    layout.pitch_x = .06;
    layout.pitch_upper = .05;
    layout.pitch_lower = .04;
    layout.bottom = .05;
    layout.maximum = .5;
    model.jets = evie_jets(layout);
    return model;
}

TEST(Surface, IsTheWholeBodyHeldFlatOnTheGround) {
    const Model model = sled(.3);
    const SurfaceMotion ground(model);
    const RigidBody body(model);
    BodyOptions options;
    options.duration = 2;
    options.output_step = .2;
    const SurfaceTrajectory a = simulate_surface(ground, {.3, .03, .2, 0, 0, 0}, nullptr, options);
    BodyState start{};
    start[state_u] = .3;
    start[state_v] = .03;
    start[state_r] = .2;
    start[state_z] = body.height_for_gap(0, 0);
    const BodyTrajectory b = simulate_body(body, start, nullptr, options);
    ASSERT_EQ(a.time.size(), b.time.size());
    for (std::size_t i = 0; i < a.time.size(); ++i) {
        EXPECT_NEAR(a.state[i][0], b.state[i][state_u], 1e-2);
        EXPECT_NEAR(a.contact[i].normal, b.normal[i][0] + b.normal[i][1], 1e-6);
    }
    // Friction at two edges resists turning, at their resultant alone it does not: without friction both are the same.
    const Model smooth = sled(0);
    const SurfaceTrajectory c = simulate_surface(SurfaceMotion(smooth), {.3, .03, .2, 0, 0, 0}, nullptr, options);
    const BodyTrajectory d = simulate_body(RigidBody(smooth), start, nullptr, options);
    for (std::size_t i = 0; i < c.time.size(); ++i) {
        EXPECT_NEAR(c.state[i][1], d.state[i][state_v], 1e-6);
        EXPECT_NEAR(c.state[i][3], d.state[i][state_psi], 1e-6);
    }
}

TEST(Surface, LinearisesToTheMatricesOfTheDesignNotes) {
    const SurfaceMotion motion(sled(.2));
    const LinearSystem numeric = motion.linearised({.35, 0, 0, 0, 0, 0}, {}, false);
    const LinearSystem closed = test::surface_system(surface_coefficients(sled(.2)), .35, .2 * .5);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            // The resultant lies mu L before the centre: friction then turns the body a little, which 3.5 leaves out.
            const double tolerance = i == 2 || (i == 1 && j == 2) ? .6 : 1e-4;
            EXPECT_NEAR(numeric.a(i, j), closed.a(i, j), tolerance) << i << j;
        }
        for (std::size_t j = 0; j < 3; ++j) {
            EXPECT_NEAR(numeric.b(i, j), closed.b(i, j), 1e-6);
        }
    }
    Model thin = sled(.2);
    thin.vehicle.base_depth = 0;
    thin.vehicle.drag_height = 0;
    const LinearSystem flat = SurfaceMotion(thin).linearised({.35, 0, 0, 0, 0, 0}, {}, false);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            EXPECT_NEAR(flat.a(i, j), closed.a(i, j), 2e-4) << i << j;
        }
    }
}

TEST(Surface, StopsByFrictionTipsAndLiftsOff) {
    const Model model = with_jets(sled(.3));
    const SurfaceMotion motion(model);
    BodyOptions options;
    options.duration = 30;
    options.output_step = .1;
    options.stop_at_equilibrium = true;
    options.settle_speed = 1e-4;
    EXPECT_EQ(simulate_surface(motion, {.2, 0, 0, 0, 0, 0}, nullptr, options).end, "equilibrium");
    // J7 and J8 push up with 2 F cos(20 deg): more than the net weight lifts off, one alone tips.
    const auto lift = [](double t, const BodyState&) {
        return std::vector<double>{0, 0, 0, 0, 0, 0, .1 * t, .1 * t, 0};
    };
    const SurfaceTrajectory off = simulate_surface(motion, {0, 0, 0, 0, 0, 0}, lift, options);
    EXPECT_EQ(off.end, "lift_off");
    EXPECT_NEAR(off.time.back(), .5 / (2 * std::cos(.349) * .1), 2e-3);
    const auto nose_up = [](double t, const BodyState&) { return std::vector<double>{0, 0, 0, 0, 0, 0, 0, .1 * t, 0}; };
    EXPECT_EQ(simulate_surface(motion, {0, 0, 0, 0, 0, 0}, nose_up, options).end, "tips on the tail edge");
}

TEST(Surface, HeadingFeedbackHoldsExactlyWithinItsBoundsOnTheNonlinearModel) {
    // Nearly without friction the bound is K2 > S_r Om^2 (oracle 0.0557 N m/rad at 0.35 m/s).
    Model model = with_jets(sled(0));
    model.drag_surge.quadratic = 0;
    const SurfaceMotion motion(model);
    const HeadingBounds bounds = heading_bounds(surface_coefficients(model), .35, 0);
    EXPECT_NEAR(bounds.least_k2_without_friction, .0557, 1e-4);
    BodyOptions options;
    options.duration = 12;
    options.output_step = .1;
    options.command_step = .01;
    for (const double part : {.7, 1.5}) {
        VehicleHold hold;
        hold.heading = 0;
        hold.heading_gain = part * bounds.least_k2_without_friction;
        hold.yaw_rate_gain = .02;
        const SurfaceTrajectory run =
            simulate_surface(motion, {.35, 0, 0, .02, 0, 0}, JetHold(model, hold).command(), options);
        double largest = 0;
        for (const SurfaceState& y : run.state) {
            largest = std::max(largest, std::abs(y[3]));
        }
        EXPECT_EQ(largest > .2, part < 1) << part;
    }
}

TEST(Surface, ATurnIsHeldByTheJetsWithinTheirLimits) {
    Model model = with_jets(sled(.1));
    for (Jet& jet : model.jets) {
        jet.lag = .05;
    }
    const SurfaceMotion motion(model);
    VehicleHold hold;
    hold.heading = .4;
    hold.speed = .3;
    hold.heading_gain = .3;
    hold.yaw_rate_gain = .15;
    BodyOptions options;
    options.duration = 30;
    options.output_step = .5;
    options.command_step = .02;
    const SurfaceTrajectory run =
        simulate_surface(motion, {.3, 0, 0, 0, 0, 0}, JetHold(model, hold).command(), options);
    EXPECT_EQ(run.end, "time");
    EXPECT_NEAR(run.state.back()[3], .4, .03);
    EXPECT_NEAR(run.state.back()[0], .3, .05);
    for (const std::vector<double>& thrust : run.thrust) {
        for (std::size_t k = 0; k < thrust.size(); ++k) {
            EXPECT_GE(thrust[k], model.jets[k].minimum - 1e-9);
            EXPECT_LE(thrust[k], model.jets[k].maximum + 1e-9);
        }
    }
}

TEST(Allocation, NoOtherThrustsWithinTheLimitsComeNearer) {
    core::Random random(4);
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<Jet> jets;
        const std::size_t count = 1 + random.below(10);
        for (std::size_t i = 0; i < count; ++i) {
            Jet jet;
            double size = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                jet.position[k] = random.uniform(-.1, .1);
                jet.direction[k] = random.normal();
                size += jet.direction[k] * jet.direction[k];
            }
            for (double& part : jet.direction) {
                part /= std::sqrt(size);
            }
            jet.minimum = random.uniform() < .3 ? -.2 : 0.0;
            jet.maximum = random.uniform(.05, .4);
            jets.push_back(jet);
        }
        Wrench wanted;
        for (std::size_t k = 0; k < 3; ++k) {
            wanted.force[k] = random.uniform(-.5, .5);
            wanted.moment[k] = random.uniform(-.03, .03);
        }
        const Allocation best = allocate(jets, wanted);
        const auto misfit = [&](const std::vector<double>& thrust) {
            const Wrench w = jet_wrench(jets, thrust);
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                sum += std::pow(w.force[k] - wanted.force[k], 2) + 100 * std::pow(w.moment[k] - wanted.moment[k], 2);
            }
            return std::sqrt(sum);
        };
        EXPECT_NEAR(misfit(best.thrust), best.misfit, 1e-9);
        for (int other = 0; other < 300; ++other) {
            std::vector<double> thrust = best.thrust;
            for (std::size_t i = 0; i < count; ++i) {
                thrust[i] =
                    std::clamp(thrust[i] + random.normal() * (other % 2 ? .1 : 1e-3), jets[i].minimum, jets[i].maximum);
            }
            EXPECT_GE(misfit(thrust), best.misfit - 1e-7);
        }
    }
}

TEST(Allocation, FindsTheTurningJetsAmongOthers) {
    const Model model = with_jets(sled(0));
    const std::optional<EvieJets> layout = turning_layout(model.jets);
    ASSERT_TRUE(layout);
    EXPECT_NEAR(layout->gamma, .611, 1e-12);
    EXPECT_NEAR(layout->turn_y, .05, 1e-12);
}

TEST(Evie, TheShippedModelHasItsJetsAndRunsInEveryMotion) {
    const std::filesystem::path file = ::underbody::test::source_folder() / "cases/evie/model.toml";
    const Model model = read_model(file);
    ASSERT_EQ(model.jets.size(), 9U);
    EXPECT_EQ(model.jets[8].name, "Jj");
    // The turning jets push through the centre of gravity in side view.
    const std::vector<double> forward{1, 1, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_NEAR(jet_wrench(model.jets, forward).moment[1], 0, 1e-6);
    EXPECT_EQ(test::rank_of(model.jets, {0, 1, 2, 3, 4, 5}), 5);  // roll comes with side force only
    Conditions held;
    EXPECT_FALSE(heave_equilibria(HeavePlant(model, held)).empty());
    const HeavePitch both(model, held);
    EXPECT_FALSE(both.equilibria().empty());
    TrajectoryOptions options;
    options.duration = 2;
    options.output_step = .1;
    for (const double h : simulate(model, .02, 0, {}, options).gap) {
        EXPECT_TRUE(std::isfinite(h));
    }
    EXPECT_EQ(simulate(both, {.02, 0, .01, 0}, options).time.size(), 21U);
    const RigidBody body(model, held);
    BodyState start{};
    start[state_u] = .35;
    start[state_z] = body.height_for_gap(.02, 0);
    VehicleHold hold;
    hold.heading = .2;
    hold.speed = .35;
    BodyOptions run;
    run.duration = 2;
    run.command_step = .02;
    const BodyTrajectory whole = simulate_body(body, start, JetHold(model, hold, held).command(), run);
    EXPECT_GT(whole.state.back()[state_psi], .02);
    // On the ground the bottom jet's film, 12 V, changes the normal force as the coupling law says.
    Conditions jet;
    jet[Channel::jet_voltage] = 12;
    const double off = SurfaceMotion(model, held).contact({.35, 0, 0, 0, 0, 0}, std::vector<double>(9, 0.0)).normal;
    const double on = SurfaceMotion(model, jet).contact({.35, 0, 0, 0, 0, 0}, std::vector<double>(9, 0.0)).normal;
    const double end = 0;
    EXPECT_NEAR(off - on, model.forces[3].table.value(&end) / (1 + std::pow(.35 / 1.35, 2)), 1e-9);
}

}  // namespace

}  // namespace underbody::dynamics
