// Oracles O75-O84, O88 of the physics page, and the properties of observers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "cases/thesis/published.h"
#include "core/file.h"
#include "core/random.h"
#include "surrogates/estimator/control/bounds.h"
#include "surrogates/estimator/observe/observer.h"
#include "tests/support/support.h"

namespace underbody::estimator {
namespace {

using namespace thesis;

AugmentedModel p2_of(const AugmentedModel& m) {
    return corrected(m, Correction::p2, heave_rows(m.layout, thesis_virtual_mass(), 0));
}
AugmentedModel p3_of(const AugmentedModel& m) {
    return corrected(m, Correction::p3, heave_rows(m.layout, thesis_virtual_mass(), 0));
}

// O75, O76, O77, O78
TEST(RobustnessBounds, AgreeWithTheOraclesOnThePublishedMatrices) {
    struct Case {
        Matrix j;
        double pole1, pole2, det, mu, half, y;
    };
    const AugmentedModel a = published_8_47();
    // 7.5 with the digits of its sixth-order reconstruction is the same matrix.
    const AugmentedModel b = published_grid();
    const Case cases[] = {{a.j_zeta(), -3.7391162e-4, -1.3401411, .9621189, 3.4629639e-4, 1.731482e-4, 2.864249e-4},
                          {b.j_zeta(), -.015990398, -1.3824096, 1.0027, .015045063, .0075225313, .012022941}};
    for (const auto& c : cases) {
        const Poles p = eigenvalues(c.j);
        EXPECT_NEAR(p[0].real(), c.pole1, 1e-7);
        EXPECT_NEAR(p[1].real(), c.pole2, 1e-6);
        EXPECT_NEAR(c.j(0, 0) + c.j(0, 1) - c.j(1, 0) - c.j(1, 1), c.det, 1e-6);
        const RobustnessBounds r = robustness_bounds(c.j);
        EXPECT_NEAR(r.patel_toda, c.mu, 1e-6);
        EXPECT_NEAR(r.patel_toda_element, c.half, 1e-6);
        EXPECT_NEAR(r.yedavalli, c.y, 1e-6);
        EXPECT_LE(r.patel_toda, r.stability_degree);
    }
    EXPECT_NEAR(symmetric_part_abscissa(a.j_zeta()), 0.0258, 1e-4);
    EXPECT_NEAR(symmetric_part_abscissa(b.j_zeta()), 0.0059, 1e-4);
    EXPECT_NEAR(performance_ratio(a.j_zeta(), a.j_x()), 1.670, 1e-3);
    EXPECT_NEAR(performance_ratio(b.j_zeta(), b.j_x()), 1.630, 1e-3);
}

// O79
TEST(RobustnessBounds, HaveTheClosedFormOfATwoByTwo) {
    const Matrix a{{-3, -2}, {1, 0}};
    const RobustnessBounds all = robustness_bounds(a), one = robustness_bounds(a, Matrix{{1, 0}, {0, 0}});
    EXPECT_NEAR(all.p(0, 0), 0.5, 1e-12);
    EXPECT_NEAR(all.p(0, 1), 0.5, 1e-12);
    EXPECT_NEAR(all.p(1, 1), 2.5, 1e-12);
    EXPECT_NEAR(all.patel_toda, .38196601, 1e-8);
    EXPECT_NEAR(all.patel_toda_element, .19098301, 1e-8);
    EXPECT_NEAR(all.yedavalli, .23606798, 1e-8);
    EXPECT_NEAR(one.yedavalli, 1.6568542, 1e-7);
}

TEST(RobustnessBounds, HoldForRandomPerturbationsInsideThem) {
    core::Random random(3);
    for (int trial = 0; trial < 200; ++trial) {
        Matrix a(3, 3);
        for (std::size_t i = 0; i < 9; ++i) {
            a.data()[i] = random.normal();
        }
        a = a - (spectral_abscissa(a) + 0.3) * Matrix::identity(3);
        const RobustnessBounds r = robustness_bounds(a);
        Matrix e(3, 3);
        for (std::size_t i = 0; i < 9; ++i) {
            e.data()[i] = random.normal();
        }
        EXPECT_LT(spectral_abscissa(a + (0.999 * r.patel_toda / singular_values(e).front()) * e), 0);
        EXPECT_LT(spectral_abscissa(a + (0.999 * r.yedavalli / e.largest()) * e), 0);
    }
}

// O80
TEST(ReducedObserver, HasAckermannsGainOnThePublishedMatrix) {
    const Matrix gain = reduced_gain(p3_of(published_8_47()), {-1, -2});
    EXPECT_NEAR(gain(0, 0), 8.2076365, 1e-5);
    EXPECT_NEAR(gain(1, 0), 1.6458136, 1e-5);
    EXPECT_EQ(gain(0, 1), 0);
    EXPECT_EQ(gain(1, 1), 0);
}

// O81, O82 and the steady state without and with injection
TEST(Separability, FindsTheEmbeddedDragLawAndTheFictitiousForce) {
    EXPECT_NEAR(separability(published_8_47()).b_eff, 0.86534128, 1e-7);
    EXPECT_NEAR(separability(published_grid()).b_eff, 0.8747497, 1e-7);
    const AugmentedModel m = published_8_47();
    const SteadyState s = steady_state(m.j_x(), m.j_zeta(), {0, 1.5});
    ASSERT_TRUE(s.converges);
    EXPECT_NEAR(s.limit[0], -0.080361999, 1e-8);
    EXPECT_NEAR(s.limit[1], -0.022573391, 1e-8);
    EXPECT_NEAR(s.slowest_time, 2674, 1);
    const AugmentedModel p2 = p2_of(m);
    const Matrix l = reduced_gain(p2, {-1, -2});
    const SteadyState with = steady_state(p2.j_x() - l * p2.a_x(), p2.j_zeta() - l * p2.a_zeta(), {0, 1.5});
    EXPECT_NEAR(with.limit[0] - with.limit[1], 0, 3e-5);
    EXPECT_FALSE(separability(published_8_47()).explanation.empty());
    EXPECT_EQ(separability(published_8_47()).labels[0], "model-dependent");
}

// O83, O84
TEST(Separability, SeesOnlyTheTotalForceOfTheFrozenModel) {
    const AugmentedModel m = frozen_model(reference_plant(), 0.1, 0.0075);
    const Separability s = separability(m);
    EXPECT_EQ(s.reduced.rank, 1U);
    EXPECT_EQ(s.full.rank, 3U);
    EXPECT_NEAR(std::abs(s.reduced.unobservable(0, 0)), std::sqrt(.5), 1e-9);
    EXPECT_NEAR(s.reduced.unobservable(0, 0), s.reduced.unobservable(1, 0), 1e-9);
    EXPECT_NEAR(std::abs(s.full.unobservable(2, 0)), std::sqrt(.5), 1e-9);
    EXPECT_EQ(s.labels[0], "unobservable");
    try {
        reduced_gain(m, {-1, -2});
        FAIL();
    } catch (const core::InputError& e) {
        EXPECT_EQ(e.kind(), "unobservable");
        EXPECT_NE(std::string(e.what()).find("0.707 ground_force + 0.707 drag_force"), std::string::npos) << e.what();
    }
    // Rows that are zero but for round-off hide as much: noise is no observability.
    const Matrix nothing{{3e-17, -1e-16}, {2e-16, 4e-17}};
    EXPECT_EQ(observability(nothing, Matrix{{.2529, -.2529}}).rank, 1U);
    // A common error stays whatever the gain.
    const double f = .377;
    const Matrix j{{0, 0}, {f, -f}}, a{{.2529, -.2529}};
    for (const double l1 : {1., 8., 30.}) {
        const Matrix e = exponential(10.0 * (j - Matrix{{l1}, {2}} * a));
        const Vector end = e * Vector{.01, .01};
        EXPECT_NEAR(end[0], .01, 1e-12);
        EXPECT_NEAR(end[1], .01, 1e-12);
    }
}

// O62: thesis 8.19 ("method 2") against the xi form, both by Euler
TEST(ReducedObserver, IsTheSameInXiFormAndInInnovationForm) {
    const AugmentedModel m = p3_of(published_8_47());
    const Matrix l = reduced_gain(m, {-1, -2});
    const double dt = 0.05;
    FilterRunner run(reduced_observer(m, l, dt, Hold::euler).filter);
    core::Random random(5);
    Vector x{0.01, 0.2}, zeta{0, 0};
    double estimates[3];
    run.start(x.data(), estimates);
    for (int k = 0; k < 500; ++k) {
        const double u = 0.01 * random.normal();
        const Vector next{0.02 * random.normal(), 0.2 + 0.01 * random.normal()};
        const Vector model = m.a_x() * x, forces = m.a_zeta() * zeta, jx = m.j_x() * x, jz = m.j_zeta() * zeta;
        Vector nu(2), following = zeta;
        for (std::size_t i = 0; i < 2; ++i) {
            nu[i] = next[i] - x[i] - dt * (model[i] + forces[i] + m.b_u()(i, 0) * u);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            following[i] += dt * (jx[i] + jz[i] + m.j_u()(i, 0) * u) + l(i, 0) * nu[0] + l(i, 1) * nu[1];
        }
        zeta = following;
        x = next;
        run.step(x.data(), &u, estimates);
        ASSERT_NEAR(estimates[0], zeta[0], 1e-13);
        ASSERT_NEAR(estimates[1], zeta[1], 1e-13);
        ASSERT_NEAR(estimates[2], zeta[0] - zeta[1], 1e-13);
    }
}

// O63
TEST(LatentObserver, LosesItsGainInTheSecondProjection) {
    core::Random random(11);
    for (int trial = 0; trial < 20; ++trial) {
        AugmentedModel m = published_8_47();
        Matrix g(4, 4), l(4, 2);
        for (std::size_t i = 0; i < 16; ++i) {
            m.A.data()[i] = random.normal();
            g.data()[i] = random.normal();
        }
        for (std::size_t i = 0; i < 8; ++i) {
            l.data()[i] = 10 * random.normal();
        }
        const Matrix t = exponential(0.5 * (g - g.transposed()));
        ASSERT_LT((t.transposed() * t - Matrix::identity(4)).largest(), 1e-12);
        const LatentProjection p = latent_projection(m, t, l);
        EXPECT_LT((p.error_matrix - p.j_zeta).largest(), 1e-11);
        EXPECT_LT(p.innovation, 1e-12);
    }
}

TEST(LatentObserver, EstimatesTheSameAsTheFullOrderOne) {
    const AugmentedModel m = p3_of(published_8_47());
    const std::vector<std::string> sensors{"heave_velocity", "gap"};
    const Matrix l = full_gain(m, sensors, {-1, -1.5, -2, -2.5});
    Matrix skew(4, 4);
    core::Random random(2);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            skew(i, j) = random.normal();
            skew(j, i) = -skew(i, j);
        }
    }
    const ObserverDesign full = full_observer(m, sensors, l, 0.02);
    const ObserverDesign latent =
        latent_observer(m, exponential(skew), {.017, .35, .01, .02}, {0.001, .6, .008, 0}, sensors, l, 0.02);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(std::abs(full.poles[i] - latent.poles[i]), 0, 1e-7);
    }
    FilterRunner a(full.filter), b(latent.filter);
    double ea[5], eb[5], x[2] = {0.01, 0.3};
    a.start(x, ea);
    b.start(x, eb);
    for (int k = 0; k < 300; ++k) {
        const double u = 0.01 * random.normal();
        x[0] = 0.02 * random.normal();
        x[1] += 0.02 * x[0];
        a.step(x, &u, ea);
        b.step(x, &u, eb);
        for (int i = 0; i < 5; ++i) {
            ASSERT_NEAR(ea[i], eb[i], 1e-12);
        }
    }
}

