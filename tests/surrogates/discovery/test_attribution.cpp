#include <gtest/gtest.h>

#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/one_law.h"
#include "surrogates/discovery/report_findings.h"

using namespace underbody::discovery;

namespace {

FittedHypothesis explanation(const std::string& name, double explained, double optimism = 0) {
    FittedHypothesis one;
    one.hypothesis.names = {name};
    one.cost = 10000 - explained;
    one.explained = explained;
    one.occam = 9;
    one.held_out = {one.cost + optimism};
    return one;
}

const FittedHypothesis& named(const std::vector<FittedHypothesis>& list, const Attribution::Share& share) {
    return list[share.hypothesis];
}

}  // namespace

TEST(Attribution, RanksRivalsThatHaveNoProbabilityLeftByWhatTheyExplain) {
    // a smooth law that leaves nothing to any name: the best name still comes first, and each share keeps its own
    const std::vector<FittedHypothesis> list{explanation("history_force", 0), explanation("linear_damping", 300),
                                             explanation("coulomb_friction", 4000), explanation("added_mass", 20)};
    SmoothFit rest;
    rest.gain = 1e6;
    rest.degrees = 8;
    rest.p = 0;
    const Attribution found = attribute(list, 1e-9, rest, {});
    EXPECT_EQ(found.verdict, "unknown");
    ASSERT_EQ(found.shares.size(), 4U);
    EXPECT_EQ(named(list, found.shares[0]).hypothesis.label(), "coulomb_friction");
    EXPECT_EQ(named(list, found.shares[1]).hypothesis.label(), "linear_damping");
    EXPECT_EQ(named(list, found.shares[2]).hypothesis.label(), "added_mass");
    EXPECT_EQ(named(list, found.shares[3]).hypothesis.label(), "history_force");
    EXPECT_EQ(found.chosen, 2U);
}

TEST(Attribution, UnknownIsNoSurerThanWhatIsLeftIsReal) {
    // a weak effect beside which noise makes a rest with a chance of 1 in 700 (towed rig of seed 70110 of the static
    // bench): a large share of what there is, and hardly more than chance
    const std::vector<FittedHypothesis> list{explanation("speed_exponent", 50), explanation("sensor_gain", 20)};
    SmoothFit rest;
    rest.gain = 25.2;
    rest.degrees = 5;
    Calibration calibration;
    calibration.unknown_p = 0.002;
    const auto unknown = [&](double chance) {
        rest.p = chance;
        return attribute(list, 1e-9, rest, calibration).unknown_probability;
    };
    EXPECT_NEAR(unknown(0.0015), 0.625, 0.01);  // above 0.99 before
    EXPECT_NEAR(unknown(0.002), 0.5, 0.01);
    EXPECT_NEAR(unknown(0.00201), 0.5, 0.01) << "and no step at the limit";
    EXPECT_GT(unknown(1e-6), 0.99);
    EXPECT_LT(unknown(0.2), 0.01);
}

