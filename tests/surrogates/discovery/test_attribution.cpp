#include <gtest/gtest.h>

#include <cmath>

#include "surrogates/discovery/attribution.h"

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
