// Oracles O50, O51, O58-O74, O85, O86, O89 of the physics page, and properties of the learning.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cases/thesis/published.h"
#include "core/random.h"
#include "surrogates/estimator/model/augmented_model.h"
#include "surrogates/estimator/model/training.h"
#include "tests/support/support.h"

namespace underbody::estimator {
namespace {

using namespace thesis;

void expect_near(const Vector& got, const Vector& want, double tolerance, const std::string& what) {
    ASSERT_EQ(got.size(), want.size()) << what;
    for (std::size_t i = 0; i < got.size(); ++i) {
        EXPECT_NEAR(got[i], want[i], tolerance) << what << " [" << i << "]";
    }
}

// .02 sin(2 pi h) in place of REF-A: a curve with closed-form moments.
SeparatedPlant sine_plant() {
    SeparatedPlant plant = reference_plant();
    plant.ground_force = [](double h, double& slope) {
        const double k = 2 * std::numbers::pi;
        slope = .02 * k * std::cos(k * h);
        return .02 * std::sin(k * h);
    };
    return plant;
}

// The deterministic mesh of the oracles.
TrainingSet oracle_mesh(const SeparatedPlant& plant) {
    TrainingOptions o;
    o.mesh_inputs = 5;
    o.mesh_velocities = 41;
    o.mesh_gaps = 61;
    return training_set(plant, o);
}

AugmentedModel fit(const TrainingSet& set, Fit how, std::size_t order) {
    LearnOptions o;
    o.fit = how;
    o.order = order;
    return learn(moments(set.view()), set.layout, o);
}

struct Published {
    const char* name;
    SeparatedPlant plant;
    Vector eigenvalues, row3_order6, row4_order6;
    double b4_order6;
    double ols_slope;
};

std::vector<Published> oracle_cases() {
    return {{"sine",
             sine_plant(),
             {4.6105144, 1.5097405, 1.0507967, .95248674, .73491269, .12308437, .018464623, 0, 0},
             {0.00018024648, -7.3110858e-09, 7.5881285e-05, -0.00027658986},
             {0.91983978, -3.7310175e-05, 0.38723988, -1.4115025},
             0.38755441,
             0.016918895},
            {"REF-A",
             reference_plant(),
             {4.6612564, 1.3164126, 1.055794, .99990989, .81529729, .13218356, .019146222, 0, 0},
             {-8.6771767e-06, -2.2070482e-10, -3.6718787e-06, 1.3362015e-05},
             {0.91258614, 2.3211715e-05, 0.38617464, -1.4052946},
             0.38636922,
             -0.00077304687}};
}

// O52-O55: the curve itself.
TEST(ReferenceCurve, GivesTheValuesAndSlopesOfTheOracles) {
    const auto f = reference_ground_force();
    double slope = 0;
    const double h[] = {.005, .065, .155, .275, .75},
                 want[] = {-0.0021467003, -0.014388284, -0.0010682339, 0.015453207, 0.01457831};
    for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(f(h[i], slope), want[i], 1e-8);
    }
    f(0, slope);
    EXPECT_NEAR(slope, -0.44735064, 1e-6);
    f(.16, slope);
    EXPECT_NEAR(slope, 0.20983183, 1e-6);
}

// O50, O51
TEST(EquivalentDrag, HasTheFactorsOfGaussianAndSinusoidalMotion) {
    EXPECT_NEAR(equivalent_drag_factor(MotionShape::gaussian), 1.5957691, 1e-7);
    EXPECT_NEAR(equivalent_drag_factor(MotionShape::sinusoid), 1.2004218, 1e-7);
    EXPECT_NEAR(equivalent_drag_factor(MotionShape::sinusoid) / std::numbers::sqrt2, 0.84882636, 1e-7);
    const SeparatedPlant plant = reference_plant(quadratic_drag(0, 7));
    for (const auto shape : {MotionShape::gaussian, MotionShape::sinusoid}) {
        const PlaneModel m = equivalent_model(plant, 0.05, 0.02, shape);
        EXPECT_NEAR(-m.A(0, 0) * plant.virtual_mass, equivalent_drag_factor(shape) * 7 * 0.02, 1e-6);
    }
}

TEST(UniformVelocity, CorrelatesWithItsSquareAndCubeAsTheClosedFormsSay) {
    const double third = 1. / 3, quarter = 1. / 4, fifth = 1. / 5, sixth = 1. / 6;  // E x^2, E x|x|x, E x^4, E x^5 sgn
    EXPECT_NEAR(quarter / std::sqrt(third * fifth), 0.96824584, 1e-8);
    const Vector c = solve(Matrix{{third, quarter}, {quarter, fifth}}, Vector{fifth, sixth});
    expect_near(c, {-0.4, 4. / 3}, 1e-12, "x^3 on (x, x|x|)");
}

// O58-O73
TEST(Learning, ReproducesSpectraAndMatricesOfTheMesh) {
    for (const auto& c : oracle_cases()) {
        const TrainingSet set = oracle_mesh(c.plant);
        const AugmentedModel six = fit(set, Fit::method2, 6), seven = fit(set, Fit::method2, 7);
        ASSERT_EQ(six.rank, 7U) << c.name;
        expect_near(six.eigenvalues, c.eigenvalues, 1e-6, c.name);
        for (const auto* m : {&six, &seven}) {
            expect_near(m->A.row(0), {0, 0, 0.2529, -0.2529}, 1e-7, c.name);
            expect_near(m->A.row(1), {1, 0, 0, 0}, 1e-7, c.name);
            EXPECT_NEAR(m->B(0, 0), 0.2529, 1e-7);
            EXPECT_NEAR(m->B(1, 0), 0, 1e-7);
        }
        expect_near(six.A.row(2), c.row3_order6, 1e-7, c.name);
        expect_near(six.A.row(3), c.row4_order6, 1e-6, c.name);
        EXPECT_NEAR(six.B(3, 0), c.b4_order6, 1e-6);
        expect_near(seven.A.row(2), {0, 0, 0, 0}, 1e-9, c.name);
        expect_near(seven.A.row(3), {0, 0, 0, 0}, 1e-9, c.name);
        const AugmentedModel ols = fit(set, Fit::least_squares, 0);
        expect_near(ols.A.row(2), {c.ols_slope, 0, 0, 0}, 1e-8, c.name);
        expect_near(ols.A.row(3), {0.48047716, 0, 0.39015685, -1.0393877}, 1e-6, c.name);
        EXPECT_NEAR(ols.B(3, 0), 0.39015685, 1e-6);
    }
}

// O61, O64, O69, O72 and the theorem behind them
TEST(Learning, GivesTheSameMatrixByBothMethodsAtEveryOrder) {
    for (const auto& c : oracle_cases()) {
        const TrainingSet set = oracle_mesh(c.plant);
        for (std::size_t order = 1; order <= 7; ++order) {
            const AugmentedModel a = fit(set, Fit::method1, order), b = fit(set, Fit::method2, order);
            const double tolerance =
                order == 4 || order == 5 ? 1e-7 : 1e-9;  // nearly singular there: the thesis's "anomaly"
            EXPECT_LT((a.A - b.A).largest(), tolerance * std::max(1.0, b.A.largest())) << c.name << " order " << order;
            EXPECT_LT((a.B - b.B).largest(), tolerance * std::max(1.0, b.B.largest())) << c.name << " order " << order;
        }
    }
}

TEST(Learning, EqualsLeastSquaresByWeightedLatentRegressionFromTheRankOn) {
    const TrainingSet set = oracle_mesh(reference_plant());
    const AugmentedModel ols = fit(set, Fit::least_squares, 0), latent = fit(set, Fit::weighted_latent, 7);
    EXPECT_LT((ols.A - latent.A).largest(), 1e-9);
    EXPECT_LT((ols.B - latent.B).largest(), 1e-9);
}

// O48 of the physics page: the exact relations live in the latent equations from the rank on
TEST(Learning, LeavesNoResidualInItsExactRelationsFromTheRankOn) {
    const TrainingSet set = oracle_mesh(reference_plant());
    const Moments m = moments(set.view());
    const auto residual = [&](std::size_t order) {
        const AugmentedModel model = fit(set, Fit::method2, order);
        const Matrix u = model.basis.block(0, 0, 1, order), v = model.basis.block(1, 0, 4, order),
                     w = model.basis.block(5, 0, 4, order);
        double worst = 0;
        for (std::size_t i = 0; i < set.count; i += 97) {
            Vector n(9);
            for (std::size_t c = 0; c < 9; ++c) {
                n[c] = (set.at(i, c) - m.mean[c]) / model.sigma[c];
            }
            const Vector x(n.begin() + 1, n.begin() + 5), d(n.begin() + 5, n.end());
            const Vector left = (Matrix::identity(4) - w * w.transposed()) * d, right = w * v.transposed() * x;
            const Vector input = w * u.transposed() * Vector{n[0]};
            for (std::size_t k = 0; k < 4; ++k) {
                worst = std::max(worst, std::abs(left[k] - right[k] - input[k]));
            }
        }
        return worst;
    };
    EXPECT_LT(residual(7), 1e-12);
    EXPECT_GT(residual(6), 1e-3);
}

// O74
TEST(Learning, FindsThePublishedSixthOrderRowFromThePopulation) {
    // Midpoints stand for the uniform population; two inputs at +-sigma have the moments of the Gaussian.
    const SeparatedPlant plant = reference_plant(quadratic_drag(0, 50.209));
    const Layout layout = Layout::heave();
    std::vector<double> rows;
    const int gaps = 600, velocities = 160;
    rows.resize(static_cast<std::size_t>(gaps) * velocities * 2 * 9);
    std::size_t at = 0;
    for (int i = 0; i < gaps; ++i) {
        for (int j = 0; j < velocities; ++j) {
            for (const double u : {-.00278, .00278}) {
                sample_at(plant, layout, u, .03 * ((2 * j + 1.) / velocities - 1), 1.2 * (i + .5) / gaps,
                          rows.data() + at);
                at += 9;
            }
        }
    }
    LearnOptions o;
    o.fit = Fit::method2;
    o.order = 6;
    const AugmentedModel m = learn(moments(SampleView::samples_in_rows(rows.data(), rows.size() / 9, 9)), layout, o);
    EXPECT_NEAR(m.A(3, 0), 0.8337, 5e-4);
    EXPECT_NEAR(m.A(3, 2), 0.3770, 5e-4);
    EXPECT_NEAR(m.A(3, 3), -1.3407, 5e-4);
    EXPECT_NEAR(m.B(3, 0), 0.3772, 5e-4);
}

// O85, O86
TEST(PublishedMatrices, GiveBackThePrintedSpectrumAndModel) {
    const Matrix c = printed_covariance();
    EXPECT_NEAR((c - c.transposed()).largest(), 0.0074, 1e-9);
    const Poles spectrum = eigenvalues(0.5 * (c + c.transposed()));
    const double want[] = {4.69008, 1.49125, 1.12394, .99864, .69597};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(spectrum[i].real(), want[i], 1e-4);
    }
    const Matrix t = printed_basis();
    const Matrix a = (t.block(5, 0, 4, 5) * pseudo_inverse(t.block(0, 0, 5, 5), 1e-6)).block(0, 1, 4, 4);
    EXPECT_NEAR(a(0, 0), -0.42165, 2e-4);
    EXPECT_NEAR(a(0, 2), 0.37096, 2e-4);
    EXPECT_NEAR(a(1, 0), 0.5, 2e-4);
    EXPECT_NEAR(a(2, 0), 0.00382, 2e-4);
    EXPECT_NEAR(a(2, 2), -0.0034, 2e-4);
}

