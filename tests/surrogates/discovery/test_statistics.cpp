#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/least_squares.h"
#include "surrogates/discovery/statistics.h"

using namespace underbody;
using namespace underbody::discovery;

TEST(Statistics, WilsonIntervalAgreesWithItsFormula) {
    const Interval i = wilson_interval(8, 10);
    EXPECT_NEAR(i.low, 0.4901625, 1e-6);   // Wilson 1927, computed by hand
    EXPECT_NEAR(i.high, 0.9433178, 1e-6);
    EXPECT_DOUBLE_EQ(wilson_interval(0, 0).high, 1);
}

TEST(Statistics, NoiseOfASmoothSignalIsFoundDespiteOutliers) {
    core::Random random(3);
    std::vector<double> y;
    for (int k = 0; k < 4000; ++k) {
        y.push_back(0.1 * std::sin(0.002 * k) + 2e-4 * random.normal() + (k % 500 == 7 ? 0.05 : 0));
    }
    EXPECT_NEAR(noise_from_second_differences(y), 2e-4, 1e-5);
}

TEST(Statistics, GroupIntervalsHoldTheTruthAsOftenAsTheySay) {
    int held = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        core::Random random(seed);
        std::vector<double> squares, counts;
        for (int g = 0; g < 8; ++g) {
            const double size = std::exp(0.3 * random.normal());
            double sum = 0;
            for (int k = 0; k < 50; ++k) {
                sum += std::pow(size * random.normal(), 2);
            }
            squares.push_back(sum);
            counts.push_back(50);
        }
        const ErrorEstimate e = error_by_groups(squares, counts, seed);
        const double truth = std::exp(0.3 * 0.3);  // root of the mean of exp(2 x), x normal with 0.3
        held += e.low <= truth && truth <= e.high ? 1 : 0;
    }
    EXPECT_GE(held, 176);  // 88 % of 200
    EXPECT_LE(held, 200);
}

TEST(LeastSquares, FindsTheBoundedMinimumAndItsSpread) {
    // y = a exp(-b t), noise 0.01: curvature gives the spread
    core::Random random(5);
    std::vector<double> t, y;
    for (int k = 0; k < 200; ++k) {
        t.push_back(0.02 * k);
        y.push_back(2 * std::exp(-0.7 * t.back()) + 0.01 * random.normal());
    }
    const auto residuals = [&](std::span<const double> p, std::vector<double>& r) {
        r.resize(t.size());
        for (std::size_t i = 0; i < t.size(); ++i) {
            r[i] = (y[i] - p[0] * std::exp(-p[1] * t[i])) / 0.01;
        }
        return 0.0;
    };
    const Fit free = least_squares({{"a", "1", 0, 10, 1, 1}, {"b", "1/s", 0, 5, 0.1, 1}}, residuals);
    EXPECT_NEAR(free.parameters[0], 2, 4 * free.sigma[0]);
    EXPECT_NEAR(free.parameters[1], 0.7, 4 * free.sigma[1]);
    EXPECT_NEAR(free.cost, 198, 80);
    const Fit bounded = least_squares({{"a", "1", 0, 10, 1, 1}, {"b", "1/s", 0, 0.5, 0.1, 1}}, residuals);
    EXPECT_DOUBLE_EQ(bounded.parameters[1], 0.5);
    EXPECT_TRUE(bounded.at_bound);
}

TEST(Flexible, RidgeFitFollowsASmoothFunctionOfTwoVariables) {
    core::Random random(7);
    std::vector<std::vector<double>> x(2);
    std::vector<double> y;
    for (int k = 0; k < 600; ++k) {
        x[0].push_back(random.uniform());
        x[1].push_back(random.uniform());
        y.push_back(std::sin(3 * x[0].back()) * x[1].back() + 0.01 * random.normal());
    }
    const FlexibleBasis basis(x, 4);
    EXPECT_EQ(basis.columns(), 25U);
    DesignMatrix matrix;
    matrix.rows = y.size();
    matrix.columns = basis.columns();
    matrix.values.resize(matrix.rows * matrix.columns);
    std::vector<double> out(basis.columns());
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double point[2] = {x[0][i], x[1][i]};
        basis.evaluate(point, out.data());
        for (std::size_t k = 0; k < out.size(); ++k) {
            matrix.at(i, k) = out[k];
        }
    }
    const RidgeFit fit = ridge_fit(matrix, y);
    EXPECT_LT(std::sqrt(fit.residual_square / 600), 0.012);
    const DesignMatrix q = orthonormal(matrix);
    double total = 0;
    for (const double value : y) {
        total += value * value;
    }
    EXPECT_LE(explained_square(q, y), total * (1 + 1e-12));
    EXPECT_GE(explained_square(q, y), total - fit.residual_square - 1e-9);
}
