// The oracles of docs/physics.md section 9 (docs/physics-oracles.csv) on jets, rigid body, linear model, LQR, films,
// release, scaling.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/units.h"
#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/model/jets.h"
#include "surrogates/dynamics/model/matrix_algebra.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "surrogates/dynamics/theory/film.h"
#include "surrogates/dynamics/theory/release.h"
#include "surrogates/dynamics/theory/scaling.h"
#include "tests/surrogates/dynamics/closed_forms.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

constexpr double degree = 3.14159265358979323846 / 180;

EvieJets layout() {
    EvieJets jets;
    jets.alpha = 20 * degree;
    jets.beta = 20 * degree;
    jets.gamma = 35 * degree;
    jets.turn_x = .08;
    jets.turn_y = .05;
    jets.turn_z = .03;
    jets.pitch_x = .06;
    jets.pitch_upper = .05;
    jets.pitch_lower = .04;
    jets.bottom = .05;
    return jets;
}

/// EVIE in ideal fluid: m = 2.2 kg, semi-axes 101.6, 76, 72.5 mm, added mass by Lamb (O12, O13), uniform density.
SurfaceCoefficients evie() {
    SurfaceCoefficients c;
    c.mass_x = 2.2 + .79865194;
    c.mass_y = 2.2 + 1.335082;
    c.inertia_r = 2.2 / 5 * (.1016 * .1016 + .076 * .076) + .00037700395;
    c.munk = .79865194 - 1.335082;
    return c;
}

TEST(Oracles, JetsGiveForceAndMomentByTheirPlaces) {  // O01 O02 O03 O04 O05
    EvieJets l = layout();
    const std::vector<double> thrust{.1, .08, .02, .03, .01, .04, .015, .025, .036};
    const Wrench w = jet_wrench(evie_jets(l), thrust);
    const double force[] = {0.093227244, -0.0053898554, 0.052061559},
                 moment[] = {-0.00033270574, 0.00058918209, -0.00408032};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(w.force[i], force[i], 5e-10);
        EXPECT_NEAR(w.moment[i], moment[i], 1e-11);
    }
    l.beta = pitch_free_elevation(l.turn_x, l.turn_z, l.gamma);
    EXPECT_NEAR(l.beta / degree, 17.07601626, 1e-6);
    EXPECT_NEAR(jet_wrench(evie_jets(l), std::vector<double>{1, 1, 0, 0, 0, 0, 0, 0, 0}).moment[1], 0, 1e-12);
    l.beta = 20 * degree;
    const Wrench side = jet_wrench(evie_jets(l), std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 0});
    EXPECT_NEAR(side.force[0], 0, 1e-12);
    EXPECT_NEAR(side.force[1], 1.0779711, 1e-7);
    EXPECT_NEAR(side.moment[2], 0, 1e-12);
}

TEST(Oracles, TurningJetsSpanSurgeSwayAndYaw) {
    EvieJets l = layout();
    std::vector<Jet> all = evie_jets(l);
    const std::vector<Jet> turning{all[0], all[1], all[4], all[5]};
    EXPECT_EQ(test::rank_of(turning, {0, 1, 5}), 3);
    const Wrench null = jet_wrench(turning, std::vector<double>{1, 1, 1, 1});
    EXPECT_NEAR(null.force[0], 0, 1e-14);
    EXPECT_NEAR(null.force[1], 0, 1e-14);
    EXPECT_NEAR(null.moment[2], 0, 1e-14);
    l.gamma = 0;
    all = evie_jets(l);
    EXPECT_EQ(test::rank_of({all[0], all[1], all[4], all[5]}, {0, 1, 5}), 2);
    l = layout();
    // The inverse in closed form (docs/physics.md section 2.2), with the least of the null vector that pulls on no jet.
    const double cb = std::cos(l.beta), sg = std::sin(l.gamma), cg = std::cos(l.gamma);
    const double x = 0.05 / (cg * cb), y = -0.02 / (sg * cb), z = 0.003 / ((l.turn_y * cg + l.turn_x * sg) * cb);
    const std::array<double, 4> parts{(x + y - z) / 4, (x - y + z) / 4, (-x + y + z) / 4, (-x - y - z) / 4};
    const double least = std::min(0.0, *std::min_element(parts.begin(), parts.end()));
    Wrench asked;
    asked.force = {0.05, -0.02, 0};
    asked.moment = {0, 0, 0.003};
    const Allocation closed = allocate(turning, asked, {1, 1, 0, 0, 0, 10});
    for (std::size_t i = 0; i < parts.size(); ++i) {
        EXPECT_NEAR(closed.thrust[i], parts[i] - least, 1e-5) << i;
    }
    all = evie_jets(l);
    // With limits, by least squares over all nine jets.
    Wrench wanted;
    wanted.force = {0.04, 0.01, -0.02};
    wanted.moment = {0, 0.001, -0.002};
    const Allocation within = allocate(all, wanted, {1, 1, 1, 0, 10, 10});
    EXPECT_LT(within.misfit, 1e-6);
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_GE(within.thrust[i], all[i].minimum - 1e-12);
        EXPECT_LE(within.thrust[i], all[i].maximum + 1e-12);
    }
}

