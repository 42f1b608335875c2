// Surrogates over shapes, plans, the next case, the best design.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/normal.h"
#include "core/random.h"
#include "surrogates/tables/search/acquisition.h"
#include "surrogates/tables/search/design_search.h"
#include "surrogates/tables/search/sampling.h"
#include "surrogates/tables/search/sensitivity.h"
#include "surrogates/tables/search/surrogate.h"
#include "tests/surrogates/tables/discrepancy.h"

namespace {

using namespace underbody;
using namespace underbody::tables;
using std::numbers::pi;

/// Branin and Hoo 1972: minimum 0.397887 at (-pi, 12.275), (pi, 2.275), (9.42478, 2.475).
double branin(double x, double y) {
    return std::pow(y - 5.1 / (4 * pi * pi) * x * x + 5 / pi * x - 6, 2) + 10 * (1 - 1 / (8 * pi)) * std::cos(x) + 10;
}

/// Forrester, Sobester and Keane 2007: the dear function and the cheap one.
double forrester(double x) { return std::pow(6 * x - 2, 2) * std::sin(12 * x - 4); }
double forrester_cheap(double x) { return 0.5 * forrester(x) + 10 * (x - 0.5) - 5; }

GaussianProcess a_process(std::size_t n, std::size_t axes, std::uint64_t seed) {
    core::Random random(seed);
    GpData data;
    data.axes = axes;
    data.trends = axes + 1;
    data.trend_variance = 1;
    for (std::size_t i = 0; i < n; ++i) {
        data.trend.push_back(3);
        double sum = 0;
        for (std::size_t a = 0; a < axes; ++a) {
            data.x.push_back(random.uniform());
            data.trend.push_back(data.x.back() - 0.5);
            sum += std::sin(3 * data.x.back() + static_cast<double>(a));
        }
        data.y.push_back(sum);
        data.noise.push_back(1e-4);
    }
    GpParameters p;
    p.length.assign(axes, 0.5);
    return {data, Kernel::matern52, p};
}

TEST(Search, APredictionHasTheMeanTheVarianceAndTheirSlopes) {
    for (const std::size_t axes : {1, 3, 8}) {
        const GaussianProcess gp = a_process(60, axes, axes);
        core::Random random(17);
        for (int trial = 0; trial < 20; ++trial) {
            std::vector<double> x, h = {3}, dh((axes + 1) * axes, 0.0);
            for (std::size_t a = 0; a < axes; ++a) {
                x.push_back(random.uniform());
                h.push_back(x.back() - 0.5);
                dh[(a + 1) * axes + a] = 1;
            }
            const GpPrediction p = gp.predict(x, h, dh);
            EXPECT_NEAR(p.mean, gp.mean(x, h), 1e-9);
            EXPECT_NEAR(p.variance, gp.variance(x, h), 1e-9);
            EXPECT_NEAR(gp.covariance(x, h)[0], p.variance, 1e-9);
            for (std::size_t a = 0; a < axes; ++a) {
                constexpr double step = 1e-5;
                auto above = x, below = x, h_above = h, h_below = h;
                above[a] += step, h_above[a + 1] += step;
                below[a] -= step, h_below[a + 1] -= step;
                EXPECT_NEAR(p.mean_slope[a], (gp.mean(above, h_above) - gp.mean(below, h_below)) / (2 * step),
                            1e-5 * (1 + std::abs(p.mean_slope[a])));
                EXPECT_NEAR(p.variance_slope[a],
                            (gp.variance(above, h_above) - gp.variance(below, h_below)) / (2 * step),
                            1e-5 * (1 + std::abs(p.variance_slope[a])));
            }
        }
    }
}

TEST(Search, CheapRunsSaveDearOnes) {
    FidelityRuns cheap, dear;
    for (int i = 0; i <= 10; ++i) {
        cheap.x.push_back(0.1 * i);
        cheap.y.push_back(forrester_cheap(0.1 * i) / 6);
    }
    for (const double x : {0.0, 0.4, 0.6, 1.0}) {
        dear.x.push_back(x);
        dear.y.push_back(forrester(x) / 6);
    }
    const MultiFidelity both = MultiFidelity::fit({cheap, dear}, 1);
    const MultiFidelity alone = MultiFidelity::fit({dear}, 1);
    double both_error = 0, alone_error = 0;
    for (int i = 0; i <= 100; ++i) {
        const std::vector<double> x = {0.01 * i};
        both_error += std::pow(both.at(x).mean - forrester(x[0]) / 6, 2) / 101;
        alone_error += std::pow(alone.at(x).mean - forrester(x[0]) / 6, 2) / 101;
        EXPECT_LE(std::abs(both.at(x).mean - forrester(x[0]) / 6), 4 * std::sqrt(both.at(x).variance) + 0.03);
    }
    EXPECT_LT(std::sqrt(both_error), 0.4 * std::sqrt(alone_error));
    // At the dear runs there is nothing left to know, and more runs there tell nothing.
    EXPECT_NEAR(both.at(std::vector<double>{0.6}).mean, forrester(0.6) / 6, 0.02);
    const std::vector<double> open = {0.75};
    EXPECT_LT(both.variance_after(open, open, 1), 0.05 * both.at(open).variance);
    EXPECT_LE(both.variance_after(open, std::vector<double>{0.6}, 1), both.at(open).variance);
}

TEST(Search, SlopesGoThroughTheFidelities) {
    FidelityRuns cheap, dear;
    const Plan plan = sobol_plan(30, 2, 5);
    for (std::size_t i = 0; i < plan.size(); ++i) {
        FidelityRuns& runs = i % 3 == 0 ? dear : cheap;
        runs.x.insert(runs.x.end(), plan[i].begin(), plan[i].end());
        runs.y.push_back(std::sin(4 * plan[i][0]) + plan[i][1] * plan[i][1] + (i % 3 == 0 ? 0.2 * plan[i][0] : 0));
    }
    const MultiFidelity process = MultiFidelity::fit({cheap, dear}, 2);
    for (const std::vector<double>& x : sobol_plan(10, 2, 6)) {
        const GpPrediction p = process.at(x, true);
        for (std::size_t a = 0; a < 2; ++a) {
            auto above = x, below = x;
            above[a] += 1e-5, below[a] -= 1e-5;
            EXPECT_NEAR(p.mean_slope[a], (process.at(above).mean - process.at(below).mean) / 2e-5,
                        1e-4 * (1 + std::abs(p.mean_slope[a])));
            EXPECT_NEAR(p.variance_slope[a], (process.at(above).variance - process.at(below).variance) / 2e-5,
                        1e-4 * (1 + std::abs(p.variance_slope[a])));
        }
    }
}

std::vector<SearchVariable> four_variables() {
    return {{"protrusion.height", "m", 0, 0.01},
            {"body.base_cut", "m", 0.01, 0.03},
            {"gap", "m", 1e-3, 1e-2, true, false},
            {"pitch", "rad", -0.05, 0.05, false, false}};
}

/// A lift that falls with the gap and hangs on the shape, smooth as CFD forces are.
double lift(const std::vector<double>& x, double a, double b) {
    const double film = std::pow(x[2] / 1e-3, -0.6);
    return film * (1 + a * std::sin(200 * x[0]) + 20 * x[1]) + 8 * x[3] * (1 - 30 * x[1] + b * 40 * x[0]) * film;
}

TEST(Search, ErrorsHoldOnShapesThatWereLeftOut) {
    std::size_t inside = 0, points = 0;
    double own = 0, nearest = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        core::Random random(seed);
        const double a = random.uniform(0.2, 0.8), b = random.uniform(-1, 1);
        const auto variables = four_variables();
        std::vector<SearchRun> runs;
        const Plan shapes = sobol_plan(24 + 40, 2, seed);
        for (std::size_t s = 0; s < 24; ++s) {
            for (const double gap : {1e-3, 3e-3, 1e-2}) {
                for (const double pitch : {-0.03, 0.03}) {
                    SearchRun run;
                    run.at = {variables[0].unscaled(shapes[s][0]), variables[1].unscaled(shapes[s][1]), gap, pitch};
                    run.value = lift(run.at, a, b) * (1 + 0.002 * random.normal());
                    run.sigma = 0.002 * std::abs(run.value);
                    runs.push_back(run);
                }
            }
        }
        const Surrogate surrogate = Surrogate::fit("lift_force", "N", variables, runs);
        EXPECT_EQ(surrogate.check().shapes, 24u);
        EXPECT_EQ(surrogate.check().points, 144u);
        EXPECT_LT(surrogate.check().root_mean_square, 0.5 * surrogate.check().nearest_shape);
        EXPECT_GE(surrogate.check().inside_95, 0.88);
        const double share = surrogate.check().inside_95;
        for (const double end : {surrogate.check().inside_lower, surrogate.check().inside_upper}) {
            // Wilson: the share whose own spread over 24 shapes reaches what was seen.
            EXPECT_NEAR(std::abs(end - share), core::sigmas_of_95 * std::sqrt(end * (1 - end) / 24), 1e-9);
        }
        for (std::size_t s = 24; s < shapes.size(); ++s) {  // fresh shapes, at gaps and pitches between
            const std::vector<double> x = {variables[0].unscaled(shapes[s][0]), variables[1].unscaled(shapes[s][1]),
                                           random.uniform(1.2e-3, 9e-3), random.uniform(-0.03, 0.03)};
            const SurrogatePrediction p = surrogate.at(x);
            inside += std::abs(p.value - lift(x, a, b)) <= 1.96 * p.sigma ? 1 : 0;
            ++points;
        }
        own += surrogate.check().root_mean_square;
        nearest += surrogate.check().nearest_shape;
    }
    EXPECT_LT(own, 0.5 * nearest);
    EXPECT_GE(static_cast<double>(inside) / static_cast<double>(points), 0.90);
}