// O89
TEST(Learning, SplitsCollinearDragAndVelocityByLeastNorm) {
    const TrainingSet set = oracle_mesh(reference_plant(quadratic_drag(1.25, 0)));
    const AugmentedModel m = fit(set, Fit::method2, 5);
    EXPECT_EQ(m.rank, 5U);
    expect_near(m.A.row(0), {-0.1580625, 0, 0.2529, -0.12645}, 1e-6, "row 1");
    expect_near(m.A.row(1), {0.5, 0, 0, 0.4}, 1e-6, "row 2");
    expect_near(m.A.row(3), {-0.19757813, 0, 0.316125, -0.1580625}, 1e-6, "row 4");
    EXPECT_THROW(fit(set, Fit::method2, 6), core::InputError);
}

TEST(Learning, ReturnsTheMeanDerivativeAtTheMeanState) {
    SeparatedPlant plant = reference_plant();
    plant.bias = -0.004;
    TrainingOptions o;
    o.samples = 3000;
    const TrainingSet set = training_set(plant, o);
    const Moments m = moments(set.view());
    for (const auto how : {Fit::least_squares, Fit::method2, Fit::weighted_latent}) {
        const AugmentedModel model = fit(set, how, 6);
        const Vector d = model.derivative({m.mean[1], m.mean[2], m.mean[3], m.mean[4]}, {m.mean[0]});
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(d[i], m.mean[5 + i], 1e-14);
        }
    }
    const AugmentedModel fixed = corrected(fit(set, Fit::least_squares, 0), Correction::p2,
                                           heave_rows(set.layout, plant.virtual_mass, plant.bias));
    EXPECT_NEAR(fixed.offset[0], plant.bias / plant.virtual_mass, 1e-16);
    EXPECT_NEAR(fit(set, Fit::least_squares, 0).offset[0], plant.bias / plant.virtual_mass, 1e-9);
}

