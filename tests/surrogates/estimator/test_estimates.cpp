// The extended filter, what the sensors can know along the gap, the bank of surfaces, dynamic mode decomposition,
// measured runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cases/thesis/published.h"
#include "core/random.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/estimator/model/dmd.h"
#include "surrogates/estimator/model/peers.h"
#include "surrogates/estimator/model/run_data.h"
#include "surrogates/estimator/observe/estimate.h"
#include "surrogates/estimator/observe/information.h"
#include "tests/support/support.h"

namespace underbody::estimator {
namespace {

using namespace thesis;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Simulated {
    RunSignals signals;
    std::vector<double> gap, velocity, ground, drag;
};

Simulated simulate(const SeparatedPlant& plant, double gap, double duration, double step, double noise,
                   std::uint64_t seed) {
    Simulated s;
    core::Random random(seed);
    double h = gap, w = 0, slope = 0;
    s.signals.held = true;
    for (double t = 0; t < duration; t += step) {
        s.gap.push_back(h);
        s.velocity.push_back(w);
        s.ground.push_back(plant.ground_force(h, slope));
        s.drag.push_back(plant.drag(h, w));
        s.signals.time.push_back(t);
        s.signals.gap.push_back(h + noise * random.normal());
        const double u =
            -0.05 * (h - gap) - 0.3 * w - plant.ground_force(gap, slope) - plant.bias + 0.004 * std::sin(0.7 * t);
        s.signals.input.push_back(u);
        plant.advance(h, w, u, step);
    }
    return s;
}

TEST(ExtendedFilter, FindsTheForcesFromTheGapAlone) {
    const SeparatedPlant plant = reference_plant(quadratic_drag(.02, 6));
    const Simulated s = simulate(plant, 0.2, 30, 0.02, 2e-4, 1);
    FilterNoise noise;
    noise.force_density = 1e-9;
    const FilterResult r = extended_filter(plant, s.signals, noise);
    EXPECT_NEAR(r.mean_squared_innovation, 1, 0.15);
    EXPECT_LT(std::abs(r.innovation_correlation), 0.12);
    double square = 0;
    for (std::size_t k = 500; k < s.gap.size(); ++k) {
        square += std::pow(r.estimates[k].total_force - (s.ground[k] - s.drag[k]), 2);
    }
    EXPECT_LT(std::sqrt(square / static_cast<double>(s.gap.size() - 500)), 4e-4);
    const FilterResult smooth = extended_filter(plant, s.signals, noise, true);
    double filtered = 0, smoothed = 0;
    for (std::size_t k = 200; k + 200 < s.gap.size(); ++k) {
        filtered += std::pow(r.estimates[k].velocity - s.velocity[k], 2);
        smoothed += std::pow(smooth.estimates[k].velocity - s.velocity[k], 2);
    }
    EXPECT_LT(smoothed, 0.6 * filtered);
}

TEST(ExtendedFilter, FindsADepartureFromTheTable) {
    const SeparatedPlant declared = reference_plant();
    SeparatedPlant real = declared;
    real.ground_force = [f = declared.ground_force](double h, double& slope) { return f(h, slope) + 0.003; };
    const Simulated s = simulate(real, 0.2, 40, 0.02, 2e-4, 2);
    FilterNoise noise;
    noise.force_density = likely_force_density({{&declared, &s.signals}}, noise);
    const FilterResult r = extended_filter(declared, s.signals, noise);
    double mean = 0;
    for (std::size_t k = s.gap.size() - 500; k < s.gap.size(); ++k) {
        mean += r.estimates[k].departure / 500;
    }
    EXPECT_NEAR(mean, 0.003, 3e-4);
}

TEST(ExtendedFilter, BridgesMissingValuesGapsInTimeAndOutliers) {
    const SeparatedPlant plant = reference_plant();
    Simulated s = simulate(plant, 0.2, 30, 0.02, 2e-4, 3);
    for (std::size_t k = 300; k < 340; ++k) {
        s.signals.gap[k] = nan;
    }
    s.signals.gap[700] += 0.05;
    s.signals.gap[900] -= 0.02;
    Simulated cut = s;
    const auto erase = [](std::vector<double>& v) { v.erase(v.begin() + 1000, v.begin() + 1060); };
    erase(cut.signals.time);
    erase(cut.signals.gap);
    erase(cut.signals.input);
    FilterNoise noise;
    noise.force_density = 1e-8;
    const FilterResult r = extended_filter(plant, cut.signals, noise);
    EXPECT_EQ(r.outliers, 2U);
    EXPECT_EQ(r.missing, 40U);
    EXPECT_GT(r.estimates[339].gap_sigma, 1.3 * r.estimates[299].gap_sigma);
    EXPECT_NEAR(r.estimates.back().gap, s.gap.back(), 6 * r.estimates.back().gap_sigma);
    const UniformRun u = uniform(cut.signals, 0.02);
    EXPECT_EQ(u.outliers, 2U);
    EXPECT_EQ(u.gaps, 2U);
    Simulated bad = s;
    bad.signals.time[5] = bad.signals.time[4];
    EXPECT_THROW(extended_filter(plant, bad.signals, noise), core::InputError);
    bad.signals.input[9] = nan;
    EXPECT_THROW(extended_filter(plant, bad.signals, noise), core::InputError);
}

TEST(ExtendedFilter, ItsSeparateBandsHoldTheTruthWhateverOfTheDeclaredLawsIsWrong) {
    const SeparatedPlant declared = reference_plant(quadratic_drag(.3, 6));
    struct Wrong {
        const char* what;
        double drag, ground;
    };
    for (const Wrong& wrong : {Wrong{"nothing", 1, 1}, Wrong{"drag halved", .5, 1}, Wrong{"drag doubled", 2, 1},
                               Wrong{"drag threefold", 3, 1}, Wrong{"table a third too small", 1, 1.33}}) {
        SeparatedPlant real = reference_plant(quadratic_drag(.3 * wrong.drag, 6 * wrong.drag));
        real.ground_force = [f = declared.ground_force, k = wrong.ground](double h, double& slope) {
            const double force = k * f(h, slope);
            slope *= k;
            return force;
        };
        double ground = 0, drag = 0, total = 0, n = 0, width = 0;
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            Simulated s;
            core::Random random(seed);
            double h = .2, w = 0, slope = 0;
            s.signals.held = true;
            for (double t = 0; t < 40; t += .02) {
                s.gap.push_back(h);
                s.ground.push_back(real.ground_force(h, slope));
                s.drag.push_back(real.drag(h, w));
                s.signals.time.push_back(t);
                s.signals.gap.push_back(h + 2e-4 * random.normal());
                const double u = -.4 * (h - .2) - declared.ground_force(.2, slope) +
                                 .02 * std::sin(.5 * t + static_cast<double>(seed));
                s.signals.input.push_back(u);
                real.advance(h, w, u, .02);
            }
            FilterNoise noise;
            noise.drag_relative = .2;
            noise.split_departure = true;
            noise.force_density = likely_force_density({{&declared, &s.signals}}, noise);
            const FilterResult r = extended_filter(declared, s.signals, noise);
            for (std::size_t k = 250; k < s.gap.size(); ++k) {
                const FilterEstimate& e = r.estimates[k];
                ground += std::abs(e.ground_force - s.ground[k]) < 2 * e.ground_sigma ? 1 : 0;
                drag += std::abs(e.drag_force - s.drag[k]) < 2 * e.drag_sigma ? 1 : 0;
                total += std::abs(e.total_force - s.ground[k] + s.drag[k]) < 2 * e.total_sigma ? 1 : 0;
                width += e.ground_sigma;
                n += 1;
            }
        }
        EXPECT_GT(ground / n, .85) << wrong.what;
        EXPECT_GT(drag / n, .85) << wrong.what;
        EXPECT_GT(total / n, .8) << wrong.what;
        if (wrong.drag == 1 && wrong.ground == 1) {
            EXPECT_LT(width / n, 3e-3) << "bands are no wider than they need be where nothing is wrong";
        }
    }
}

TEST(ExtendedFilter, CoversTheTruthAsOftenAsItSays) {
    const SeparatedPlant plant = reference_plant(quadratic_drag(.02, 6));
    ConsistencyOptions o;
    o.noise.force_density = 1e-7;
    o.gaps = {0.03, 0.2, 0.6};
    o.speeds = {0, 0.02};
    o.seed = 5;
    const Consistency c = consistency_along_gap(plant, o);
    ASSERT_EQ(c.nees.size(), 6U);
    for (std::size_t i = 0; i < c.nees.size(); ++i) {
        EXPECT_GT(c.nees[i], 3 - 1.5 * (c.upper - 3)) << i;
        EXPECT_LT(c.nees[i], 3 + 1.5 * (c.upper - 3)) << i;
        EXPECT_GT(c.coverage[i], 0.85);
        EXPECT_NEAR(c.innovation[i], 1, 0.05);
    }
}

TEST(InformationAlongTheGap, BoundsTheFilterAndGrowsWithTheNoise) {
    const SeparatedPlant plant = reference_plant(quadratic_drag(.02, 6));
    InformationOptions o;
    o.gaps = {0.03, 0.1, 0.3, 0.8};
    o.speeds = {0, 0.01, 0.03};
    o.noise.force_density = 1e-8;
    const InformationMap fine = information_along_gap(plant, o);
    o.noise.gap *= 10;
    const InformationMap coarse = information_along_gap(plant, o);
    o.noise.gap /= 10;
    o.drag_prior = 0;
    const InformationMap known = information_along_gap(plant, o);
    for (std::size_t i = 0; i < fine.total_sigma.size(); ++i) {
        EXPECT_LT(fine.total_sigma[i], coarse.total_sigma[i]);
        // A drag law that is not trusted costs the ground force once the body moves, and nothing at rest.
        EXPECT_GT(fine.ground_sigma[i], known.ground_sigma[i] * (i < 4 ? 1 - 1e-9 : 1.0001));
        EXPECT_LT(fine.ground_sigma[i], known.ground_sigma[i] * (i < 4 ? 1 + 1e-9 : 10));
    }
    EXPECT_GE(coarse.blind_share, fine.blind_share);
    const auto seen = observability_along_gap(plant, {0.05, 0.4, 1.0});
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_GT(seen.smallest_singular_value[i], 1e-6);
        EXPECT_EQ(seen.separate_rank[i], 1U);
    }
}