TEST(Search, EveryShapeIsCheckedWhateverItsFidelity) {
    const std::vector<SearchVariable> variables = {{"protrusion.height", "m", 0, 1, false, true},
                                                   {"gap", "m", 0, 1, false, false}};
    core::Random random(5);
    std::vector<SearchRun> runs;
    for (int shape = 0; shape < 20; ++shape) {
        const double a = random.uniform();
        for (const double gap : {0.0, 0.5, 1.0}) {
            const auto value = [&](double x) { return std::sin(3 * x) + gap * x; };
            runs.push_back({{a, gap}, 0, value(a) + 0.05, 1e-3});
            if (shape == 7) {  // the one that was refined
                runs.push_back({{a, gap}, 1, value(a), 1e-3});
            }
        }
    }
    const LeftOutCheck check = Surrogate::fit("lift_force", "N", variables, runs).check();
    EXPECT_EQ(check.shapes, 20u);
    EXPECT_EQ(check.shapes_of_best, 1u);
    EXPECT_EQ(check.points, 60u);
    EXPECT_LT(check.root_mean_square, 0.5 * check.nearest_shape);
    EXPECT_TRUE(std::isfinite(check.nearest_shape));
    EXPECT_GT(check.inside_lower, 0.7);
}

TEST(Search, RunsThatTeachNothingAreRefused) {
    const auto variables = four_variables();
    EXPECT_THROW(Surrogate::fit("lift_force", "N", variables, {}), core::InputError);
    std::vector<SearchRun> runs(5, SearchRun{{0.005, 0.02, 2e-3, 0}, 0, 1, 0});
    try {
        Surrogate::fit("lift_force", "N", variables, runs);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("protrusion.height has the same value in all runs"));
    }
    runs[2].value = std::nan("");
    EXPECT_THROW(Surrogate::fit("lift_force", "N", variables, runs), core::InputError);
}