TEST(Oracles, MunkMomentAndSurfaceModel) {  // O14 O15 O16 O17 O18
    const SurfaceCoefficients c = evie();
    EXPECT_NEAR(c.munk, -0.53643005, 1e-7);
    EXPECT_NEAR(munk_yaw_moment(c.munk, .35, 6 * degree), -0.006831217331, 1e-9);
    EXPECT_NEAR(c.inertia_r, 0.0074603703, 1e-9);
    const auto pole = [&](double friction) { return yaw_transfer(c, .35, friction, layout()).poles; };
    EXPECT_NEAR(pole(0)[0].real(), 2.733428287, 1e-6);
    EXPECT_NEAR(pole(.1)[0].real(), 2.6933157, 1e-6);
    EXPECT_NEAR(pole(.1)[1].real(), -2.7741383, 1e-6);
    const HeadingBounds bounds = heading_bounds(c, .35, 0);
    EXPECT_NEAR(bounds.omega_squared, 7.4716, 1e-4);
    EXPECT_NEAR(bounds.least_k2_without_friction, 0.0557, 5e-5);
}

TEST(Oracles, InwardJetsGiveAMinimumPhaseZeroAndStraightOnesLoseAState) {
    const SurfaceCoefficients c = evie();
    EvieJets l = layout();
    EXPECT_LT(yaw_transfer(c, .35, 0, l).zero, 0);
    l.gamma = -0.1;  // outward, while the arm of the thrust still turns the same way
    EXPECT_GT(yaw_transfer(c, .35, 0, l).zero, 0);
    // rank [b Ab A^2 b] of (v, r, psi) with d = F1 - F2 as the only input: 2 for gamma = 0 in free stream, 3 with
    // friction
    for (const double friction : {0.0, 0.5}) {
        l.gamma = 0;
        const YawTransfer straight = yaw_transfer(c, .35, friction, l);
        const LinearSystem full = test::surface_system(c, .35, friction);
        LinearSystem system;
        system.a = Matrix(3, 3);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                system.a(i, j) = full.a(i + 1, j + 1);
            }
        }
        system.b = Matrix{{straight.side}, {straight.turn}, {0}};
        system.states = {"v", "r", "psi"};
        const Controllability found = controllability(system);
        EXPECT_EQ(found.rank, friction == 0 ? 2 : 3);
        EXPECT_NEAR(straight.zero, -friction / (.35 * c.mass_y), 1e-12);
        if (friction > 0) {
            EXPECT_LT(found.weakness, 5e-3);
        }
        // The zero out of the pencil is the formula's.
        l.gamma = 0.3;
        const YawTransfer inward = yaw_transfer(c, .35, friction, l);
        system.b = Matrix{{inward.side}, {inward.turn}, {0}};
        LinearSystem two = system;
        two.a = Matrix{{system.a(0, 0), system.a(0, 1)}, {system.a(1, 0), system.a(1, 1)}};
        two.b = Matrix{{inward.side}, {inward.turn}};
        const auto found_zeros = zeros(two, 0, 1);
        ASSERT_EQ(found_zeros.size(), 1U);
        EXPECT_NEAR(found_zeros[0].real(), inward.zero, 1e-9);
    }
}