TEST(FullOrderObserver, PutsItsPolesWhereItIsTold) {
    const AugmentedModel m = published_8_47();
    for (const Vector& poles : {Vector{-1, -1.1, -1.2, -1.3}, Vector{-1, -1.5, -2, -2.5}, Vector{-1, -3, -6, -9}}) {
        const Matrix l = full_gain(m, {"heave_velocity", "gap"}, poles);
        Matrix c(2, 4);
        c(0, 0) = c(1, 1) = 1;
        const Poles got = eigenvalues(m.A - l * c);
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(got[i].real(), poles[i], 1e-6);
            EXPECT_NEAR(got[i].imag(), 0, 1e-6);
        }
        const Matrix gap_only = full_gain(m, {"gap"}, poles);
        EXPECT_EQ(gap_only.columns(), 1U);
    }
}

TEST(ReducedObserver, ConvergesOnItsOwnModelByItsPolesWithExactSteps) {
    const AugmentedModel m = p3_of(published_8_47());
    const double dt = 0.1;
    const ObserverDesign d = reduced_observer(m, reduced_gain(m, {-3, -4}), dt);
    const Discrete truth = discretise(m.A, m.B, dt);
    EXPECT_NEAR(d.discrete_poles[0].real(), std::exp(-0.3), 1e-9);
    EXPECT_NEAR(d.discrete_poles[1].real(), std::exp(-0.4), 1e-9);
    FilterRunner run(d.filter);
    Vector x{0.0, 0.3, 0.012, 0.004};
    double e[3];
    run.start(x.data(), e);
    for (int k = 0; k < 300; ++k) {
        const double u = 0;
        x = truth.phi * x;
        run.step(x.data(), &u, e);
    }
    EXPECT_NEAR(e[2], x[2] - x[3], 3e-6);
}