TEST(Search, ExpectedImprovementIsItsIntegral) {
    for (const double z : {-6.0, -2.0, -0.3, 0.0, 0.7, 3.0}) {
        const double mean = 1.3, sigma = 0.4, best = mean + z * sigma;
        double integral = 0;
        constexpr int n = 200000;
        for (int i = 0; i < n; ++i) {  // over 0 .. 12 sigmas of improvement
            const double t = (i + 0.5) * 12 / n;
            integral += t * std::exp(-0.5 * (z - t) * (z - t)) / std::sqrt(2 * pi) * 12 / n;
        }
        const LogImprovement e = log_expected_improvement(mean, sigma, best);
        EXPECT_NEAR(e.value, std::log(sigma * integral), 1e-6) << z;
    }
    for (const double z : {-200.0, -26.0, -25.0, -24.0, -5.0, 1.0}) {
        constexpr double step = 1e-6;
        const LogImprovement e = log_expected_improvement(0, 1, z);
        EXPECT_NEAR(
            e.by_mean,
            (log_expected_improvement(step, 1, z).value - log_expected_improvement(-step, 1, z).value) / (2 * step),
            1e-4 * std::abs(e.by_mean))
            << z;
        EXPECT_NEAR(e.by_sigma,
                    (log_expected_improvement(0, 1 + step, z).value - log_expected_improvement(0, 1 - step, z).value) /
                        (2 * step),
                    1e-4 * (1 + std::abs(e.by_sigma)))
            << z;
        const LogChance c = log_chance_below(0, 1, z);
        EXPECT_NEAR(c.by_mean, (log_chance_below(step, 1, z).value - log_chance_below(-step, 1, z).value) / (2 * step),
                    1e-4 * (1e-3 + std::abs(c.by_mean)))
            << z;
    }
    // No step where the series takes over.
    EXPECT_NEAR(log_expected_improvement(0, 1, -25 - 1e-9).value, log_expected_improvement(0, 1, -25 + 1e-9).value,
                1e-6);
}

