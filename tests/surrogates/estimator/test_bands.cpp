// Do the bands of estimated forces hold the truth as often as they say? Hundreds of short seeded runs, with the
// declared drag right and wrong by two, in still and in moving water, with damping that effects add.
#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "core/random.h"
#include "surrogates/estimator/observe/estimate.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::estimator {

namespace {

struct Truth {
    RunSignals signals;
    std::vector<double> ground, drag;
};

/// A run of the real plant under feedback that knows the declared table, pushed about the gap of 0.2 m.
Truth run_of(const SeparatedPlant& real, const SeparatedPlant& declared, std::uint64_t seed) {
    Truth s;
    core::Random random(seed);
    const double frequency = random.uniform(0.4, 1.2), phase = random.uniform(0, 6.28),
                 push = random.uniform(0.01, 0.03);
    double h = random.uniform(0.15, 0.25), w = 0, slope = 0;
    s.signals.held = true;
    for (int k = 0; k < 400; ++k) {
        const double t = 0.025 * k;
        s.ground.push_back(real.ground_force(h, slope));
        s.drag.push_back(real.drag(h, w));
        s.signals.time.push_back(t);
        s.signals.gap.push_back(h + 2e-4 * random.normal());
        const double u = -0.4 * (h - 0.2) - declared.ground_force(0.2, slope) + push * std::sin(frequency * t + phase);
        s.signals.input.push_back(u);
        real.advance(h, w, u, 0.025, t);
    }
    return s;
}

struct Coverage {
    double ground = 0, drag = 0, total = 0, width = 0;
};

/// Share of samples after the first 2 s whose truth lies in the two-sigma band.
Coverage coverage_of(const dynamics::Model& declared_model, const dynamics::Model& real_model, std::size_t runs) {
    const SeparatedPlant declared = separate(declared_model, {}), real = separate(real_model, {});
    std::vector<Truth> all(runs);
    core::parallel_for(runs, [&](std::size_t i) { all[i] = run_of(real, declared, 100 + i); });
    FilterNoise noise;
    noise.drag_relative = 0.2;
    noise.split_departure = true;
    std::vector<PlantRun> first;
    for (std::size_t i = 0; i < 6; ++i) {
        first.push_back({&declared, &all[i].signals});
    }
    noise.force_density = likely_force_density(first, noise);
    std::vector<Coverage> each(runs);
    core::parallel_for(runs, [&](std::size_t i) {
        const FilterResult r = extended_filter(declared, all[i].signals, noise);
        const std::size_t from = 80, count = r.estimates.size() - from;
        for (std::size_t k = from; k < r.estimates.size(); ++k) {
            const FilterEstimate& e = r.estimates[k];
            const double ground = all[i].ground[k], drag = all[i].drag[k], share = 1 / static_cast<double>(count);
            each[i].ground += std::abs(e.ground_force - ground) < 2 * e.ground_sigma ? share : 0;
            each[i].drag += std::abs(e.drag_force - drag) < 2 * e.drag_sigma ? share : 0;
            each[i].total += std::abs(e.total_force - ground + drag) < 2 * e.total_sigma ? share : 0;
            each[i].width += e.ground_sigma * share;
        }
    });
    Coverage mean;
    for (const Coverage& c : each) {
        const double n = static_cast<double>(runs);
        mean.ground += c.ground / n;
        mean.drag += c.drag / n;
        mean.total += c.total / n;
        mean.width += c.width / n;
    }
    return mean;
}

TEST(Bands, HoldTheTruthOverHundredsOfRunsWithTheDragRightOrWrongByTwo) {
    constexpr std::size_t runs = 240;
    for (const bool moving : {false, true}) {
        dynamics::Model declared = dynamics::test::ref_a_model(0.3, 6);
        if (moving) {
            declared = declared.with_effect(dynamics::make_use("ambient_heave_current", {{"velocity", 0.012}}))
                           .with_effect(dynamics::make_use("linear_damping", {{"coefficient", 0.2}}))
                           .with_effect(dynamics::make_use("quadratic_damping", {{"coefficient", 4}}));
        }
        double right = 0;
        for (const double factor : {1.0, 0.5, 2.0}) {
            dynamics::Model real = declared;
            real.drag_heave.linear *= factor;
            real.drag_heave.quadratic *= factor;
            const Coverage c = coverage_of(declared, real, runs);
            const std::string what = std::string("drag times ") + dynamics::test::number(factor) +
                                     (moving ? ", in a current with damping effects" : ", in still water");
            RecordProperty(what, "ground " + dynamics::test::number(c.ground) + " drag " +
                                     dynamics::test::number(c.drag) + " total " + dynamics::test::number(c.total) +
                                     " width " + dynamics::test::number(c.width));
            EXPECT_GT(c.ground, 0.98) << what << ": estimate() states this number in its explanation";
            EXPECT_GT(c.drag, 0.98) << what;
            EXPECT_GT(c.total, 0.98) << what;
            right = factor == 1.0 ? c.width : right;
            EXPECT_GE(c.width, right) << what << ": a law that is wrong shows as a wider band";
        }
        EXPECT_LT(right, 3e-3) << "and one that is right as a narrow one";
    }
}

}  // namespace

}  // namespace underbody::estimator