TEST(Attribution, NoneIsAsSureAsTheChanceOfAsMuchStructureInNoiseLets) {
    const std::vector<FittedHypothesis> list{explanation("gap_offset", 40), explanation("sensor_gain", 10)};
    const auto at = [&](double chance) { return attribute(list, chance, {}, static_calibration()); };
    EXPECT_EQ(at(0.004).verdict, "none");
    EXPECT_NEAR(at(0.004).none_probability, 0.2, 1e-9);  // 0.75 before
    EXPECT_NEAR(at(0.01).none_probability, 0.5, 1e-9);
    EXPECT_NEAR(at(0.5).none_probability, 0.99, 1e-9);
    EXPECT_NEAR(at(0.001).none_probability, 0.05, 1e-9);
    const Attribution unsure = at(0.003);
    double sum = unsure.none_probability + unsure.unknown_probability;
    for (const Attribution::Share& share : unsure.shares) {
        EXPECT_LE(share.probability, 0.5) << "no name was asked for";
        sum += share.probability;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    const auto in_heave = [&](double chance) { return attribute(list, chance, {}, heave_calibration()); };
    EXPECT_EQ(in_heave(0.004).verdict, "none");
    EXPECT_NEAR(in_heave(0.004).none_probability, 0.0667, 1e-4);  // 0.75 before
    EXPECT_NEAR(in_heave(0.03).none_probability, 0.5, 1e-9);
    EXPECT_NEAR(in_heave(0.3).none_probability, 0.95, 1e-9);
}

TEST(Attribution, ALawIsNoLessLikelyForHavingTwoNames) {
    Attribution found;
    found.chosen = 0;
    found.shares = {{0, 0.36}, {1, 0.34}, {2, 0.3}};  // a lag, and a delay before or behind the body
    const auto is_delay = [](const Attribution::Share& share) { return share.hypothesis > 0; };
    tie_names_of_one_law(found, is_delay);
    EXPECT_EQ(found.chosen, 1U);  // the lag before, which is the less likely law
    EXPECT_NEAR(found.shares[0].probability, 0.32, 1e-12);
    EXPECT_NEAR(found.shares[1].probability, 0.32, 1e-12);
    EXPECT_EQ(found.shares[2].hypothesis, 0U);
    found.chosen = 0;
    found.shares = {{0, 0.6}, {1, 0.3}, {2, 0.1}};
    tie_names_of_one_law(found, is_delay);
    EXPECT_EQ(found.chosen, 0U);
    EXPECT_NEAR(found.shares[1].probability, 0.3, 1e-12);
}

TEST(Attribution, WhatNoNameHasIsToldBesideNone) {
    const std::vector<FittedHypothesis> fitted{explanation("linear_damping", 60)};
    Attribution refused;
    refused.shares = {{0, 0.5}};
    refused.unknown_probability = 0.49;
    refused.none_probability = 0.01;
    const auto text = [](const auto&...) { return std::string(); };
    const SmoothFit nothing;
    const std::vector<underbody::dynamics::EffectUse> no_uses;
    const Judgement judgement{fitted, refused, nothing, nothing, 0, no_uses, "", text, text};
    Discovery result;
    result.verdict = "none";
    tell(judgement, result);
    ASSERT_EQ(result.alternatives.size(), 2U);  // one before, and the probabilities summed to a half
    EXPECT_EQ(result.alternatives.back().name, "unknown");
    EXPECT_NEAR(result.alternatives.back().probability, 0.49, 1e-12);
}

TEST(Attribution, ASecondEffectIsNotSoftenedByWhatTheFirstExplains) {
    // as of a rig with a scale and an offset: what the offset explains beside the scale is small and sure
    std::vector<FittedHypothesis> list{explanation("sensor_gain", 100000), explanation("current", 90000),
                                       explanation("gap_offset", 100500)};
    list.back().hypothesis.names = {"gap_offset", "sensor_gain"};
    list.back().occam = 18;
    Calibration calibration;
    calibration.form_share = 0.003;
    const Attribution found = attribute(list, 1e-9, {}, calibration);
    EXPECT_EQ(named(list, found.shares.front()).hypothesis.label(), "gap_offset + sensor_gain");
    EXPECT_GT(found.shares.front().probability, 0.7);
    for (const Attribution::Share& share : found.shares) {
        if (named(list, share).hypothesis.names == std::vector<std::string>{"sensor_gain"}) {
            EXPECT_LT(share.probability, 1e-6);  // softened alike it came first
        }
    }
}

TEST(Attribution, CountsWhatNumbersFromOtherRunsLose) {
    // the same cost, but one of the two only with numbers that suit no other run
    const std::vector<FittedHypothesis> list{explanation("tether_stiffness", 200, 60),
                                             explanation("squeeze_film_damping", 200, 2)};
    const Attribution found = attribute(list, 1e-9, {}, {});
    EXPECT_EQ(found.chosen, 1U);
    EXPECT_GT(found.shares.front().probability, 0.99);
}

TEST(Attribution, SharesTheProbabilityBetweenExplanationsOfEqualWorth) {
    const std::vector<FittedHypothesis> list{explanation("input_delay", 200), explanation("gap_sensor_delay", 200),
                                             explanation("added_mass", 10)};
    const Attribution found = attribute(list, 1e-9, {}, {});
    EXPECT_NEAR(found.shares[0].probability, 0.5, 0.01);
    EXPECT_NEAR(found.shares[1].probability, 0.5, 0.01);
}