TEST(Learning, HasNoOffsetFromRawMomentsAndPassesThroughAGivenEquilibrium) {
    const TrainingSet set = oracle_mesh(reference_plant());
    const Moments m = moments(set.view());
    LearnOptions raw;
    raw.offset = OffsetMode::none;
    EXPECT_EQ(learn(m, set.layout, raw).offset, Vector(4, 0.0));
    LearnOptions about;
    about.offset = OffsetMode::equilibrium;
    about.point = {0, 0, 0.16, 0, 0};
    const Vector d = learn(m, set.layout, about).derivative({0, 0.16, 0, 0}, {0});
    for (const double v : d) {
        EXPECT_NEAR(v, 0, 1e-15);
    }
}

TEST(Learning, SaysWhereAForwardDifferenceContradictsTheStates) {
    TrainingOptions o;
    o.samples = 20000;
    o.difference_step = 0.0024;
    const TrainingSet set = training_set(reference_plant(), o);
    const AugmentedModel m = fit(set, Fit::least_squares, 0);
    // The fingerprint of the published grid matrix: (dt/2)/S on both forces and the input.
    EXPECT_NEAR(m.A(1, 2), 0.0003, 5e-5);
    EXPECT_NEAR(m.A(1, 3), -0.0003, 5e-5);
    EXPECT_NEAR(m.B(1, 0), 0.0003, 5e-5);
    const auto said = std::any_of(m.remarks.begin(), m.remarks.end(), [](const core::Problem& p) {
        return p.message.find("forward differences with a step of 0.0024") != std::string::npos;
    });
    EXPECT_TRUE(said);
    EXPECT_TRUE(check_consistency(moments(oracle_mesh(reference_plant()).view()), Layout::heave()).empty());
}