TEST(Oracles, HeadingGainsAreStableExactlyWithinTheirBounds) {
    const SurfaceCoefficients c = evie();
    for (const double friction : {0.05, 0.4}) {
        const HeadingBounds bounds = heading_bounds(c, .35, friction);
        for (const double k1 : {0.0, 0.005, 0.03}) {
            for (const double k2 : {-0.01, 0.01, 0.05, 0.0556, 0.058, 0.2}) {
                LinearSystem s = test::surface_system(c, .35, friction);
                s.a(2, 2) -= k1 / c.inertia_r;
                s.a(2, 3) -= k2 / c.inertia_r;
                double worst = -1e300;
                for (const EigenPair& e :
                     eigen(Matrix{{s.a(1, 1), s.a(1, 2), 0}, {s.a(2, 1), s.a(2, 2), s.a(2, 3)}, {0, 1, 0}})) {
                    worst = std::max(worst, e.value.real());
                }
                EXPECT_EQ(bounds.stable(k1, k2, c.inertia_r), worst < 0) << friction << " " << k1 << " " << k2;
            }
        }
    }
}

TEST(Oracles, WorldVelocityKeepsItsSize) {  // O19
    BodyState y{};
    y[state_u] = .3;
    y[state_v] = .1;
    y[state_w] = -.05;
    y[state_theta] = .2;
    y[state_psi] = .7;
    const Vector3 v = RigidBody::world_velocity(y);
    EXPECT_NEAR(v[0], 0.15285958, 1e-8);
    EXPECT_NEAR(v[1], 0.25949777, 1e-8);
    EXPECT_NEAR(v[2], -0.10860413, 1e-8);
    EXPECT_NEAR(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], .3 * .3 + .1 * .1 + .05 * .05, 1e-15);
}

TEST(Oracles, RegulatorOfTheVerticalChannel) {  // O20
    LinearSystem s;
    s.a = Matrix{{0, 0}, {1, 0}};
    s.b = Matrix{{.2529}, {0}};
    const Regulator k = lqr(s, Matrix::diagonal({1, 100}), Matrix::diagonal({1}));
    EXPECT_NEAR(k.gain(0, 0), 8.9488905, 1e-7);
    EXPECT_NEAR(k.gain(0, 1), 10, 1e-9);
    for (const auto& pole : k.poles) {
        EXPECT_LT(pole.real(), 0);
    }
    s.b = Matrix{{0}, {0}};
    EXPECT_THROW(lqr(s, Matrix::diagonal({1, 100}), Matrix::diagonal({1})), core::Error);
}

TEST(Oracles, SliderFilms) {  // O21 ... O28
    EXPECT_NEAR(plane_slider_load(2e-3, 1e-3, .05, .5, 1e-3), 0.1986038542, 1e-9);
    EXPECT_NEAR(plane_slider_peak(2e-3, 1e-3, .05, .5, 1e-3), 6.25, 1e-12);
    EXPECT_EQ(plane_slider_peak(1e-3, 1e-3, .05, .5, 1e-3), 0);
    // The widest place of a film that widens is its end.
    EXPECT_NEAR(slider_film([](double x) { return 1e-3 + 1e-3 * x / .05; }, .05, {}, .5, 1e-3, 1000).reduced_reynolds,
                .5 * 2e-3 * 2e-3 * 1000 / (1e-3 * .05), 1e-9);
    EXPECT_NEAR(best_slider_ratio(), 2.1887048, 1e-7);
    EXPECT_NEAR(slider_load_coefficient(best_slider_ratio()), 0.16024314, 1e-8);
    const SliderFilm plane = slider_film([](double x) { return 2e-3 - 1e-3 * x / .05; }, .05, {}, .5, 1e-3, 1000);
    EXPECT_NEAR(plane.load_per_width, 0.1986038542, 1e-9);
    EXPECT_NEAR(plane.pressure.back(), 0, 1e-9);  // the thesis's 4.3 would leave 25 Pa there (O24)
    EXPECT_NEAR(plane.centre_of_pressure / .05, 0.5686879122, 1e-7);
    EXPECT_FALSE(plane.valid);
    const double tilt = std::tan(0.1 * degree);
    const auto wedge = [](double x) {
        return x < .05 ? 4e-3 - 2e-3 * x / .05 : x < .15 ? 2e-3 : 2e-3 + 2e-3 * (x - .15) / .05;
    };
    const SliderFilm level = slider_film(wedge, .2, {.05, .15}, .5, 1e-3, 1000);
    EXPECT_NEAR(level.load_per_width, 0, 1e-12);
    EXPECT_NEAR(level.highest, 3.5511, 1e-3);
    EXPECT_NEAR(level.lowest, -3.5511, 1e-3);
    const SliderFilm tilted =
        slider_film([&](double x) { return wedge(x) + (0.1 - x) * tilt; }, .2, {.05, .15}, .5, 1e-3, 1000);
    EXPECT_NEAR(tilted.load_per_width, 0.11039, 1e-3);
    const SliderFilm land = slider_film(wedge, .15, {.05}, .5, 1e-3, 1000);
    EXPECT_NEAR(land.load_per_width, 0.31281, 1e-4);
    EXPECT_NEAR(land.pressure[64], 3.9473684, 1e-6);
}