TEST(Search, PlansFillTheCube) {
    const Plan latin = latin_hypercube(17, 5, 3);
    for (std::size_t a = 0; a < 5; ++a) {
        std::vector<int> slices(17, 0);
        for (const auto& point : latin) {
            ++slices.at(static_cast<std::size_t>(17 * point[a]));
        }
        EXPECT_THAT(slices, testing::Each(1));
    }
    const Plan whole = sobol_plan(96, 4, 9), rest = sobol_plan(32, 4, 9, 64);
    EXPECT_EQ(Plan(whole.begin() + 64, whole.end()), rest);
    core::Random random(4);
    Plan scattered(96, std::vector<double>(4));
    for (auto& point : scattered) {
        for (double& c : point) {
            c = random.uniform();
        }
    }
    EXPECT_LT(test::discrepancy(whole), 0.5 * test::discrepancy(scattered));
}

TEST(Search, SensitivitiesOfIshigamisFunction) {
    const auto f = [](std::span<const double> u) {
        const double x = pi * (2 * u[0] - 1), y = pi * (2 * u[1] - 1), z = pi * (2 * u[2] - 1);
        return std::sin(x) + 7 * std::pow(std::sin(y), 2) + 0.1 * std::pow(z, 4) * std::sin(x);
    };
    // Ishigami and Homma 1990, in closed form.
    const double v1 = 0.5 * std::pow(1 + 0.1 * std::pow(pi, 4) / 5, 2), v2 = 49.0 / 8;
    const double v13 = 0.01 * std::pow(pi, 8) * (1.0 / 18 - 1.0 / 50), v = v1 + v2 + v13;
    const SobolIndices s = sobol_indices(f, 3, 4096, 1);
    EXPECT_NEAR(s.variance, v, 0.02 * v);
    EXPECT_NEAR(s.first[0].value, v1 / v, 0.02);
    EXPECT_NEAR(s.first[1].value, v2 / v, 0.02);
    EXPECT_NEAR(s.first[2].value, 0, 0.02);
    EXPECT_NEAR(s.total[0].value, (v1 + v13) / v, 0.02);
    EXPECT_NEAR(s.total[2].value, v13 / v, 0.02);
    for (const SobolIndex& i : s.total) {
        EXPECT_LE(i.lower, i.value);
        EXPECT_GE(i.upper, i.value);
    }
    const SobolIndices constant = sobol_indices([](std::span<const double>) { return 3.0; }, 2, 64, 1);
    EXPECT_EQ(constant.total[0].value, 0);
}

