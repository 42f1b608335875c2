// Medians, robust deviations, and the normal distribution.
#include <gtest/gtest.h>

#include <cmath>

#include "core/normal.h"
#include "core/quantile.h"
#include "core/random.h"

namespace underbody::core {
namespace {

TEST(OrderStatistics, AMedianOfAnEvenCountLiesBetweenTheTwoInTheMiddle) {
    EXPECT_EQ(median({3, 1, 2}), 2);
    EXPECT_EQ(median({4, 1, 2, 10}), 3);
    EXPECT_EQ(median({7}), 7);
    EXPECT_TRUE(std::isnan(median({})));
    EXPECT_DOUBLE_EQ(quantile({5, 1, 4, 2, 3}, 0.125), 1.5);
    EXPECT_EQ(quantile({5, 1, 4}, 1), 5);
}

TEST(OrderStatistics, TheUsualStepIsDeafToPausesAndToClocksThatStand) {
    EXPECT_DOUBLE_EQ(usual_step(std::vector<double>{0, 0.1, 0.2, 0.2, 0.1, 0.2, 90, 90.1}), 0.1);
    EXPECT_EQ(usual_step(std::vector<double>{1}), 0);
    EXPECT_EQ(usual_step(std::vector<double>{1, 1, 0}), 0);
}

TEST(OrderStatistics, ARobustDeviationIsThatOfNormalNumbersDespiteOutliers) {
    Random random(5);
    std::vector<double> values;
    for (int i = 0; i < 20000; ++i) {
        values.push_back(i % 50 == 0 ? 1e3 : random.normal(4, 0.3));
    }
    EXPECT_NEAR(robust_deviation(values), 0.3, 0.012);
}

TEST(NormalDistribution, QuantilesAreThoseOfTables) {
    EXPECT_NEAR(normal_quantile(0.05), 1.6448536269514722, 1e-14);  // NIST, tables of the normal distribution
    EXPECT_NEAR(normal_quantile(0.025), sigmas_of_95, 1e-14);
    EXPECT_NEAR(normal_quantile(0.75), -0.6744897501960817, 1e-14);
    EXPECT_NEAR(-1 / normal_quantile(0.75), sigma_of_median_distance, 1e-14);
    EXPECT_NEAR(0.5 * std::erfc(normal_quantile(1e-12) / std::sqrt(2.0)), 1e-12, 1e-24);
}

TEST(NormalDistribution, WilsonIntervalAgreesWithItsFormula) {
    const Interval i = wilson_interval(8, 10);
    EXPECT_NEAR(i.low, 0.4901625, 1e-6);  // Wilson 1927, computed by hand
    EXPECT_NEAR(i.high, 0.9433178, 1e-6);
    EXPECT_DOUBLE_EQ(wilson_interval(0, 0).high, 1);
}

TEST(NormalDistribution, ADifferenceCountsFromTwiceTheJointError) {
    EXPECT_TRUE(beyond_joint_error(-10.01, 3, 4));
    EXPECT_FALSE(beyond_joint_error(10, 3, 4));
    EXPECT_FALSE(beyond_joint_error(10, std::nan(""), 4));
}

}  // namespace
}  // namespace underbody::core