TEST(Oracles, CoefficientsSpringsAndScaling) {  // O29 ... O35
    EXPECT_NEAR(plan_area(.2032, .152), 0.024258122, 1e-8);
    EXPECT_NEAR(cross_section(.152, .145), 0.017310176, 1e-8);
    EXPECT_NEAR(printed_cross_section(.2032), 0.032429279, 1e-8);
    EXPECT_NEAR(lift_coefficient(.65, 1000, .5, plan_area(.2032, .152)), 0.2143611956, 1e-7);
    EXPECT_NEAR(spring_frequency(220, 2.2), 10, 1e-9);
    EXPECT_NEAR(220 / (8.8 * 8.8), 2.8409091, 1e-6);
    EXPECT_NEAR(survivable_kick(spring_frequency(220, 2.2), 2e-3), .02, 1e-12);
    EXPECT_NEAR(survivable_kick(8.8, 2e-3), .0176, 1e-12);
    const ScaleFactors twice = scaled(2);
    EXPECT_EQ(twice.force, 4);
    EXPECT_EQ(twice.mass, 8);
    EXPECT_EQ(twice.force_per_mass, .5);
    EXPECT_EQ(twice.stiffness, 2);
    EXPECT_EQ(twice.frequency, .5);
    EXPECT_EQ(twice.gap, 2);
    EXPECT_EQ(twice.kick, 1);
    const ScaleFactors faster = scaled(1, 2);
    EXPECT_EQ(faster.force, 4);
    EXPECT_EQ(faster.stiffness, 4);
    EXPECT_EQ(faster.frequency, 2);
    EXPECT_NEAR(reynolds_number(.5, .2032, 1e-6), 101600, 1e-6);
    EXPECT_NEAR(reynolds_number(.5, .08, 1e-6), 40000, 1e-6);
}

TEST(Oracles, JetFilms) {  // O36 ... O46
    const JetFlow jet = jet_flow(.036, 5e-3, 1000, 1e-6);
    EXPECT_NEAR(jet.velocity, 1.3541044, 1e-4);
    EXPECT_NEAR(jet.flow, 2.6587e-5, 1e-8);
    EXPECT_NEAR(jet.reynolds, 6770.5, 0.5);
    EXPECT_NEAR(radial_film_pressure(20e-6, 1e-3, 2.5e-3, .08, 1e-3), 132.38136, 1e-4);
    EXPECT_NEAR(radial_film_load(20e-6, 1e-3, 2.5e-3, .08, 1e-3), 0.383625, 1e-9);
    EXPECT_NEAR(radial_inertia_load(20e-6, 1e-3, 2.5e-3, .08, 1000, inviscid_film_factor), -0.094417848, 1e-8);
    EXPECT_NEAR(radial_inertia_load(20e-6, 1e-3, 2.5e-3, .08, 1000, laminar_film_factor), -0.14567325, 1e-8);
    EXPECT_NEAR(laminar_film_gradient, 1.542857143, 1e-9);
    EXPECT_NEAR(elliptic_film_load(20e-6, 1e-3, .0717, .0536, 1e-3), 0.2211606856, 1e-9);
    const JetFilm film = jet_film(.0717, .0536, 2.5e-3, 26.587e-6, 1e-3, 1000);
    EXPECT_NEAR(film.zero() * 1e3, 1.2568669, 1e-6);
    EXPECT_NEAR(film.lowest_gap() * 1e3, 1.8853004, 1e-6);
    EXPECT_NEAR(film.lowest(), -0.021899722, 1e-8);
    EXPECT_NEAR(film.stiffness(), 117.61239, 1e-4);
    EXPECT_NEAR(squeeze_damping(.0717, .0536, 1e-3, 1e-3), 66.754686, 1e-5);
    EXPECT_NEAR(gap_added_mass(.0717, .0536, 1e-3, 1000), 5.5628905, 1e-6);
    EXPECT_NEAR(squeeze_damping(.06, .06, 1e-3, 1e-3), 61.07256119, 1e-7);
    EXPECT_NEAR(ellipse_perimeter(.1016, .076), 0.560849, 1e-6);
    EXPECT_NEAR(rim_reynolds(26.587e-6, ellipse_perimeter(.1016, .076), 1e-6), 47.405, 1e-3);
    EXPECT_NEAR(thrust_exponent(.0007, .036, 3, 12), 2.842249087, 1e-8);
    EXPECT_NEAR(upwash_at_equilibrium(10, 8), 0.5625, 1e-12);
    EXPECT_NEAR(upwash_at_equilibrium(10, 4), 5.25, 1e-12);
    EXPECT_NEAR(core::convert(50, "gf", "N"), 0.4903325, 1e-9);  // O47
}