/// A surrogate of Branin's function, over its two variables.
Surrogate of_branin(std::size_t count, std::uint64_t seed) {
    std::vector<SearchVariable> variables = {{"x", "1", -5, 10}, {"y", "1", 0, 15}};
    std::vector<SearchRun> runs;
    for (const auto& u : sobol_plan(count, 2, seed)) {
        const std::vector<double> x = {variables[0].unscaled(u[0]), variables[1].unscaled(u[1])};
        runs.push_back({x, 0, branin(x[0], x[1]), 0});
    }
    return Surrogate::fit("f", "1", variables, runs);
}

SearchProblem smallest_f() {
    SearchProblem problem;
    problem.variables = {{"x", "1", -5, 10}, {"y", "1", 0, 15}};
    problem.objectives = {{{"f", "f", {}, "", 0}, Objective::Sense::minimise, 0}};
    return problem;
}

TEST(Search, TheBestOfAKnownFunctionIsFound) {
    const DesignSearch search(smallest_f(), {{"f", of_branin(60, 2)}});
    const auto best = search.optimum(0, 1);
    ASSERT_TRUE(best);
    EXPECT_NEAR(branin(best->at[0], best->at[1]), 0.397887, 0.05);
}

TEST(Search, LimitsHoldAtTheBest) {
    SearchProblem problem = smallest_f();
    problem.limits = {{{"f", "f", {}, "", 0}, 5, 1e300}};
    problem.known_limits = {[](std::span<const double> x) { return 3 - x[0]; }};  // x >= 3
    const DesignSearch search(problem, {{"f", of_branin(60, 2)}});
    const auto best = search.optimum(1, 1);
    ASSERT_TRUE(best);
    EXPECT_GE(best->at[0], 3 - 1e-6);
    EXPECT_GE(best->limits[0].value - best->limits[0].sigma, 5 - 1e-4);
    EXPECT_NEAR(best->objectives[0].value, 5, 0.5);
    SearchProblem impossible = problem;
    impossible.known_limits.push_back([](std::span<const double> x) { return x[0] - 2; });
    EXPECT_FALSE(DesignSearch(impossible, {{"f", of_branin(60, 2)}}).optimum(0, 1));
    EXPECT_TRUE(DesignSearch(impossible, {{"f", of_branin(30, 2)}}).next_designs({}).empty());
}

// Two minutes passed without a word.
TEST(Search, ASearchSaysHowFarItIsAndIsCancelledAtOnce) {
    SearchProblem problem = smallest_f();
    problem.known_limits = {[](std::span<const double> x) { return 3 - x[0]; }};
    const DesignSearch search(problem, {{"f", of_branin(30, 2)}});
    std::vector<std::pair<double, std::string>> said;
    core::Progress progress([&](double fraction, const std::string& what) { said.emplace_back(fraction, what); });
    ASSERT_TRUE(search.optimum(0, 1, progress));
    ASSERT_GT(said.size(), 100U);
    EXPECT_TRUE(
        std::is_sorted(said.begin(), said.end(), [](const auto& a, const auto& b) { return a.first < b.first; }));
    EXPECT_EQ(said.front(), std::pair(0.0, std::string("designs looked at: 0 of 500")));
    EXPECT_EQ(said.back().first, 1);
    EXPECT_TRUE(std::any_of(said.begin(), said.end(), [](const auto& one) {
        return one.second == "starts followed to their best design: 9 of 10";
    }));
    int asked = 0;
    core::Progress stopped([&](double, const std::string&) {
        if (++asked == 505) {  // while the fifth start is followed
            stopped.cancel();
        }
    });
    EXPECT_THROW(search.optimum(0, 1, stopped), core::Cancelled);
    EXPECT_LE(asked, 506);
}