TEST(DynamicModeDecomposition, IsExactOnALinearPlant) {
    SeparatedPlant plant = reference_plant(quadratic_drag(1.25, 0));
    plant.ground_force = [](double h, double& slope) {
        slope = -0.4;
        return -0.4 * h;
    };
    plant.bias = 0.003;
    TrainingOptions o;
    o.auxiliaries = {};
    o.samples = 2000;
    const AugmentedModel m = learn_dmd(snapshot_pairs(plant, o, 0.1));
    const double s = 1 / plant.virtual_mass;
    EXPECT_NEAR(m.A(0, 0), -1.25 * s, 1e-6);
    EXPECT_NEAR(m.A(0, 1), -0.4 * s, 1e-6);
    EXPECT_NEAR(m.A(1, 0), 1, 1e-6);
    EXPECT_NEAR(m.B(0, 0), s, 1e-6);
    EXPECT_NEAR(m.offset[0], 0.003 * s, 1e-7);
    PredictionTest test;
    test.runs = 5;
    test.gap_lower = -.1;
    test.gap_upper = .1;
    for (const auto& e : compare_predictions(plant, {{"dmdc", m}}, test_motions(plant, test))) {
        EXPECT_LT(e.gap, 1e-4) << e.model;
    }
}

// Its error of the acceleration was that of a mass which does not grow toward the ground, without waves.
TEST(Predictions, ThePlantHasNoErrorWhereItsMassGrowsTowardTheGround) {
    SeparatedPlant plant = reference_plant();
    plant.inertia = [mass = plant.virtual_mass](double gap) {
        const double growth = std::exp(-gap / 0.1);
        return dynamics::HeaveInertia{mass * (1 + growth), -10 * mass * growth, 100 * mass * growth};
    };
    plant.other_force = [](double, double, double velocity, double) {
        dynamics::HeaveLoad load;
        load.force = -0.2 * velocity;
        load.slope_w = -0.2;
        return load;
    };
    PredictionTest test;
    test.gap_lower = 0.01;
    test.gap_upper = 0.3;
    test.horizon = 2;
    test.runs = 5;
    const auto errors = compare_predictions(plant, {}, test_motions(plant, test));
    EXPECT_LT(errors.back().acceleration, 1e-12) << errors.back().model;
    EXPECT_LT(errors.back().gap, 1e-12);
}

