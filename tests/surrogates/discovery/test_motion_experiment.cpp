// The next experiment of a coupled motion, done by the rig: its controller goes on and the wave is added to it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pitch_rig.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/motion/motion_controller.h"
#include "surrogates/discovery/motion/motion_experiment.h"

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
    dynamics::Measurements data = test::pitch_rig_runs(rig, 5, 15411);
    const Discovery before = found_in(data);
    EXPECT_NE(before.verdict, "effect") << before.sentence;
    EXPECT_GT(before.next_power, 0.9) << before.next_experiment;
    const core::Column& added = before.next_set_points.columns().back();
    EXPECT_EQ(added.name, "input_moment") << before.next_experiment;
    rig.added_moment = [&](double t) {
        const auto row = static_cast<std::size_t>(std::lround(t * rig.frequency));
        return added.numbers[std::min(row, added.numbers.size() - 1)];
    };
    for (dynamics::MeasuredRun& run : test::pitch_rig_runs(rig, 4, 20411).runs) {
        run.name += "-again";
        data.runs.push_back(run);
    }
    const Discovery after = found_in(data);
    ASSERT_EQ(after.verdict, "effect") << after.sentence;
    EXPECT_EQ(after.effects.front().name, "pitch_stiffness") << after.sentence;
    EXPECT_GT(after.effects.front().probability, 0.9) << after.sentence;
}

/// The likelihoods alone would settle it for certain; a name needs a held-out error that falls as well, which so weak a
/// damping hardly changes.
TEST_F(MotionExperimentDesign, PromisesNoMoreThanTheVerdictAfterItWouldSay) {
    PitchRig rig;
    rig.seconds = 8;
    rig.force = [](const PitchMoment& now) { return -0.032 * now.rise; };
    const Discovery found = found_in(test::pitch_rig_runs(rig, 5, 15451));
    EXPECT_EQ(found.verdict, "none") << found.sentence;
    EXPECT_LT(found.next_power, 0.3) << found.next_experiment;
    EXPECT_NE(found.next_experiment.find("with the controller that the logs show in the loop"), std::string::npos)
        << found.next_experiment;
}

/// u = g (target - y) - 3.75 g (y - s), s a mean of readings that follows by 0.15 of the difference: the answer to
/// readings is (-4.25 + 4.175 L) / (1 - 0.85 L) N/m, L one row back.
TEST_F(MotionExperimentDesign, ReadsTheControllerFromTheLogs) {
    PitchRig rig;
    rig.seconds = 20;
    const dynamics::Measurements data = test::pitch_rig_runs(rig, 4, 15402);
    core::Problems problems;
    const std::vector<MotionRecord> records =
        motion_records(dynamics::heave_pitch_motion(), model_, data, {0, 1, 2, 3}, problems);
    const MotionRig made_with{dynamics::heave_pitch_motion(),  model_, data, records,
                              {"input_force", "input_moment"}, {0, 2}, {}};
    const std::vector<InputAnswer> answers = read_controllers(made_with);
    ASSERT_EQ(answers.size(), 2U);
    ASSERT_EQ(answers[0].found, InputAnswer::Found::answers);
    ASSERT_EQ(answers[1].found, InputAnswer::Found::answers);
    // what it does over many rows to a gap that stays a metre higher, and at once
    const auto in_the_end = [](const InputAnswer& answer, std::size_t channel) {
        return (answer.reading[channel][0] + answer.reading[channel][1] + answer.reading[channel][2]) /
               (1 - answer.own[0] - answer.own[1]);
    };
    EXPECT_NEAR(answers[0].reading[0][0], -4.25, 0.1);
    EXPECT_NEAR(in_the_end(answers[0], 0), -0.5, 0.15);
    EXPECT_NEAR(answers[0].reading[1][0], 0, 0.1) << "the force does not answer the pitch";
    EXPECT_NEAR(answers[1].reading[1][0], -0.03 - 2e-4 / 0.04, 1e-3);
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