TEST(Learning, SaysWhereSamplesContradictTheEquationOfMotionOrHoldAnOutlier) {
    const auto said = [](const TrainingSet& set, const char* words) {
        const auto problems = check_consistency(moments(set.view()), set.layout, thesis_virtual_mass());
        return std::any_of(problems.begin(), problems.end(),
                           [&](const core::Problem& p) { return p.message.find(words) != std::string::npos; });
    };
    TrainingOptions o;
    o.samples = 5000;
    const TrainingSet good = training_set(reference_plant(), o);
    EXPECT_TRUE(check_consistency(moments(good.view()), good.layout, thesis_virtual_mass()).empty());
    TrainingSet heavy = good, noisy = good, spike = good;
    core::Random random(2);
    for (std::size_t i = 0; i < good.count; ++i) {
        heavy.values[i * 9 + 5] /= 1.1;
        noisy.values[i * 9 + 3] += 1e-3 * random.normal();
    }
    spike.values[9 * 77 + 3] = 5;
    EXPECT_TRUE(said(heavy, "virtual mass of 4.3495 kg"));
    EXPECT_TRUE(said(noisy, "the acceleration contradicts the forces"));
    EXPECT_TRUE(said(spike, "channel 'ground_force' holds 5, 7"));
    o.auxiliaries = {"total_force", "gap_squared"};
    const TrainingSet total = training_set(reference_plant(), o);
    EXPECT_TRUE(check_consistency(moments(total.view()), total.layout, thesis_virtual_mass()).empty());
}