TEST(DisturbanceObserver, FollowsAConstantForceWithoutAnyForceModel) {
    const double s = thesis_virtual_mass(), dt = 0.02;
    const ObserverDesign d = disturbance_observer(s, -0.01, 5, dt);
    FilterRunner run(d.filter);
    double w = 0, e = 0;
    run.start(&w, &e);
    for (int k = 1; k <= 500; ++k) {
        const double u = 0.004;
        w += dt * (0.02 + u - 0.01) / s;
        run.step(&w, &u, &e);
    }
    EXPECT_NEAR(e, 0.02, 1e-12);
}

TEST(Observers, RefuseGainsAndStepsThatMakeThemUnstable) {
    const AugmentedModel m = p3_of(published_8_47());
    Matrix gain(2, 2);
    gain(0, 0) = -3;
    EXPECT_THROW(reduced_observer(m, gain, 0.01), core::InputError);
    EXPECT_THROW(reduced_observer(m, reduced_gain(m, {-3, -40}), 0.1, Hold::euler), core::InputError);
    EXPECT_NO_THROW(reduced_observer(m, reduced_gain(m, {-3, -40}), 0.1));
    EXPECT_THROW(reduced_gain(m, {{-1, 2}, {-1, 1}}), core::InputError);
    EXPECT_THROW(full_observer(m, {"hight"}, Matrix(4, 1), 0.1), core::InputError);
}

