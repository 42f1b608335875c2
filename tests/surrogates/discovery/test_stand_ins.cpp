// What stands in for something else is not told as found: a law over a variable that follows time through the
// controller, a clock, a number of each run, noise of any size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "make_data.h"
#include "reading_rig.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/wording.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

Discovery found_in(const std::function<double(double, double, double)>& extra, std::uint64_t seed,
                   const test::HeaveRig& rig) {
    const core::TemporaryFolder folder("stand-ins");
    DiscoverOptions options;
    options.figures = options.consequence = false;
    return discover(test::heave_model(folder.path()), test::heave_runs(extra, 8, 50, seed, rig), options);
}

/// Of a rig whose controller is fed the noisy reading.
Discovery found_in(const test::ReadingRig& rig, std::uint64_t seed) {
    const core::TemporaryFolder folder("stand-ins");
    DiscoverOptions options;
    options.figures = options.consequence = false;
    return discover(test::heave_model(folder.path()), test::reading_runs(rig, seed), options);
}

}  // namespace

/// The controller's force follows what grows in time, and so does the gap a little: neither is its law, nor is the
/// sensor to blame, whose drift moves the reading and not the body.
TEST(StandIns, AForceThatGrowsInTimeIsNoLawOfWhatFollowsItAndNoDriftOfTheSensor) {
    test::HeaveRig rig;
    rig.seconds = 40;
    for (const std::uint64_t seed : {1U, 2U}) {
        const Discovery found = found_in([](double t, double, double) { return -2e-4 * t; }, seed, rig);
        ASSERT_EQ(found.verdict, "effect") << found.sentence;
        ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
        EXPECT_EQ(found.effects.front().name, "growing_force") << found.sentence;
        EXPECT_GT(found.effects.front().probability, 0.9) << found.sentence;
        EXPECT_NEAR(found.effects.front().parameters.front().value, -2e-4, 2e-5);
        EXPECT_THAT(found.depends_on, testing::ElementsAre("time")) << found.sentence;
    }
}

TEST(StandIns, ADriftOfTheSensorIsNoForceThatGrows) {
    test::ReadingRig rig;
    rig.drift = 6e-5;
    for (const std::uint64_t seed : {1U, 2U}) {
        const Discovery found = found_in(rig, seed);
        ASSERT_EQ(found.verdict, "effect") << found.sentence;
        ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
        EXPECT_EQ(found.effects.front().name, "gap_sensor_drift") << found.sentence;
        EXPECT_GT(found.effects.front().probability, 0.9) << found.sentence;
        EXPECT_NEAR(found.effects.front().parameters.front().value, rig.drift, 0.2 * rig.drift);
    }
}

/// A misfit of many noises made the twins' filter expect a random force, and their own error as large as it.
TEST(StandIns, ALimitOfTheActuatorIsNoNoise) {
    test::ReadingRig rig;
    rig.felt = [](double u) { return std::min(u, 0.055); };
    for (const std::uint64_t seed : {1U, 3U}) {
        const Discovery found = found_in(rig, seed);
        EXPECT_EQ(found.verdict, "unknown") << found.sentence;
        EXPECT_EQ(found.mended, "") << found.sentence;
        EXPECT_FALSE(found.by_run) << found.sentence;
        EXPECT_THAT(found.depends_on, testing::Contains("input_force")) << found.sentence;
        EXPECT_LT(found.rest.twins, 1.6 * rig.noise) << found.sentence;
        EXPECT_LE(found.error.front().after.rmse, found.error.front().before.rmse) << found.sentence;
    }
}

TEST(StandIns, ADragOneWayIsNoClock) {
    test::ReadingRig rig;
    rig.extra = [](double, double, double w) { return w > 0 ? -12 * w * w : 0.0; };
    for (const std::uint64_t seed : {1U, 2U}) {
        const Discovery found = found_in(rig, seed);
        EXPECT_EQ(found.mended, "") << found.sentence;
        EXPECT_NE(found.verdict, "none") << found.sentence;
        EXPECT_LT(found.error.front().after.rmse, found.error.front().before.rmse) << found.sentence;
    }
}

/// Between its gaps a lift that follows late damps as a film does, and was named so at above 0.99.
TEST(StandIns, ALiftThatLagsIsNoFilm) {
    constexpr double late = 0.4;  // s
    test::ReadingRig rig;
    rig.extra = [now = 0.0, last = 1e9](double t, double h, double) mutable {
        const double lift = test::lift_of(h);
        now = t < last - 1 ? lift : now + (1 - std::exp(-std::max(t - last, 0.0) / late)) * (lift - now);
        last = t;
        return now - lift;
    };
    const Discovery found = found_in(rig, 2);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects.front().name, "lift_lag") << found.sentence;
    EXPECT_NEAR(found.effects.front().parameters.front().value, late, 0.04);
    EXPECT_LT(found.error.front().after.rmse, 1.3 * rig.noise) << found.sentence;
}

/// A drag with a power between one and two was both dampings at above 0.99: the second one adds nothing to runs that
/// were not fitted.
TEST(StandIns, ADragBetweenTwoLawsIsNotBoth) {
    test::ReadingRig rig;
    rig.extra = [](double, double, double w) { return -0.25 * w * std::pow(std::abs(w), 0.35); };
    const Discovery found = found_in(rig, 1);
    EXPECT_NE(found.verdict, "none") << found.sentence;
    ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
    EXPECT_LT(found.effects.front().probability, 0.9) << found.sentence;
}

/// "Nothing is missing" is said of nothing but noise: where the fitted runs hold more, and no other run bears it out,
/// that is what is said.
TEST(StandIns, StructureThatNothingConfirmsIsToldAsSuch) {
    Discovery found;
    found.verdict = "none";
    found.gate = 1e-5;
    found.structure = true;
    EXPECT_THAT(verdict_sentence(found),
                testing::AllOf(testing::HasSubstr("No effect is named"), testing::HasSubstr("chance 1e-05"),
                               testing::Not(testing::HasSubstr("Nothing is missing"))));
    found.structure = false;
    EXPECT_THAT(verdict_sentence(found), testing::HasSubstr("Nothing is missing"));
}
