#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/error.h"
#include "core/random.h"
#include "postproc/loads/uncertainty.h"

namespace underbody::postproc {
namespace {

std::vector<MeshValue> power_law(const std::vector<double>& sizes, double limit, double slope, double order) {
    std::vector<MeshValue> values;
    for (const double h : sizes) {
        values.push_back({h, limit + slope * std::pow(h, order)});
    }
    return values;
}

TEST(MeshUncertainty, ReproducesThePublishedExample) {
    // Celik et al. 2008, table 1, first column: 18000, 8000, 4500 cells (2-D), reattachment length.
    const std::vector<MeshValue> values = {
        {mesh_size(18000, 2), 6.063}, {mesh_size(8000, 2), 5.972}, {mesh_size(4500, 2), 5.863}};
    const MeshUncertainty result = mesh_uncertainty(values);
    EXPECT_EQ(result.verdict, MeshVerdict::monotone);
    EXPECT_NEAR(result.observed_order, 1.53, 0.005);
    EXPECT_NEAR(result.extrapolated, 6.1685, 0.0005);
    EXPECT_NEAR(result.relative_change, 0.015, 0.0002);
    EXPECT_NEAR(result.gci_fine, 0.0217, 0.0001);
    EXPECT_NEAR(result.gci_coarse, 0.0411, 0.0001);
    EXPECT_NEAR(result.asymptotic_ratio, 1.015, 0.0005);
    EXPECT_NEAR(result.standard_uncertainty, 0.5 * 0.0217 * 6.063, 0.001);
}

TEST(MeshUncertainty, FindsTheOrderOfAPowerLawForAnyRefinement) {
    for (const double order : {0.7, 1.0, 1.5, 1.99}) {
        const auto three = mesh_uncertainty(power_law({1.0, 1.3, 2.1}, 4.0, 0.3, order));
        EXPECT_NEAR(three.observed_order, order, 1e-8);
        EXPECT_NEAR(three.extrapolated, 4.0, 1e-8);
        EXPECT_NEAR(three.gci_fine * three.value, 1.25 * 0.3, 1e-8);
        const auto five = mesh_uncertainty(power_law({1.0, 1.3, 1.7, 2.1, 3.0}, 4.0, -0.3, order));
        EXPECT_NEAR(five.observed_order, order, 1e-4);
        EXPECT_NEAR(five.extrapolated, 4.0, 1e-4);
        EXPECT_NEAR(five.expanded_uncertainty, 1.25 * 0.3, 1e-3);
    }
}

TEST(MeshUncertainty, FindsTheOrderWhateverTheTwoRefinements) {
    for (const auto& [r21, r32] : {std::pair{1.15, 1.6}, {1.2, 2.0}, {2.0, 1.5}, {1.05, 4.0}, {1.5, 1.5}}) {
        for (const double order : {0.5, 1.0, 1.5, 1.9}) {
            const auto result = mesh_uncertainty(power_law({1, r21, r21 * r32}, 4, 0.3, order));
            EXPECT_NEAR(result.observed_order, order, 1e-9) << r21 << " " << r32;
            EXPECT_NEAR(result.expanded_uncertainty, 1.25 * 0.3, 1e-9);
            EXPECT_THAT(result.text, testing::Not(testing::HasSubstr("agree")));
        }
    }
    // 3, 2 and half a million cells, first order: the reported uncertainty covers the error of 0.2.
    const auto cells = [](double count) { return MeshValue{mesh_size(count), 2 + 0.2 * std::cbrt(3e6 / count)}; };
    const auto result = mesh_uncertainty(std::vector<MeshValue>{cells(3e6), cells(2e6), cells(5e5)});
    EXPECT_NEAR(result.observed_order, 1, 1e-9);
    EXPECT_NEAR(result.expanded_uncertainty, 0.25, 1e-9);
    // Differences that are the same over unlike refinements have an order too, where the coarser refinement is the
    // smaller.
    const auto even = mesh_uncertainty(std::vector<MeshValue>{{1, 1.0}, {2, 1.1}, {3, 1.2}});
    EXPECT_NEAR(even.observed_order, 1, 1e-9);
    EXPECT_NEAR(even.extrapolated, 0.9, 1e-9);
}

TEST(MeshUncertainty, RecoversRandomPowerLawsAndCoversTheirError) {
    core::Random random(17);
    for (int i = 0; i < 5000; ++i) {
        const double order = 0.5 + 2.5 * random.uniform();
        const double r21 = 1.1 + 1.4 * random.uniform();
        const double r32 = 1.1 + 1.4 * random.uniform();
        const double slope = 2 * random.uniform() - 1;
        const auto result = mesh_uncertainty(power_law({1, r21, r21 * r32}, 3, slope, order));
        ASSERT_EQ(result.verdict, MeshVerdict::monotone) << order << " " << r21 << " " << r32;
        EXPECT_NEAR(result.observed_order, order, 1e-7 / std::abs(slope)) << r21 << " " << r32;
        EXPECT_GE(result.expanded_uncertainty, std::abs(result.value - 3)) << order << " " << r21 << " " << r32;
    }
}

TEST(MeshUncertainty, SaysThatMeshesAgreeOnlyWhenTheyDo) {
    const auto agreeing = mesh_uncertainty(std::vector<MeshValue>{{1, 1.0}, {2, 1.0}, {4, 1.3}});
    EXPECT_THAT(agreeing.text, testing::HasSubstr("the finest two meshes agree"));
    const auto nearly = mesh_uncertainty(std::vector<MeshValue>{{1, 1.0}, {2, 1.0 + 1e-15}, {4, 1.3}});
    EXPECT_THAT(nearly.text, testing::HasSubstr("observed order 47.9"));
    const auto slow = mesh_uncertainty(power_law({1, 2, 4}, 1, 0.1, 0.05));
    EXPECT_THAT(slow.text, testing::HasSubstr("observed order 0.05 (order 0.1 used)"));
}

TEST(MeshUncertainty, DoesNotBelieveOrdersAboveTheFormalOne) {
    const auto result = mesh_uncertainty(power_law({1.0, 2.0, 4.0}, 1.0, 0.01, 5.0));
    EXPECT_NEAR(result.observed_order, 5, 1e-6);
    EXPECT_EQ(result.used_order, 2);
    EXPECT_GT(result.expanded_uncertainty, std::abs(result.value - 1.0));
}

TEST(MeshUncertainty, NamesOscillatingAndDivergingValues) {
    const std::vector<MeshValue> oscillating = {{1, 1.00}, {2, 1.02}, {4, 0.96}};
    EXPECT_EQ(mesh_uncertainty(oscillating).verdict, MeshVerdict::oscillating);
    EXPECT_NEAR(mesh_uncertainty(oscillating).expanded_uncertainty, 0.03, 1e-12);
    // EVIE at 5 mm, lift: 0.242, 0.270, 0.274 N on 374k, 138k, 57k cells.
    const std::vector<MeshValue> diverging = {
        {mesh_size(374400), 0.242}, {mesh_size(138544), 0.270}, {mesh_size(57280), 0.274}};
    const auto result = mesh_uncertainty(diverging);
    EXPECT_EQ(result.verdict, MeshVerdict::diverging);
    EXPECT_NEAR(result.standard_uncertainty, 0.032 / std::sqrt(3), 1e-9);
    EXPECT_THAT(result.text, testing::HasSubstr("no convergence"));
    EXPECT_EQ(result.extrapolated, 0.242);
}

TEST(MeshUncertainty, CoversTheTruthOfNoisyPowerLawsMostOfTheTime) {
    core::Random random(7);
    int covered = 0;
    constexpr int trials = 400;
    for (int i = 0; i < trials; ++i) {
        const double order = 1 + random.uniform();
        auto values = power_law({1.0, 1.5, 2.2, 3.1}, 10, 0.2, order);
        for (auto& value : values) {
            value.value += 0.01 * (random.uniform() - 0.5);
        }
        const auto result = mesh_uncertainty(values);
        covered += std::abs(result.value - 10) <= result.expanded_uncertainty ? 1 : 0;
    }
    EXPECT_GE(covered, 0.95 * trials);
}

TEST(MeshUncertainty, TakesTwoMeshesWithAnAssumedOrderAndEqualValues) {
    const std::vector<MeshValue> two = {{1, 1.0}, {2, 1.3}};
    const auto result = mesh_uncertainty(two);
    EXPECT_EQ(result.verdict, MeshVerdict::assumed);
    EXPECT_NEAR(result.expanded_uncertainty, 0.3, 1e-12);
    const std::vector<MeshValue> same = {{1, 1.0}, {2, 1.0}, {3, 1.0}};
    EXPECT_EQ(mesh_uncertainty(same).verdict, MeshVerdict::same);
    EXPECT_EQ(mesh_uncertainty(same).standard_uncertainty, 0);
}

TEST(MeshUncertainty, DoesNotTrustTwoMeshesThatAgreeByLuck) {
    // The finest two agree, the third does not: at the second order the coarser pair's difference of 0.3 leaves
    // 0.3 / 3 / 4 on the finest mesh.
    for (const double luck : {0.0, 1e-6}) {
        const auto result = mesh_uncertainty(std::vector<MeshValue>{{1, 1.0}, {2, 1.0 + luck}, {4, 1.3}});
        EXPECT_EQ(result.verdict, MeshVerdict::monotone);
        EXPECT_NEAR(result.expanded_uncertainty, 1.25 * 0.3 / 12, 1e-6);
        EXPECT_THAT(result.text, testing::HasSubstr("coarser pair used"));
    }
    // The coarser two agree, the finest leaves them.
    const auto leaving = mesh_uncertainty(std::vector<MeshValue>{{1, 1.3}, {2, 1.0}, {4, 1.0}});
    EXPECT_EQ(leaving.verdict, MeshVerdict::diverging);
    EXPECT_NEAR(leaving.expanded_uncertainty, 0.3, 1e-12);
}

TEST(MeshUncertainty, SaysWhenMeshesHardlyDiffer) {
    const auto result = mesh_uncertainty(std::vector<MeshValue>{{1, 1.0}, {1.05, 1.01}, {1.1, 1.0225}});
    EXPECT_THAT(result.text, testing::HasSubstr("factor of 1.05 only"));
    EXPECT_GT(result.expanded_uncertainty, 0.05);  // and the error is not taken for small because the step was
    EXPECT_THAT(mesh_uncertainty(power_law({1, 1.3, 1.7}, 1, 0.1, 2)).text, testing::Not(testing::HasSubstr("only")));
}

TEST(MeshUncertainty, OfValuesAboutNothingIsAbsolute) {
    const auto zero = mesh_uncertainty(std::vector<MeshValue>{{1, 0.0}, {2, 0.3}});
    EXPECT_NEAR(zero.expanded_uncertainty, 0.3, 1e-12);
    EXPECT_TRUE(std::isnan(zero.gci_fine));
    EXPECT_THAT(zero.text, testing::HasSubstr("uncertainty 0.3 about 0"));
    const std::vector<MeshValue> rounding = {{1, 1e-17}, {2, -3e-17}, {4, 2e-16}};
    EXPECT_EQ(mesh_uncertainty(rounding).verdict, MeshVerdict::oscillating);
    EXPECT_EQ(mesh_uncertainty(rounding, 2, 1e-12).verdict, MeshVerdict::same);
    EXPECT_EQ(mesh_uncertainty(rounding, 2, 1e-12).standard_uncertainty, 0);
}

TEST(MeshUncertainty, NamesFourMeshesThatDoNotConverge) {
    const auto growing = mesh_uncertainty(std::vector<MeshValue>{{1, 2.0}, {2, 1.3}, {4, 1.1}, {8, 1.0}});
    EXPECT_EQ(growing.verdict, MeshVerdict::diverging);
    EXPECT_GT(growing.expanded_uncertainty, 1.0);
    EXPECT_TRUE(std::isnan(growing.observed_order));
    EXPECT_EQ(growing.extrapolated, 2.0);
    const auto swinging = mesh_uncertainty(std::vector<MeshValue>{{1, 1.0}, {2, 1.1}, {4, 0.95}, {8, 1.12}});
    EXPECT_EQ(swinging.verdict, MeshVerdict::oscillating);
    EXPECT_GT(swinging.expanded_uncertainty, 0.08);
}

/// Values of a second implementation of Eça and Hoekstra's procedure (numpy's least squares, orders in steps of
/// 0.0005).
TEST(MeshUncertainty, OfManyMeshesFitsFixedOrdersWhereTheFreeOneIsNotPlausible) {
    const std::vector<double> sizes = {1, 1.25, 1.6, 2, 2.6};
    struct Known {
        std::vector<MeshValue> values;
        double order, used, limit, uncertainty;
    };
    for (const Known& known : {Known{power_law(sizes, 1, 0.01, 5), 5, 2, 0.728056, 0.809945},
                               {power_law(sizes, 1, 0.05, 3), 3, 2, 0.880197, 0.493187},
                               {power_law(sizes, 1, 0.5, 0.2), 0.2, NAN, 1.395300, 0.317205},  // both orders together
                               {{{1, 1.02}, {1.5, 1.05}, {2, 1.07}, {3, 1.16}, {4, 1.21}},
                                1.1737,
                                1.1737,
                                0.97083,
                                0.07188},  // without weights
                               {{{1, 1.0}, {2, 1.1}, {4, 0.95}, {8, 1.12}}, NAN, 2, 1.018710, 0.384810}}) {
        const auto result = mesh_uncertainty(known.values);
        EXPECT_THAT(result.observed_order, testing::NanSensitiveDoubleNear(known.order, 1e-3)) << result.text;
        EXPECT_THAT(result.used_order, testing::NanSensitiveDoubleNear(known.used, 1e-3)) << result.text;
        EXPECT_NEAR(result.extrapolated, known.limit, 3e-5) << result.text;
        EXPECT_NEAR(result.expanded_uncertainty, known.uncertainty, 3e-5) << result.text;
    }
    EXPECT_THAT(mesh_uncertainty(power_law(sizes, 1, 0.01, 5)).text, testing::HasSubstr("(order 2 used), factor 3"));
    EXPECT_THAT(mesh_uncertainty(power_law(sizes, 1, 0.5, 0.2)).text,
                testing::HasSubstr("(orders 1 and 2 together used), factor 3"));
}

TEST(MeshUncertainty, RefusesWhatIsNoStudy) {
    EXPECT_THROW(mesh_uncertainty(std::vector<MeshValue>{{1, 1}}), core::InputError);
    EXPECT_THROW(mesh_uncertainty(std::vector<MeshValue>{{1, 1}, {1, 2}}), core::InputError);
    EXPECT_THROW(mesh_uncertainty(std::vector<MeshValue>{{1, 1}, {2, NAN}}), core::InputError);
    EXPECT_THROW(mesh_size(0), core::InputError);
}

TEST(IterationScatter, CutsTheApproachOffAndMeasuresTheTail) {
    core::Random random(3);
    std::vector<double> history;
    for (int i = 0; i < 1000; ++i) {
        history.push_back(2 + 5 * std::exp(-i / 40.0) + 0.01 * random.normal());
    }
    const auto result = iteration_scatter(history);
    EXPECT_GT(result.first, 150U);
    EXPECT_LE(result.first, 500U);
    EXPECT_NEAR(result.mean, 2, 0.002);
    EXPECT_NEAR(result.deviation, 0.01, 0.001);
    EXPECT_TRUE(result.settled);
    EXPECT_LT(result.error_of_mean, 0.001);
}

TEST(IterationScatter, NamesADriftAndACycle) {
    std::vector<double> drifting;
    std::vector<double> cycling;
    core::Random random(4);
    for (int i = 0; i < 600; ++i) {
        drifting.push_back(1 + 0.001 * i + 0.01 * random.normal());
        cycling.push_back(1 + 0.1 * std::sin(2 * 3.14159265358979 * i / 50.0));
    }
    const auto drift = iteration_scatter(drifting);
    EXPECT_FALSE(drift.settled);
    EXPECT_GT(drift.standard_uncertainty, 0.2);
    const auto cycle = iteration_scatter(cycling);
    EXPECT_NEAR(cycle.period, 50, 1);
    EXPECT_NEAR(cycle.deviation, 0.1 / std::sqrt(2), 0.003);
    EXPECT_THROW(iteration_scatter(std::vector<double>{1, 2, 3}), core::InputError);
}

TEST(IterationScatter, OfAForceThatIsNoughtIsSettled) {
    const auto nought = iteration_scatter(std::vector<double>(40, 0.0));
    EXPECT_TRUE(nought.settled);
    EXPECT_EQ(nought.standard_uncertainty, 0);
}

TEST(IterationScatter, TellsASlowApproachFromNoiseOfTheSameSize) {
    core::Random random(11);
    std::vector<double> slow, noise, jump;
    for (int i = 0; i < 400; ++i) {
        slow.push_back(1 + 0.2 * std::exp(-i / 400.0));
        noise.push_back(1 + 0.02 * random.normal());
        jump.push_back(i < 100 ? 0.5 : 1.0);
    }
    const auto approach = iteration_scatter(slow);
    EXPECT_FALSE(approach.settled);
    // It still has 0.2 / e = 0.074 to go: the drift of what is left stands for that.
    EXPECT_GT(approach.standard_uncertainty, 0.04);
    const auto still = iteration_scatter(noise);
    EXPECT_TRUE(still.settled);
    EXPECT_NEAR(still.standard_uncertainty, 0.02, 0.004);
    const auto after = iteration_scatter(jump);
    EXPECT_TRUE(after.settled);
    EXPECT_GE(after.first, 100U);
    EXPECT_EQ(after.mean, 1);
    EXPECT_EQ(after.standard_uncertainty, 0);
}

TEST(IterationScatter, WritesJson) {
    const nlohmann::json json = iteration_scatter(std::vector<double>(20, 3.0));
    EXPECT_EQ(json["mean"], 3.0);
    EXPECT_EQ(json["settled"], true);
}

}  // namespace
}  // namespace underbody::postproc