TEST(Oracles, MixedDragIsTwiceDifferentiable) {  // O48 O49 O50
    const MixedDrag d(.05, 15, .152, 1e-6);
    EXPECT_NEAR(d.w1, 6.5789474e-06, 1e-13);
    EXPECT_NEAR(d.w2, 0.0065789474, 1e-10);
    const double c[] = {3.2894737e-07, 0.00032861842, 0, -2.338924e-05, 0.00067967322, -0.00033599312};
    for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(d.c[i], c[i], 1e-11);
    }
    EXPECT_NEAR(d(2e-3), 0.00010423685, 1e-11);
    EXPECT_NEAR(d(5e-3), 0.00038115227, 1e-11);
    EXPECT_NEAR(d(.02), .006, 1e-12);
    EXPECT_NEAR(d.slope(2e-3), 0.058396413, 1e-8);
    for (const double w : {d.w1, d.w2}) {
        const double e = 1e-12 * w;
        EXPECT_NEAR(d(w + e), d(w - e), 1e-10 * d(w));
        EXPECT_NEAR(d.slope(w + e), d.slope(w - e), 1e-9 * d.slope(w));
        EXPECT_NEAR(d.curvature(w + e), d.curvature(w - e), 1e-6 * 30);
    }
    EXPECT_NEAR(gaussian_drag_factor, 1.5957691, 1e-7);
    EXPECT_NEAR(harmonic_drag_factor_of_amplitude, 0.84882636, 1e-8);
    EXPECT_NEAR(harmonic_drag_factor, 1.2004218, 1e-7);
}

TEST(Oracles, ReleaseEscapesAtTheStaticThresholdWithTheSqueezeFilmAndFarBelowWithout) {
    ReleaseSetup s;
    s.film = jet_film(.0717, .0536, 2.5e-3, 26.587e-6, 1e-3, 1000);
    s.mass = .6;
    s.quadratic_drag = 15;
    s.density = 1000;
    EXPECT_NEAR(escape_threshold(s, .04, 1e-4), .0219, 4e-4);
    // Without the film's damping the first push carries it past the gap of most suction, with no lightening at all
    // (Runge-Kutta of fourth order with halved steps says the same, with and without the film's mass); half the
    // precision is what a bisection answers for nought.
    s.squeeze = s.gap_mass = false;
    EXPECT_LE(escape_threshold(s, .04, 1e-5), 5e-6);
    s.extra_force = 0;
    EXPECT_EQ(release(s).outcome, ReleaseOutcome::escapes);
    s.squeeze = s.gap_mass = true;
    s.extra_force = 0;
    s.mass = 1 / .2529;
    EXPECT_NE(release(s).outcome, ReleaseOutcome::escapes);
    s.extra_force = .025;
    EXPECT_EQ(release(s).outcome, ReleaseOutcome::escapes);
}

TEST(Oracles, HeldGapIsOffWithoutCancellation) {  // O88
    const HeavePlant plant(test::ref_a_model());
    const double s = 1 / .2529;
    const double gap = held_gap([&](double h) { return plant.lift(h); }, s, .02);
    EXPECT_NEAR(gap, 0.018260022, 1e-8);
}

TEST(Oracles, GammaChartFindsTheAngleOfMostTorque) {
    const GammaChart chart = gamma_chart(evie(), layout(), .35, 6 * degree, 0.02, 0.0536);
    EXPECT_NEAR(std::tan(chart.best_gamma), .08 / .05, 1e-12);
    EXPECT_NEAR(chart.needed, 0.006831217331 + 0.02 * 0.0536, 1e-8);
    EXPECT_EQ(gamma_figure(chart).curves.size(), 2U);
}

}  // namespace

}  // namespace underbody::dynamics
