// The next experiment of a coupled motion, done by the rig: its controller goes on and the wave is added to it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pitch_rig.h"
#include "surrogates/discovery/discovery.h"

namespace underbody::discovery {

namespace {

using test::PitchMoment;
using test::PitchRig;

class MotionExperimentDesign : public testing::Test {
protected:
    [[nodiscard]] Discovery found_in(const dynamics::Measurements& data) const {
        DiscoverOptions options;
        options.consequence = options.figures = false;
        return discover(model_, data, options);
    }
    core::TemporaryFolder folder_{"motion-experiment"};
    dynamics::Model model_ = test::pitch_rig_model(folder_.path());
};

}  // namespace

TEST_F(MotionExperimentDesign, SettlesWhatItSaysThatItWould) {
    PitchRig rig;
    rig.seconds = 8;
    rig.moment = [](const PitchMoment& now) { return -5e-4 * std::sin(now.pitch); };
    dynamics::Measurements data = test::pitch_rig_runs(rig, 5, 15410);
    const Discovery before = found_in(data);
    EXPECT_NE(before.verdict, "effect") << before.sentence;
    EXPECT_GT(before.next_power, 0.9) << before.next_experiment;
    const core::Column& added = before.next_set_points.columns().back();
    EXPECT_EQ(added.name, "input_moment") << before.next_experiment;
    rig.added_moment = [&](double t) {
        const auto row = static_cast<std::size_t>(std::lround(t * rig.frequency));
        return added.numbers[std::min(row, added.numbers.size() - 1)];
    };
    for (dynamics::MeasuredRun& run : test::pitch_rig_runs(rig, 4, 20410).runs) {
        run.name += "-again";
        data.runs.push_back(run);
    }
    const Discovery after = found_in(data);
    ASSERT_EQ(after.verdict, "effect") << after.sentence;
    EXPECT_EQ(after.effects.front().name, "pitch_stiffness") << after.sentence;
    EXPECT_GT(after.effects.front().probability, 0.9) << after.sentence;
}

/// A moment and a centre of mass off the middle differ by the cosine of a small pitch.
TEST_F(MotionExperimentDesign, SaysWhatNoRunOfThisRigTellsApart) {
    PitchRig rig;
    rig.seconds = 20;
    rig.moment = [](const PitchMoment&) { return 3e-4; };
    const Discovery found = found_in(test::pitch_rig_runs(rig, 6, 15401));
    ASSERT_FALSE(found.alternatives.empty());
    EXPECT_GT(found.alternatives.front().probability, 0.2) << found.sentence;
    EXPECT_NE(found.next_experiment.find("no experiment of this kind on this rig settles it"), std::string::npos)
        << found.next_experiment;
    EXPECT_LT(found.next_power, 0.05);
}

}  // namespace underbody::discovery