TEST(Search, RunByRunTheSearchFindsTheMinimum) {
    SearchProblem problem = smallest_f();
    std::vector<SearchRun> runs;
    DesignSearch::NextOptions options;
    double best = 1e300;
    const auto run = [&](const std::vector<double>& x) {
        runs.push_back({x, 0, branin(x[0], x[1]), 0});
        options.solved.push_back(x);
        best = std::min(best, runs.back().value);
    };
    for (const auto& u : sobol_plan(10, 2, 3)) {
        run({problem.variables[0].unscaled(u[0]), problem.variables[1].unscaled(u[1])});
    }
    for (int step = 0; step < 20 && best > 0.40; ++step) {
        const DesignSearch search(problem, {{"f", Surrogate::fit("f", "1", problem.variables, runs)}});
        const auto next = search.next_designs(options);
        ASSERT_EQ(next.size(), 1u);
        run(next.front().at);
    }
    EXPECT_LT(best, 0.42) << runs.size() << " runs";
    EXPECT_LE(runs.size(), 30u);
}

TEST(Search, ABatchIsSpreadAndFailuresAreShunned) {
    const DesignSearch search(smallest_f(), {{"f", of_branin(15, 4)}});
    DesignSearch::NextOptions options;
    options.count = 4;
    for (const auto& u : sobol_plan(15, 2, 4)) {
        options.solved.push_back({-5 + 15 * u[0], 15 * u[1]});
    }
    const auto batch = search.next_designs(options);
    ASSERT_GE(batch.size(), 2u);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        for (std::size_t j = i + 1; j < batch.size(); ++j) {
            EXPECT_GT(std::hypot((batch[i].at[0] - batch[j].at[0]) / 15, (batch[i].at[1] - batch[j].at[1]) / 15), 1e-3);
        }
    }
    // Runs failed wherever the search wanted to go: it goes elsewhere, and says that it might fail.
    DesignSearch::NextOptions after = options;
    after.count = 1;
    for (int i = 0; i < 3; ++i) {
        after.failed.push_back(batch[0].at);
    }
    const auto next = search.next_designs(after);
    ASSERT_EQ(next.size(), 1u);
    EXPECT_GT(std::hypot((batch[0].at[0] - next[0].at[0]) / 15, (batch[0].at[1] - next[0].at[1]) / 15), 0.02);
}

TEST(Search, WhatIsPlannedIsNotProposedAgain) {
    const DesignSearch search(smallest_f(), {{"f", of_branin(60, 4)}});
    DesignSearch::NextOptions options;
    options.count = 6;
    for (const auto& u : sobol_plan(60, 2, 4)) {
        options.solved.push_back({-5 + 15 * u[0], 15 * u[1]});
    }
    std::vector<std::vector<double>> all;
    for (int times = 0; times < 2; ++times) {
        for (const bool learn : {false, true}) {
            const auto batch = learn ? search.next_to_learn(options) : search.next_designs(options);
            ASSERT_EQ(batch.size(), options.count) << "as many as were asked for";
            for (const Candidate& c : batch) {
                options.planned.emplace_back(c.at, c.level);
                all.push_back(c.at);
            }
        }
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i + 1; j < all.size(); ++j) {
            EXPECT_GT(std::max(std::abs(all[i][0] - all[j][0]), std::abs(all[i][1] - all[j][1])) / 15, 0.0099)
                << i << ", " << j;
        }
    }
}

