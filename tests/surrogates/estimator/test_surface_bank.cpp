// The bank of surfaces: the right one wins, and its probabilities are what they say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/thesis/published.h"
#include "core/random.h"
#include "surrogates/estimator/observe/surface_bank.h"

namespace underbody::estimator {
namespace {

using namespace thesis;

SeparatedPlant surface(double deeper) {
    SeparatedPlant p = reference_plant(quadratic_drag(.02, 6));
    p.ground_force = [f = p.ground_force, deeper](double h, double& slope) {
        const double value = f(h, slope);
        slope *= 1 + deeper;
        return (1 + deeper) * value;
    };
    return p;
}

std::vector<Surface> bank() { return {{"smooth", surface(0)}, {"rough", surface(0.3)}, {"rougher", surface(0.6)}}; }

// A run over a surface whose force departs from its table as the options say.
RunSignals run_over(const SeparatedPlant& plant, const FilterNoise& noise, double duration, core::Random& random) {
    RunSignals run;
    run.held = true;
    const double step = 0.04, gap = random.uniform(0.03, 0.25), size = random.uniform(0.5, 1.5),
                 beat = random.uniform(0.4, 1.2);
    double h = gap, w = 0, d = noise.departure_sigma * random.normal(), slope = 0;
    for (double t = 0; t < duration; t += step) {
        run.time.push_back(t);
        run.gap.push_back(h + noise.gap * random.normal());
        // A hand that does not know the surface: its nominal force is that of the middle one.
        const double u = -0.5 * (h - gap) - 1.0 * w - 1.3 * reference_plant().ground_force(gap, slope) +
                         0.004 * size * std::sin(beat * t);
        run.input.push_back(u);
        for (int i = 0; i < 4; ++i) {
            plant.advance(h, w, u + d, step / 4);
            d += std::sqrt(noise.force_density * step / 4) * random.normal();
        }
    }
    return run;
}

TEST(BankOfSurfaces, NamesTheSurfaceUnderTheVehicle) {
    const auto surfaces = bank();
    SurfaceOptions o;
    o.noise.departure_sigma = 3e-4;
    o.densities = usual_densities(0.02);
    core::Random random(7);
    FilterNoise truth = o.noise;
    truth.force_density = 1e-10;
    for (std::size_t s = 0; s < 3; ++s) {
        const SurfaceProbability p = identify_surface(surfaces, run_over(surfaces[s].plant, truth, 30, random), o);
        EXPECT_EQ(p.best, s);
        EXPECT_GT(p.probability[s].back(), 0.9) << surfaces[s].name;
        EXPECT_NEAR(p.probability[0][40] + p.probability[1][40] + p.probability[2][40], 1, 1e-12);
        EXPECT_NEAR(p.mean_squared_innovation, 1, 0.3);
    }
}

// Of all statements "this surface with probability p", a share p is true: over 500 runs, in ten bins, and in the
// logarithmic score.
TEST(BankOfSurfaces, IsRightAsOftenAsItSays) {
    const auto surfaces = bank();
    FilterNoise noise;
    noise.gap = 3e-4;
    noise.force_density = 1e-7;
    noise.departure_sigma = 2e-3;
    noise.gate = 0;
    SurfaceOptions o;
    o.noise = noise;
    struct Bin {
        double said = 0, spread = 0, true_ones = 0, count = 0;
    };
    std::vector<Bin> bins(10);
    double score = 0, expected = 0, spread = 0, best = 0;
    const std::size_t runs = 500;
    for (std::size_t r = 0; r < runs; ++r) {
        core::Random random(31, r);
        const std::size_t truth = random.below(3);
        const SurfaceProbability p = identify_surface(surfaces, run_over(surfaces[truth].plant, noise, 6, random), o);
        best += p.best == truth ? 1.0 / runs : 0;
        double entropy = 0, square = 0;
        for (std::size_t s = 0; s < 3; ++s) {
            const double said = p.probability[s].back(), log_said = std::log(std::max(said, 1e-12));
            Bin& bin = bins[std::min<std::size_t>(9, static_cast<std::size_t>(10 * said))];
            bin.said += said;
            bin.spread += said * (1 - said);
            bin.true_ones += s == truth ? 1 : 0;
            bin.count += 1;
            entropy += said * log_said;
            square += said * log_said * log_said;
            score += s == truth ? log_said : 0;
        }
        expected += entropy;
        spread += square - entropy * entropy;
    }
    for (const Bin& bin : bins) {
        if (bin.count >= 15) {
            EXPECT_NEAR(bin.true_ones, bin.said, 3.3 * std::sqrt(bin.spread) + 1) << bin.said / bin.count;
        }
    }
    EXPECT_NEAR(score, expected, 3.3 * std::sqrt(spread));
    // The test has teeth: neither is every run certain nor every run a guess.
    EXPECT_GT(best, 0.5);
    EXPECT_LT(best, 0.97);
}

TEST(BankOfSurfaces, WeighsHowFastTheForceWandersTogetherWithTheSurfaces) {
    const auto surfaces = bank();
    FilterNoise truth;
    truth.force_density = 1e-6;
    truth.departure_sigma = 1e-3;
    SurfaceOptions o;
    o.noise = truth;
    o.noise.force_density = 1e-12;  // what the user believes is far off; the bank weighs it
    o.densities = usual_densities(0.02);
    double ratio = 0;
    for (std::size_t r = 0; r < 20; ++r) {
        core::Random random(5, r);
        ratio +=
            std::log10(identify_surface(surfaces, run_over(surfaces[1].plant, truth, 20, random), o).force_density /
                       1e-6) /
            20;
    }
    EXPECT_NEAR(ratio, 0, 0.5);
}

TEST(BankOfSurfaces, FollowsAChangeOfTheSurface) {
    const auto surfaces = bank();
    FilterNoise noise;
    noise.force_density = 1e-10;
    noise.departure_sigma = 3e-4;
    core::Random random(3);
    RunSignals run = run_over(surfaces[0].plant, noise, 30, random);
    // The second half over another ground: the motion goes on from where it is.
    double h = run.gap.back(), w = 0, slope = 0;
    for (int k = 0; k < 750; ++k) {
        run.time.push_back(run.time.back() + 0.04);
        const double u =
            -0.5 * (h - .1) - w - 1.3 * reference_plant().ground_force(.1, slope) + 0.004 * std::sin(0.03 * k);
        run.gap.push_back(h + noise.gap * random.normal());
        run.input.push_back(u);
        surfaces[2].plant.advance(h, w, u, 0.04);
    }
    SurfaceOptions o;
    o.noise = noise;
    o.switching = 0.02;
    const SurfaceProbability p = identify_surface(surfaces, run, o);
    EXPECT_GT(p.probability[0][740], 0.9);
    EXPECT_GT(p.probability[2].back(), 0.9);
}

TEST(BankOfSurfaces, RefusesOneSurfaceAndAWrongPrior) {
    core::Random random(1);
    const RunSignals run = run_over(surface(0), {}, 2, random);
    EXPECT_THROW(identify_surface({{"smooth", surface(0)}}, run, {}), core::InputError);
    SurfaceOptions o;
    o.prior = {0.5, 0.5};
    EXPECT_THROW(identify_surface(bank(), run, o), core::InputError);
    o.prior = {0.5, 0.6, -0.1};
    EXPECT_THROW(identify_surface(bank(), run, o), core::InputError);
}

}  // namespace
}  // namespace underbody::estimator