// What the sensors can know, and the plant's own linearisation, were those of the mass far from the ground.
TEST(InformationAlongTheGap, IsThatOfTheMassAtTheGap) {
    SeparatedPlant grown = reference_plant(quadratic_drag(.02, 6)), heavy = grown;
    grown.inertia = [mass = grown.virtual_mass](double) { return dynamics::HeaveInertia{3 * mass, 0, 0}; };
    heavy.virtual_mass *= 3;
    InformationOptions o;
    o.gaps = {0.03, 0.3};
    o.speeds = {0, 0.03};
    o.noise.force_density = 1e-8;
    const InformationMap a = information_along_gap(grown, o), b = information_along_gap(heavy, o);
    for (std::size_t i = 0; i < a.total_sigma.size(); ++i) {
        EXPECT_NEAR(a.total_sigma[i], b.total_sigma[i], 1e-12 * b.total_sigma[i]) << i;
        EXPECT_NEAR(a.ground_sigma[i], b.ground_sigma[i], 1e-12 * b.ground_sigma[i]) << i;
    }
    EXPECT_DOUBLE_EQ(observability_along_gap(grown, {0.05}).smallest_singular_value[0],
                     observability_along_gap(heavy, {0.05}).smallest_singular_value[0]);
    EXPECT_DOUBLE_EQ(frozen_model(grown, 0.1, 0.01).A(0, 2), 1 / heavy.virtual_mass);
    EXPECT_DOUBLE_EQ(equivalent_model(grown, 0.1, 0.01, MotionShape::gaussian).A(0, 0),
                     equivalent_model(heavy, 0.1, 0.01, MotionShape::gaussian).A(0, 0));
}

