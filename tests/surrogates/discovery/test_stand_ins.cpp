// What stands in for something else is not told as found: a law over a variable that follows time through the
// controller, a clock, a number of each run, noise of any size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "make_data.h"
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

bool corrected(const Discovery& found) {
    return std::any_of(found.effects.begin(), found.effects.end(),
                       [](const FoundEffect& effect) { return !effect.uses.empty(); });
}

double nothing(double, double, double) { return 0; }

}  // namespace

/// The controller's force follows what grows in time, and so does the gap a little: neither is its law.
TEST(StandIns, AForceThatGrowsInTimeIsALawOfTime) {
    test::HeaveRig rig;
    rig.seconds = 40;
    for (const std::uint64_t seed : {1U, 2U}) {
        const Discovery found = found_in([](double t, double, double) { return -2e-4 * t; }, seed, rig);
        EXPECT_EQ(found.verdict, "unknown") << found.sentence;
        EXPECT_THAT(found.depends_on, testing::ElementsAre("time")) << found.sentence;
        EXPECT_FALSE(corrected(found)) << found.sentence;
        EXPECT_FALSE(found.by_run) << found.sentence;
    }
}

/// A misfit of many noises made the twins' filter expect a random force, and their own error as large as it.
TEST(StandIns, ALimitOfTheActuatorIsNoNoise) {
    test::HeaveRig rig;
    rig.seconds = 40;
    rig.felt = [](double u) { return std::clamp(u, -0.045, 0.045); };
    for (const std::uint64_t seed : {1U, 2U}) {
        const Discovery found = found_in(nothing, seed, rig);
        EXPECT_EQ(found.verdict, "unknown") << found.sentence;
        EXPECT_THAT(found.depends_on, testing::Contains("input_force")) << found.sentence;
        EXPECT_LT(found.rest.twins, 1.6 * rig.noise) << found.sentence;
        EXPECT_LE(found.error.front().after.rmse, found.error.front().before.rmse) << found.sentence;
    }
}

TEST(StandIns, ADragOneWayIsNoClock) {
    test::HeaveRig rig;
    rig.seconds = 40;
    for (const std::uint64_t seed : {1U, 2U}) {
        const Discovery found = found_in([](double, double, double w) { return w > 0 ? -12 * w * w : 0.0; }, seed, rig);
        EXPECT_EQ(found.mended, "") << found.sentence;
        EXPECT_NE(found.verdict, "none") << found.sentence;
        EXPECT_LT(found.error.front().after.rmse, found.error.front().before.rmse) << found.sentence;
    }
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