TEST(KalmanFilter, StatesItsCovarianceTrulyOnItsOwnModelAndHasWhiteInnovations) {
    const AugmentedModel m = p3_of(published_8_47());
    const double dt = 0.05;
    const Vector process{0, 0, 1e-6, 1e-6}, sigma{2e-4, 1e-3};
    const ObserverDesign d = kalman_observer(m, {"heave_velocity", "gap"}, process, sigma, dt);
    FilterRunner run(d.filter);
    const Discrete truth = discretise(m.A, m.B, dt);
    const Matrix q = discrete_noise(m.A, Matrix::diagonal(process), dt);
    // Cholesky factor of q by hand (4 x 4, with a floor for the rows of measured states).
    Matrix c(4, 4);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = q(i, j);
            for (std::size_t k = 0; k < j; ++k) {
                sum -= c(i, k) * c(j, k);
            }
            c(i, j) = i == j ? std::sqrt(std::max(sum, 0.0)) : (c(j, j) > 1e-16 ? sum / c(j, j) : 0);
        }
    }
    core::Random random(17);
    Vector x{0, 0.3, 0.01, 0}, squares(5, 0.0);
    double e[5], y[2] = {x[0], x[1]}, lag0 = 0, lag1 = 0, last = 0;
    run.start(y, e);
    const int n = 40000, warm = 2000;
    for (int k = 0; k < n; ++k) {
        const double u = 0;
        const Vector before{e[0], e[1], e[2], e[3]};
        x = truth.phi * x;
        Vector noise(4);
        for (double& v : noise) {
            v = random.normal();
        }
        const Vector kick = c * noise;
        for (std::size_t i = 0; i < 4; ++i) {
            x[i] += kick[i];
        }
        y[0] = x[0] + sigma[0] * random.normal();
        y[1] = x[1] + sigma[1] * random.normal();
        const Vector predicted = truth.phi * before;
        run.step(y, &u, e);
        if (k < warm) {
            continue;
        }
        const double innovation = y[0] - predicted[0];
        lag0 += innovation * innovation;
        lag1 += innovation * last;
        last = innovation;
        for (std::size_t i = 0; i < 4; ++i) {
            squares[i] += (e[i] - x[i]) * (e[i] - x[i]);
        }
        squares[4] += std::pow(e[4] - (x[2] - x[3]), 2);
    }
    for (std::size_t i = 0; i < 5; ++i) {
        // The slow direction of the split has few independent samples: a wide band there.
        EXPECT_NEAR(std::sqrt(squares[i] / (n - warm)) / std::sqrt(d.covariance(i, i)), 1,
                    i == 2 || i == 3 ? 0.5 : 0.06)
            << i;
    }
    EXPECT_LT(std::abs(lag1 / lag0), 4 / std::sqrt(static_cast<double>(n)));
}