/// A force that is steep near the ground reaches far from its mean in a few of many samples, and is no outlier.
TEST(Learning, OneValueIsAnOutlierWhereItMakesANotablePartOfTheVariance) {
    const Layout layout = Layout::heave();
    const auto warned = [&](std::size_t count, double reach) {
        Moments m;
        m.count = count;
        m.mean = Vector(layout.channels(), 0.0);
        m.covariance = Matrix::identity(layout.channels());
        m.lowest = Vector(layout.channels(), -3.0);
        m.highest = Vector(layout.channels(), 3.0);
        m.lowest[layout.channels() - 1] = -reach;
        const auto problems = check_consistency(m, layout);
        return std::count_if(problems.begin(), problems.end(), [](const core::Problem& p) {
            return p.message.find("deviations from its mean: one value makes") != std::string::npos;
        });
    };
    EXPECT_EQ(warned(50000, 20), 0);  // 0.8 % of the variance
    EXPECT_EQ(warned(2000, 20), 1);   // 20 %
    EXPECT_EQ(warned(2000, 10), 0);
    EXPECT_EQ(warned(50000, 40), 1);
}

TEST(Learning, RefusesWhatCannotBeLearned) {
    const Layout layout = Layout::heave();
    std::vector<double> few(8 * 9, 1.0);
    EXPECT_THROW(learn(moments(SampleView::samples_in_rows(few.data(), 8, 9)), layout), core::InputError);
    std::vector<double> constant(100 * 9, 1.0);
    EXPECT_THROW(learn(moments(SampleView::samples_in_rows(constant.data(), 100, 9)), layout), core::InputError);
    TrainingSet set = oracle_mesh(reference_plant());
    set.values[9 * 1000 + 3] = std::numeric_limits<double>::quiet_NaN();
    try {
        moments(set.view(), set.layout.names());
        FAIL();
    } catch (const core::InputError& e) {
        EXPECT_NE(std::string(e.what()).find("sample 1001 of channel 'ground_force' is not a number"),
                  std::string::npos)
            << e.what();
    }
    TrainingOptions o;
    o.auxiliaries = {"ground_forse"};
    EXPECT_THROW(training_set(reference_plant(), o), core::InputError);
}

TEST(Learning, LeavesOutAConstantChannelAndSaysSo) {
    TrainingOptions o;
    o.samples = 2000;
    o.excitation = Excitation::none;
    const TrainingSet set = training_set(reference_plant(), o);
    const AugmentedModel m = fit(set, Fit::least_squares, 0);
    EXPECT_EQ(m.B(0, 0), 0);
    EXPECT_NEAR(m.A(0, 2), 0.2529, 1e-9);
    EXPECT_TRUE(std::any_of(m.remarks.begin(), m.remarks.end(), [](const auto& p) {
        return p.message.find("'input_force' is constant") != std::string::npos;
    }));
}

TEST(TrainingData, HasTheVanishingCorrelationsOfTheGrid) {
    TrainingOptions o;
    o.excitation = Excitation::white;
    const TrainingSet set = training_set(reference_plant(), o);
    const Moments m = moments(set.view());
    const double bound = 4.5 / std::sqrt(static_cast<double>(set.count));
    const auto r = [&](std::size_t i, std::size_t j) {
        return m.covariance(i, j) / std::sqrt(m.covariance(i, i) * m.covariance(j, j));
    };
    for (const std::size_t j : {1U, 2U, 3U, 4U, 6U, 7U}) {
        EXPECT_LT(std::abs(r(0, j)), bound) << j;
    }
    EXPECT_LT(std::abs(r(1, 2)), bound);
    EXPECT_LT(std::abs(r(1, 3)), bound);
    EXPECT_LT(std::abs(r(2, 4)), bound);
    EXPECT_LT(std::abs(r(2, 7)), bound);
    EXPECT_NEAR(r(1, 6), 1, 1e-12);
}

