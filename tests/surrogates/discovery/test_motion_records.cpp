// What of the logs of a coupled motion is no effect: inputs that come late or are turned round, and a zero that was set
// anew for each run; and a wave, which has to be looked for by frequency.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pitch_rig.h"
#include "surface_rig.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::discovery {

namespace {

using test::PitchMoment;
using test::PitchRig;

Discovery found_in(const dynamics::Model& model, const dynamics::Measurements& data) {
    DiscoverOptions options;
    options.consequence = false;
    options.figures = false;
    return discover(model, data, options);
}

PitchRig short_rig() {
    PitchRig rig;
    rig.seconds = 20;
    return rig;
}

class MotionRecords : public testing::Test {
protected:
    core::TemporaryFolder folder_{"motion-records"};
    dynamics::Model model_ = test::pitch_rig_model(folder_.path());

    /// Of the model as written, over runs that nothing saw, gap first.
    dynamics::Prediction fresh_error(const Discovery& found, PitchRig rig) {
        dynamics::write_model(found.model, folder_.path() / "found" / "model.toml");
        rig.gain = 1.3;
        return dynamics::predict(dynamics::read_model(folder_.path() / "found" / "model.toml"),
                                 test::pitch_rig_runs(rig, 3, 1571));
    }

    void expect_moved(const Discovery& found, const PitchRig& rig) {
        EXPECT_NEAR(found.model.records.input_advance, 0.2, 0.02) << found.sentence;
        EXPECT_NEAR(found.model.records.others_advance, 0.2, 0.02) << found.sentence;
        EXPECT_NE(found.mended, "");
        const dynamics::Prediction fresh = fresh_error(found, rig);
        EXPECT_LT(fresh.channels.at(0).in_noise, 1.3) << found.sentence;
        EXPECT_LT(fresh.channels.at(1).in_noise, 1.3) << found.sentence;
    }

    void expect_turned(const Discovery& found, const PitchRig& rig) {
        EXPECT_EQ(found.verdict, "none") << found.sentence;
        EXPECT_EQ(found.model.records.factor_of("input_force"), rig.logged_force) << found.sentence;
        EXPECT_EQ(found.model.records.factor_of("input_moment"), rig.logged_moment) << found.sentence;
        EXPECT_LT(fresh_error(found, rig).channels.at(1).in_noise, 1.3) << found.sentence;
    }
};

}  // namespace

TEST_F(MotionRecords, LateInputsAreMovedAndTheModelSaysSo) {
    PitchRig rig = short_rig();
    rig.late = 5;
    const Discovery found = found_in(model_, test::pitch_rig_runs(rig, 6, 1570));
    EXPECT_EQ(found.verdict, "none") << found.sentence;
    expect_moved(found, rig);
}

TEST_F(MotionRecords, LateInputsAreMovedBesideAnEffect) {
    PitchRig rig = short_rig();
    rig.late = 5;
    rig.force = [](const PitchMoment& now) { return -0.3 * now.rise; };
    const Discovery found = found_in(model_, test::pitch_rig_runs(rig, 6, 1570));
    ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
    EXPECT_EQ(found.effects[0].name, "linear_damping") << found.sentence;
    expect_moved(found, rig);
}

TEST_F(MotionRecords, AForceOfTheOtherSignIsTurnedAndNoEffect) {
    PitchRig rig = short_rig();
    rig.logged_force = -1;
    expect_turned(found_in(model_, test::pitch_rig_runs(rig, 6, 1572)), rig);
}

TEST_F(MotionRecords, AMomentOfTheOtherSignIsTurnedAndNoEffect) {
    PitchRig rig = short_rig();
    rig.logged_moment = -1;
    expect_turned(found_in(model_, test::pitch_rig_runs(rig, 6, 1572)), rig);
}

TEST_F(MotionRecords, AZeroThatIsSetAnewForEachRunIsSaidRunByRun) {
    PitchRig rig = short_rig();
    const std::array<double, 6> zeros{4e-3, -4e-3, 3e-3, -3e-3, 5e-3, -5e-3};
    rig.zero = [&](std::size_t run) { return zeros.at(run); };
    const Discovery found = found_in(model_, test::pitch_rig_runs(rig, 6, 1573));
    EXPECT_EQ(found.verdict, "unknown") << found.sentence;
    EXPECT_TRUE(found.model.effects.empty()) << found.sentence;
    ASSERT_TRUE(found.by_run) << found.sentence;
    EXPECT_NE(found.sentence.find("differs from run to run"), std::string::npos) << found.sentence;
    if (found.by_run->name == "gap_sensor_bias") {
        for (std::size_t i = 0; i < found.by_run->runs.size(); ++i) {
            const auto run = static_cast<std::size_t>(std::stoi(found.by_run->runs[i].substr(4))) - 1;
            EXPECT_NEAR(found.by_run->value[i], zeros.at(run), 5 * found.by_run->sigma[i]) << found.by_run->runs[i];
        }
    }
}

TEST_F(MotionRecords, AWaveIsNamedWithItsFrequency) {
    PitchRig rig = short_rig();
    rig.force = [](const PitchMoment& now) { return 8e-3 * std::sin(2 * 3.14159265 * 0.37 * now.t + 1); };
    const Discovery found = found_in(model_, test::pitch_rig_runs(rig, 6, 1574));
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
    EXPECT_EQ(found.effects[0].name, "periodic_disturbance") << found.sentence;
    EXPECT_NEAR(found.effects[0].parameters.at(0).value, 8e-3, 4e-4) << found.sentence;
    EXPECT_NEAR(found.effects[0].parameters.at(1).value, 0.37, 2e-3) << found.sentence;
}

TEST(MotionRecordsOnTheGround, OneJetOfTheOtherSignIsTurnedAndNoEffect) {
    const core::TemporaryFolder folder("motion-records-ground");
    const dynamics::Model model = test::surface_rig_model(folder.path());
    dynamics::Measurements data = test::surface_rig_runs({}, 5, 1575);
    const std::string jet = "thrust_" + model.jets.back().name;
    for (dynamics::MeasuredRun& run : data.runs) {
        core::Table table;
        table.source = run.table.source;
        for (const core::Column& column : run.table.columns()) {
            std::vector<double> values = column.numbers;
            for (double& value : values) {
                value *= column.name == jet ? -1 : 1;
            }
            table.add_numbers(column.name, column.unit, values);
        }
        run.table = std::move(table);
    }
    const Discovery found = found_in(model, data);
    EXPECT_EQ(found.model.records.factor_of(jet), -1) << found.sentence;
    EXPECT_EQ(found.verdict, "none") << found.sentence;
    dynamics::write_model(found.model, folder.path() / "found" / "model.toml");
    EXPECT_EQ(dynamics::read_model(folder.path() / "found" / "model.toml").records, found.model.records);
}

}  // namespace underbody::discovery