TEST(KalmanFilter, RefusesADirectionItCannotSee) {
    const AugmentedModel m = frozen_model(reference_plant(), 0.1, 0.0075);
    try {
        kalman_observer(m, {"heave_velocity", "gap"}, {0, 0, 1e-6, 1e-6}, {1e-4, 1e-3}, 0.05);
        FAIL();
    } catch (const core::InputError& e) {
        EXPECT_EQ(e.kind(), "unobservable");
    }
}

TEST(NoiseGain, GrowsAsThePolesMoveLeftAsThePageSays) {
    const AugmentedModel m = p3_of(published_8_47());
    const double want[] = {0.9e-3, 2.2e-3, 8.2e-3};
    const Poles poles[] = {{-1, -2}, {-3, -4}, {-10, -12}};
    for (int i = 0; i < 3; ++i) {
        const ObserverDesign d = reduced_observer(m, reduced_gain(m, poles[i]), 0.002);
        const double sigma = noise_gain(d.filter, {1e-4, 0})[2];
        // The page's own numbers are of one simulated run; the slow poles leave it few independent samples.
        EXPECT_NEAR(sigma / want[i], 1, i == 0 ? 0.3 : 0.12) << i;
        FilterRunner run(d.filter);
        core::Random random(41);
        double e[3], x[2] = {0, 0}, u = 0, square = 0;
        run.start(x, e);
        for (int k = 0; k < 400000; ++k) {
            x[0] = 1e-4 * random.normal();
            run.step(x, &u, e);
            square += e[2] * e[2];
        }
        EXPECT_NEAR(std::sqrt(square / 400000) / sigma, 1, 0.03);
    }
}

TEST(LinearSystems, SolveTheirEquations) {
    core::Random random(23);
    Matrix a(4, 4), b(4, 2), g(4, 4);
    for (std::size_t i = 0; i < 16; ++i) {
        a.data()[i] = random.normal();
        g.data()[i] = random.normal();
    }
    for (std::size_t i = 0; i < 8; ++i) {
        b.data()[i] = random.normal();
    }
    const Matrix q = g * g.transposed(), r{{2, .3}, {.3, 1}};
    const Matrix stable = a - (spectral_abscissa(a) + .5) * Matrix::identity(4);
    const Matrix p = lyapunov(stable, q);
    EXPECT_LT((stable.transposed() * p + p * stable + q).largest(), 1e-10 * (1 + p.largest()));
    const Matrix phi = exponential(0.1 * a), c = b.transposed();
    const Matrix before = discrete_riccati(phi, c, q, r);
    const Matrix gain = before * c.transposed() * inverse(c * before * c.transposed() + r);
    EXPECT_LT((phi * (before - gain * c * before) * phi.transposed() + q - before).largest(), 1e-9 * before.largest());
    EXPECT_LT((logarithm(phi) - 0.1 * a).largest(), 1e-10);
    // First-order hold is exact for a ramp: integrate in a thousand pieces.
    const auto foh = discretise_first_order_hold(a, b, 0.3);
    const Discrete fine = discretise(a, b, 0.3 / 3000);
    Vector state{1, 2, 3, 4};
    const Vector u0{1, -1}, u1{3, 2};
    const Vector exact_start = state;
    for (int k = 0; k < 3000; ++k) {
        const double f = (k + .5) / 3000;
        const Vector drive = fine.gamma * Vector{u0[0] + f * (u1[0] - u0[0]), u0[1] + f * (u1[1] - u0[1])};
        state = fine.phi * state;
        for (std::size_t i = 0; i < 4; ++i) {
            state[i] += drive[i];
        }
    }
    const Vector p0 = foh.phi * exact_start, p1 = foh.gamma0 * u0, p2 = foh.gamma1 * u1;
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(p0[i] + p1[i] + p2[i], state[i], 1e-6);
    }
}