TEST(DynamicModeDecomposition, PredictsBetterWithADictionary) {
    const SeparatedPlant plant = reference_plant();
    TrainingOptions o;
    o.samples = 8000;
    o.gap_upper = 0.3;
    o.auxiliaries = {};
    const AugmentedModel plain = learn_dmd(snapshot_pairs(plant, o, 0.1));
    o.auxiliaries = {"ground_force", "velocity_squared", "gap_squared", "gap_cubed"};
    const AugmentedModel lifted = learn_dmd(snapshot_pairs(plant, o, 0.1));
    PredictionTest test;
    test.gap_upper = 0.3;
    test.horizon = 2;
    const auto errors = compare_predictions(plant, {{"dmdc", plain}, {"edmdc", lifted}}, test_motions(plant, test));
    ASSERT_EQ(errors.size(), 5U);
    EXPECT_LT(errors[3].acceleration, errors[2].acceleration);
    EXPECT_LT(errors[3].gap, errors[2].gap);
    // The plant predicts its own motions.
    EXPECT_LT(errors[4].gap, 1e-12);
    EXPECT_LT(errors[4].acceleration, 1e-12);
    EXPECT_LT(errors[4].total_rate, 1e-12);
}

// Missing velocities: the slope of the gap over half a second, not that of two neighbours.
TEST(UniformRuns, BridgeMissingVelocitiesQuietly) {
    core::Random random(4);
    RunSignals run;
    for (int k = 0; k < 1000; ++k) {
        const double t = 0.02 * k;
        run.time.push_back(t);
        run.gap.push_back(0.2 + 0.02 * std::sin(t) + 2e-4 * random.normal());
        run.velocity.push_back(k >= 400 && k < 600 ? nan : 0.02 * std::cos(t));
    }
    const UniformRun u = uniform(run, 0.02);
    EXPECT_NEAR(static_cast<double>(u.bridged), 200, 2);
    for (std::size_t k = 0; k < u.time.size(); ++k) {
        ASSERT_NEAR(u.velocity[k], 0.02 * std::cos(u.time[k]), 2e-3) << k;
    }
}

class ExampleRuns : public ::testing::Test {
protected:
    std::filesystem::path folder() const { return test::shared_folder() / "examples/loop/example-00"; }
};

TEST_F(ExampleRuns, AreEstimatedByEveryObserverThatTheDataAllow) {
    UNDERBODY_NEEDS_SHARED("examples/loop/example-00/model.toml");
    const dynamics::Model model = dynamics::read_model(folder() / "model.toml");
    const dynamics::Measurements data = dynamics::read_measurements(folder());
    for (const char* observer : {"extended", "kalman", "full", "latent"}) {
        EstimateOptions o;
        o.observer = observer;
        const Estimation e = estimate(model, data, o);
        EXPECT_EQ(e.runs.size(), data.runs.size()) << observer;
        EXPECT_GT(e.table.rows(), 1000U);
        const auto& gap = e.table.numbers("gap");
        EXPECT_TRUE(std::all_of(gap.begin(), gap.end(), [](double v) { return std::abs(v) < 5; })) << observer;
    }
    // The steady-state filter takes what its linear law misses for noise, and so states its innovations truly.
    EstimateOptions kalman;
    kalman.observer = "kalman";
    for (const auto& r : estimate(model, data, kalman).runs) {
        EXPECT_GT(r.mean_squared_innovation, 0.5) << r.name;
        EXPECT_LT(r.mean_squared_innovation, 2) << r.name;
    }
    EstimateOptions reduced;
    reduced.observer = "reduced";
    try {
        estimate(model, data, reduced);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_NE(error.hint().find("extended, kalman or full"), std::string::npos);
    }
    const TrainingSet set = training_from_runs(model, data, {"ground_force", "drag_force"});
    const AugmentedModel learned = learn(moments(set.view()), set.layout);
    EXPECT_NEAR(learned.A(0, 2), 1 / model.heave_mass(), 1e-6);
}

}  // namespace
}  // namespace underbody::estimator
