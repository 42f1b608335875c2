#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/random.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/least_squares.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

using namespace underbody;
using namespace underbody::discovery;

TEST(Statistics, NoiseOfASmoothSignalIsFoundDespiteOutliers) {
    core::Random random(3);
    std::vector<double> y;
    for (int k = 0; k < 4000; ++k) {
        y.push_back(0.1 * std::sin(0.002 * k) + 2e-4 * random.normal() + (k % 500 == 7 ? 0.05 : 0));
    }
    EXPECT_NEAR(dynamics::sensor_noise({}, y), 2e-4, 1e-5);
}

TEST(Statistics, NoiseOfASensorThatRoundsIsThatOfItsSteps) {
    std::vector<double> y, fine;
    for (int i = 0; i < 2000; ++i) {
        const double h = 0.1 + 0.05 * std::sin(2e-3 * i) + 0.02 * std::cos(7e-3 * i);
        fine.push_back(h);
        y.push_back(7e-4 * std::round(h / 7e-4));
    }
    double sum = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        sum += (y[i] - fine[i]) * (y[i] - fine[i]);
    }
    const double truth = std::sqrt(sum / static_cast<double>(y.size()));
    EXPECT_NEAR(dynamics::reading_step(y), 7e-4, 1e-9);
    EXPECT_NEAR(dynamics::sensor_noise({}, y), truth, 0.1 * truth);
    EXPECT_EQ(dynamics::reading_step(fine), 0);
    EXPECT_EQ(dynamics::reading_step(std::vector<double>(50, 0.1)), 0);
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

TEST(Flexible, LeavingAGroupOutIsTheRefitToTheOthers) {
    // y = p x + noise in three groups: the cost of each group with p from the other two, by hand
    core::Random random(5);
    DesignMatrix jacobian;
    jacobian.rows = 30;
    jacobian.columns = 1;
    std::vector<double> y;
    for (int i = 0; i < 30; ++i) {
        jacobian.values.push_back(1 + 0.1 * i);
        y.push_back(2 * jacobian.values.back() + random.normal());
    }
    const std::vector<std::size_t> begin{0, 10, 20, 30};
    const auto fit = [&](std::size_t without) {
        double xy = 0, xx = 0;
        for (std::size_t i = 0; i < 30; ++i) {
            if (i < begin[without] || i >= begin[without + 1]) {
                xy += jacobian.values[i] * y[i];
                xx += jacobian.values[i] * jacobian.values[i];
            }
        }
        return xy / xx;
    };
    double xy = 0, xx = 0;
    for (std::size_t i = 0; i < 30; ++i) {
        xy += jacobian.values[i] * y[i];
        xx += jacobian.values[i] * jacobian.values[i];
    }
    // residuals y - p x have the derivative -x
    std::vector<double> residuals;
    DesignMatrix slope = jacobian;
    for (std::size_t i = 0; i < 30; ++i) {
        residuals.push_back(y[i] - xy / xx * jacobian.values[i]);
        slope.values[i] = -jacobian.values[i];
    }
    const std::vector<std::vector<double>> moves = moves_without_groups(slope, residuals, begin);
    ASSERT_EQ(moves.size(), 3U);
    for (std::size_t g = 0; g < 3; ++g) {
        EXPECT_NEAR(xy / xx + moves[g].at(0), fit(g), 1e-6) << g;
    }
}

TEST(Flexible, GroupsThatDisagreeWidenTheError) {
    DesignMatrix jacobian;
    jacobian.rows = 40;
    jacobian.columns = 1;
    jacobian.values.assign(40, 1.0);
    std::vector<double> residuals(40);
    for (std::size_t i = 0; i < 40; ++i) {
        residuals[i] = i < 20 ? 1.0 : -1.0;  // two halves pull the mean apart
    }
    const double alone = 1.0 / 40;
    EXPECT_NEAR(grouped_variances(jacobian, residuals, {0, 40})[0], alone, 1e-9);
    // four groups: sum of squared scores 4 * 100, times 4/3, over 40 squared
    EXPECT_NEAR(grouped_variances(jacobian, residuals, {0, 10, 20, 30, 40})[0], 400.0 * 4 / 3 / 1600, 1e-9);
}

TEST(Flexible, SlopesOfASumAreItsDifferences) {
    core::Random random(6);
    std::vector<std::vector<double>> values(2);
    for (int i = 0; i < 200; ++i) {
        values[0].push_back(random.normal());
        values[1].push_back(random.uniform());
    }
    const FlexibleBasis basis(values, 3);
    std::vector<double> coefficients(basis.columns()), columns(basis.columns());
    for (double& c : coefficients) {
        c = random.normal();
    }
    const double at[2] = {0.3, 0.4};
    double slopes[2];
    const double value = basis.sum(coefficients.data(), at, slopes);
    basis.evaluate(at, columns.data());
    EXPECT_NEAR(value, std::inner_product(columns.begin(), columns.end(), coefficients.begin(), 0.0), 1e-12);
    for (int v = 0; v < 2; ++v) {
        double up[2] = {at[0], at[1]}, down[2] = {at[0], at[1]}, unused[2];
        up[v] += 1e-5;
        down[v] -= 1e-5;
        const double expected =
            (basis.sum(coefficients.data(), up, unused) - basis.sum(coefficients.data(), down, unused)) / 2e-5;
        EXPECT_NEAR(slopes[v], expected, 1e-5 * (1 + std::abs(expected))) << v;
    }
}