TEST(Search, FidelitiesKeepTheirNumbersWhereOneHasNoRuns) {
    const std::vector<SearchVariable> variables = {{"x", "1", 0, 1}};
    std::vector<SearchRun> runs;
    for (int i = 0; i <= 10; ++i) {
        runs.push_back({{0.1 * i}, 1, forrester_cheap(0.1 * i), 0});
    }
    for (const double x : {0.0, 0.4, 0.6, 1.0}) {
        runs.push_back({{x}, 3, forrester(x), 0});
    }
    const Surrogate surrogate = Surrogate::fit("f", "1", variables, runs);
    EXPECT_EQ(surrogate.fidelities(), (std::vector<std::size_t>{1, 3}));
    const std::vector<double> x = {0.75};
    EXPECT_LT(surrogate.sigma_after(x, x, 3), surrogate.sigma_after(x, x, 1));
    EXPECT_DOUBLE_EQ(surrogate.with({x, 2, std::nan(""), 0}).at(x).sigma,
                     surrogate.with({x, 3, std::nan(""), 0}).at(x).sigma)
        << "counts as a run of the next better one";
    SearchProblem problem;
    problem.variables = variables;
    problem.objectives = {{{"f", "f", {}, "", 0}, Objective::Sense::minimise, 0}};
    const DesignSearch search(problem, {{"f", surrogate}});
    DesignSearch::NextOptions options;
    options.solved = {{0.0}, {0.4}, {0.6}, {1.0}};
    options.level_costs = {1e-6, 1, 1e-6, 1};  // those without runs cannot be weighed
    EXPECT_EQ(search.next_designs(options).at(0).level, 3u);
    options.level_costs = {1, 1, 1, 1e6};
    EXPECT_EQ(search.next_designs(options).at(0).level, 1u);
    EXPECT_EQ(search.next_to_learn(options).at(0).level, 1u);
}

TEST(Search, TheCheapFidelityIsChosenWhereItTellsMore) {
    std::vector<SearchVariable> variables = {{"x", "1", 0, 1}};
    std::vector<SearchRun> runs;
    for (int i = 0; i <= 10; ++i) {
        runs.push_back({{0.1 * i}, 0, forrester_cheap(0.1 * i), 0});
    }
    for (const double x : {0.0, 0.4, 0.6, 1.0}) {
        runs.push_back({{x}, 1, forrester(x), 0});
    }
    SearchProblem problem;
    problem.variables = variables;
    problem.objectives = {{{"f", "f", {}, "", 0}, Objective::Sense::minimise, 0}};
    const DesignSearch search(problem, {{"f", Surrogate::fit("f", "1", variables, runs)}});
    DesignSearch::NextOptions options;
    options.solved = {{0.0}, {0.4}, {0.6}, {1.0}};
    options.level_costs = {1, 1};
    const auto dear = search.next_designs(options);
    ASSERT_EQ(dear.size(), 1u);
    EXPECT_EQ(dear[0].level, 1u);  // at equal cost the better run
    EXPECT_LT(dear[0].sigma_after, dear[0].sigma_now);
    options.level_costs = {1, 1e6};
    EXPECT_EQ(search.next_designs(options)[0].level, 0u);
}

TEST(Search, AFrontHoldsDesignsThatNoneBeats) {
    // Schaffer: x^2 and (x - 2)^2; the front is 0 <= x <= 2.
    std::vector<SearchVariable> variables = {{"x", "1", -4, 6}};
    std::vector<SearchRun> first, second;
    for (int i = 0; i <= 20; ++i) {
        const double x = -4 + 0.5 * i;
        first.push_back({{x}, 0, x * x, 0});
        second.push_back({{x}, 0, (x - 2) * (x - 2), 0});
    }
    SearchProblem problem;
    problem.variables = variables;
    problem.objectives = {{{"f", "f", {}, "", 0}, Objective::Sense::minimise, 0},
                          {{"g", "g", {}, "", 0}, Objective::Sense::minimise, 0}};
    const DesignSearch search(problem, {{"f", Surrogate::fit("f", "1", variables, first)},
                                        {"g", Surrogate::fit("g", "1", variables, second)}});
    const auto front = search.pareto_front(12, 1, 1);
    ASSERT_GE(front.size(), 8u);
    for (std::size_t i = 0; i < front.size(); ++i) {
        EXPECT_GT(front[i].at[0], -0.05);
        EXPECT_LT(front[i].at[0], 2.05);
        if (i > 0) {
            EXPECT_LE(front[i].objectives[1].value, front[i - 1].objectives[1].value + 1e-9);
        }
    }
    EXPECT_NEAR(front.front().at[0], 0, 0.1);
    EXPECT_NEAR(front.back().at[0], 2, 0.1);
    const core::Table t = table(search, front);
    EXPECT_EQ(t.rows(), front.size());
    EXPECT_NE(t.find("f_sigma"), nullptr);
}