// Worst relative difference between the compiled header and the library over 5000 samples; negative: it does not
// compile.
double worst_difference(const LinearFilter& f, const std::string& compiler) {
    const core::TemporaryFolder folder;
    std::ofstream(folder.path() / "observer.h") << export_c(f, "observer", {"thesis 8.47, P3"});
    std::ofstream(folder.path() / "main.c") << R"(#include <stdio.h>
#include "observer.h"
int main(void) {
    observer_state o;
    double x[observer_measured], u, e[observer_estimates];
    int first = 1, i;
    for (;;) {
        for (i = 0; i < observer_measured; ++i) {
            if (scanf("%lf", &x[i]) != 1) return 0;
        }
        if (scanf("%lf", &u) != 1) return 0;
        if (first) { observer_start(&o, x, e); first = 0; } else { observer_step(&o, x, &u, e); }
        for (i = 0; i < observer_estimates; ++i) printf("%.17g\n", e[i]);
    }
}
)";
    const auto built = test::run_program(
        "/bin/sh", {"-c", compiler + " -std=c99 -Wall -Wextra -Wconversion -Werror -pedantic -O2 main.c -o main"},
        folder.path());
    if (built.exit_code != 0) {
        ADD_FAILURE() << compiler << ": " << built.errors;
        return -1;
    }
    core::Random random(31);
    std::ofstream in(folder.path() / "in.txt");
    in.precision(17);
    FilterRunner filter(f);
    std::vector<double> want;
    for (int k = 0; k < 5000; ++k) {
        const double h = 0.3 + 0.1 * random.normal(), w = 0.02 * random.normal(), u = 0.01 * random.normal();
        double x[2] = {};
        for (std::size_t i = 0; i < f.measured.size(); ++i) {
            x[i] = f.measured[i] == "gap" ? h : w;
            in << x[i] << ' ';
        }
        in << u << '\n';
        double e[FilterRunner::most_states];
        k == 0 ? filter.start(x, e) : filter.step(x, &u, e);
        want.insert(want.end(), e, e + f.estimates.size());
    }
    in.close();
    EXPECT_EQ(test::run_program("/bin/sh", {"-c", "./main < in.txt > out.txt"}, folder.path()).exit_code, 0);
    std::ifstream results(folder.path() / "out.txt");
    double worst = 0, value = 0;
    std::size_t i = 0;
    for (; results >> value && i < want.size(); ++i) {
        worst = std::max(worst, std::abs(value - want[i]) / (1e-3 + std::abs(want[i])));
    }
    EXPECT_EQ(i, want.size());
    return worst;
}

TEST(ExportedObserver, CompilesStrictlyByGccAndClangAndAgreesWithTheLibraryToTwelveDigits) {
    const AugmentedModel m = p3_of(published_8_47());
    const std::vector<std::string> sensors{"heave_velocity", "gap"};
    const Matrix gain = full_gain(m, sensors, {-3, -4, -5, -6});
    const ObserverDesign designs[] = {
        reduced_observer(m, reduced_gain(m, {-3, -4}), 0.02), full_observer(m, sensors, gain, 0.02),
        latent_observer(m, usual_rotation(), {.017, .35, .01, .02}, {0, .6, .008, 0}, sensors, gain, 0.02),
        kalman_observer(m, {"gap"}, {0, 0, 1e-6, 1e-6}, {2e-4}, 0.02),
        disturbance_observer(thesis_virtual_mass(), -0.01, 4, 0.02)};
    for (const char* compiler : {"gcc", "clang"}) {
        if (test::run_program("/bin/sh", {"-c", std::string("command -v ") + compiler},
                              std::filesystem::temp_directory_path())
                .exit_code != 0) {
            std::printf("%s is not here: its part of the test is left out\n", compiler);
            continue;
        }
        for (const ObserverDesign& d : designs) {
            const double worst = worst_difference(d.filter, compiler);
            EXPECT_GE(worst, 0);
            EXPECT_LT(worst, 1e-12) << compiler << " " << d.filter.name;
        }
    }
    EXPECT_THROW(export_c(designs[0].filter, "3bad"), core::InputError);
}

}  // namespace
}  // namespace underbody::estimator