TEST(TrainingData, StaysExactInItsKinematicRowsAlongTrajectories) {
    TrainingOptions o;
    o.method = TrainingOptions::Method::time;
    o.samples = 5000;
    const TrainingSet set = training_set(reference_plant(), o);
    const AugmentedModel m = fit(set, Fit::least_squares, 0);
    expect_near(m.A.row(0), {0, 0, 0.2529, -0.2529}, 1e-8, "row 1");
    expect_near(m.A.row(1), {1, 0, 0, 0}, 1e-9, "row 2");
}

TEST(TrainingData, MovesAsItsOwnDerivativesSayToFourthOrder) {
    const SeparatedPlant plant = reference_plant();
    const auto end = [&](int steps) {
        double h = 0.25, w = 0.01;
        for (int i = 0; i < steps; ++i) {
            plant.advance(h, w, 0.002, 1.0 / steps);
        }
        return h;
    };
    const double fine = end(640);
    const double order = std::log2(std::abs(end(10) - fine) / std::abs(end(20) - fine));
    EXPECT_GT(order, 3.6);
}

TEST(Moments, AgreeWithTheTwoPassFormulaInBothLayoutsAndFromAFile) {
    core::Random random(7);
    const std::size_t n = 70001, c = 9;
    std::vector<double> rows(n * c), columns(n * c);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < c; ++j) {
            rows[i * c + j] =
                1e6 * static_cast<double>(j) + random.normal() * std::pow(10.0, static_cast<double>(j) - 4);
            columns[j * n + i] = rows[i * c + j];
        }
    }
    const Moments a = moments(SampleView::samples_in_rows(rows.data(), n, c));
    const Moments b = moments(SampleView::channels_in_rows(columns.data(), c, n));
    for (std::size_t i = 0; i < c; ++i) {
        long double mean = 0;
        for (std::size_t k = 0; k < n; ++k) {
            mean += rows[k * c + i];
        }
        mean /= n;
        double lowest = rows[i], highest = rows[i];
        for (std::size_t k = 0; k < n; ++k) {
            lowest = std::min(lowest, rows[k * c + i]);
            highest = std::max(highest, rows[k * c + i]);
        }
        EXPECT_NEAR(a.lowest[i], lowest, 1e-9 * (1 + std::abs(lowest)));
        EXPECT_NEAR(a.highest[i], highest, 1e-9 * (1 + std::abs(highest)));
        EXPECT_NEAR(a.mean[i], static_cast<double>(mean), 1e-12 * (1 + std::abs(a.mean[i])));
        for (std::size_t j = 0; j <= i; ++j) {
            long double sum = 0;
            for (std::size_t k = 0; k < n; ++k) {
                sum += (rows[k * c + i] - static_cast<long double>(a.mean[i])) *
                       (rows[k * c + j] - static_cast<long double>(a.mean[j]));
            }
            const double size = std::sqrt(a.covariance(i, i) * a.covariance(j, j));
            EXPECT_NEAR(a.covariance(i, j), static_cast<double>(sum / n), 1e-9 * size);
            EXPECT_EQ(a.covariance(i, j), b.covariance(i, j));
        }
    }
    const auto path = std::filesystem::temp_directory_path() / "underbody-moments-test.npy";
    write_npy(path, rows.data(), n, c);
    const Moments from_file = moments_of_file(path);
    EXPECT_EQ(from_file.count, n);
    EXPECT_EQ(from_file.covariance(8, 3), a.covariance(8, 3));
    std::filesystem::resize_file(path, 4000);
    EXPECT_THROW(moments_of_file(path), core::InputError);
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace underbody::estimator