/// Not on a limit, where a design holds it with a chance of one half: within it by one standard deviation.
TEST(Search, AFrontMeetsItsLimitsByAMargin) {
    const std::vector<SearchVariable> variables = {{"x", "1", -1, 3}, {"y", "1", -1, 1}};
    std::vector<SearchRun> first, second, third;
    for (const auto& u : sobol_plan(60, 2, 1)) {
        const double x = -1 + 4 * u[0], y = -1 + 2 * u[1];
        first.push_back({{x, y}, 0, x * x + y * y, 0.02});
        second.push_back({{x, y}, 0, (x - 2) * (x - 2) + y * y, 0.02});
        third.push_back({{x, y}, 0, y, 0.02});
    }
    SearchProblem problem;
    problem.variables = variables;
    problem.objectives = {{{"f", "f", {}, "", 0}, Objective::Sense::minimise, 0},
                          {{"g", "g", {}, "", 0}, Objective::Sense::minimise, 0}};
    problem.limits = {{{"h", "h", {}, "", 0}, 0.5, 1e300}};  // both would have y = 0
    const DesignSearch search(problem, {{"f", Surrogate::fit("f", "1", variables, first)},
                                        {"g", Surrogate::fit("g", "1", variables, second)},
                                        {"h", Surrogate::fit("h", "1", variables, third)}});
    const auto front = search.pareto_front(12, 1, 1);
    ASSERT_FALSE(front.empty());
    for (const Candidate& c : front) {
        EXPECT_GE(c.limits[0].value - 0.999 * c.limits[0].sigma, 0.5);
        EXPECT_GT(c.chance_valid, 0.84);
    }
    for (const Candidate& c : search.pareto_front(12, 2, 1)) {
        EXPECT_GT(c.chance_valid, 0.977);
    }
}

TEST(Search, ASlopeIsAResponse) {
    std::vector<SearchVariable> variables = {{"x", "1", 0, 1}, {"pitch", "rad", -0.1, 0.1, false, false}};
    std::vector<SearchRun> runs;
    for (const auto& u : sobol_plan(40, 2, 1)) {
        const double x = u[0], pitch = -0.1 + 0.2 * u[1];
        runs.push_back({{x, pitch}, 0, 0.3 * pitch * (x - 0.4) + 0.01 * x, 0});
    }
    SearchProblem problem;
    problem.variables = {variables[0]};
    problem.objectives = {
        {{"stiffness", "pitch_moment", {{"pitch", 0.0}}, "pitch", 0.0175}, Objective::Sense::minimise, 0}};
    const DesignSearch search(problem, {{"pitch_moment", Surrogate::fit("pitch_moment", "N m", variables, runs)}});
    const ResponseValue at = search.evaluate(problem.objectives[0].response, std::vector<double>{0.7});
    EXPECT_NEAR(at.value, 0.3 * 0.3, 0.02);
    EXPECT_LE(std::abs(at.value - 0.09), 4 * at.sigma + 1e-6);
    EXPECT_EQ(search.unit_of(problem.objectives[0].response), "N m/rad");
    const auto best = search.optimum(0, 1);
    ASSERT_TRUE(best);
    EXPECT_NEAR(best->at[0], 0, 1e-3);
    Response wrong = problem.objectives[0].response;
    wrong.conditions = {{"pich", 0.0}};
    problem.objectives[0].response = wrong;
    try {
        DesignSearch(problem, {{"pitch_moment", Surrogate::fit("pitch_moment", "N m", variables, runs)}});
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("pitch"));
    }
}

TEST(Search, ATrustRegionGrowsAndShrinks) {
    TrustRegion region;
    for (int i = 0; i < 3; ++i) {
        region.step(true, 8);
    }
    EXPECT_DOUBLE_EQ(region.length, 1.6);
    for (int i = 0; i < 8 * 8; ++i) {
        region.step(false, 8);
    }
    EXPECT_TRUE(region.collapsed());
}

}  // namespace
