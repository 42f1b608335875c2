// Runs of heave with pitch: residual force and moment, effects in either, clean sets, and predictions as reported.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pitch_rig.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/motion/motion_experiment.h"
#include "surrogates/discovery/residual.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/motion_predict.h"
#include "surrogates/dynamics/simulate/pitch_run.h"
#include "tests/support/support.h"

namespace underbody::discovery {

namespace {

using test::PitchMoment;
using test::PitchRig;

DiscoverOptions quick() {
    DiscoverOptions options;
    options.horizon = 1;
    options.consequence = false;
    options.figures = false;
    return options;
}

PitchRig short_rig() {
    PitchRig rig;
    rig.seconds = 20;
    return rig;
}

const ErrorChange& error_of(const Discovery& found, const std::string& channel) {
    for (const ErrorChange& change : found.error) {
        if (change.channel == channel) {
            return change;
        }
    }
    throw std::runtime_error("no error of " + channel);
}

class HeavePitchDiscovery : public testing::Test {
protected:
    core::TemporaryFolder folder_{"heave-pitch"};
    dynamics::Model model_ = test::pitch_rig_model(folder_.path());
};

TEST_F(HeavePitchDiscovery, ResidualHasAForceAndAMoment) {
    PitchRig rig = short_rig();
    rig.moment = [](const PitchMoment&) { return 0.002; };
    const std::vector<Residual> both = measured_residual(model_, test::pitch_rig_runs(rig, 3, 41));
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[0].quantity, "lift_force");
    EXPECT_EQ(both[1].quantity, "pitch_moment");
    EXPECT_NEAR(both[1].mean, 0.002, 1e-4);
    EXPECT_LT(std::abs(both[0].mean), 2e-3);
    EXPECT_LT(both[0].root_mean_square, 3 * both[0].sigma);
    rig.moment = {};
    rig.force = [](const PitchMoment&) { return 0.02; };
    const std::vector<Residual> other = measured_residual(model_, test::pitch_rig_runs(rig, 3, 42));
    EXPECT_NEAR(other[0].mean, 0.02, 2e-3);
    EXPECT_LT(std::abs(other[1].mean), 1e-4);
}

TEST_F(HeavePitchDiscovery, NamesAnEffectInTheMomentAndPredictsAsReported) {
    PitchRig rig = short_rig();
    rig.moment = [](const PitchMoment& now) { return 0.015 * std::cos(now.pitch) * now.input; };
    const dynamics::Measurements data = test::pitch_rig_runs(rig, 5, 43);
    const Discovery found = discover(model_, data, quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
    EXPECT_EQ(found.effects[0].name, "input_arm") << found.sentence;
    const FoundParameter& arm = found.effects[0].parameters[0];
    EXPECT_NEAR(arm.value, 0.015, std::max(4 * arm.sigma, 1e-4)) << found.sentence;
    const ErrorChange& pitch = error_of(found, "pitch");
    EXPECT_EQ(found.error.front().channel, "pitch");
    EXPECT_GT(pitch.before.rmse, 2 * pitch.after.rmse);
    EXPECT_LT(pitch.after.rmse, 1.5 * pitch.noise);
    EXPECT_NEAR(pitch.noise, rig.pitch_noise, 0.1 * rig.pitch_noise);  // what is missing is not taken for noise
    const nlohmann::json json = to_json(found);
    EXPECT_EQ(json.at("motion"), "heave_pitch");
    ASSERT_EQ(json.at("axes").size(), 2U);
    EXPECT_EQ(json.at("axes")[1].at("quantity"), "pitch_moment");
    EXPECT_LT(json.at("axes")[1].at("after").at("rms").get<double>(),
              0.5 * json.at("axes")[1].at("before").at("rms").get<double>());
    // the model as written predicts runs that nothing saw as it was said of those held out
    dynamics::write_model(found.model, folder_.path() / "found" / "model.toml");
    const dynamics::Model written = dynamics::read_model(folder_.path() / "found" / "model.toml");
    dynamics::PredictOptions options;
    options.horizon = 1;
    rig.gain = 1.4;
    const dynamics::Measurements fresh = test::pitch_rig_runs(rig, 3, 1043);
    const dynamics::Prediction before = dynamics::predict(model_, fresh, options);
    const dynamics::Prediction after = dynamics::predict(written, fresh, options);
    ASSERT_EQ(after.channels.size(), 2U);
    EXPECT_EQ(after.channels[1].name, "pitch");
    EXPECT_NEAR(after.channels[1].rmse, pitch.after.rmse, 0.15 * pitch.after.rmse);
    EXPECT_GT(before.channels[1].rmse, 2 * after.channels[1].rmse);
}

TEST_F(HeavePitchDiscovery, ReportsTheErrorThatPredictFindsOnTheHeldOutRuns) {
    PitchRig rig = short_rig();
    rig.moment = [](const PitchMoment&) { return 0.001; };
    dynamics::Measurements data = test::pitch_rig_runs(rig, 4, 44);
    data.runs.back().use = dynamics::RunUse::test;
    const Discovery found = discover(model_, data, quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    dynamics::Measurements test = data;
    test.runs = {data.runs.back()};
    dynamics::PredictOptions options;
    options.horizon = 1;
    dynamics::Model declared = model_;
    declared.records = found.model.records;
    const dynamics::Prediction before = dynamics::predict(declared, test, options);
    const dynamics::Prediction after = dynamics::predict(found.model, test, options);
    for (const dynamics::ChannelError& channel : after.channels) {
        EXPECT_NEAR(channel.rmse, error_of(found, channel.name).after.rmse, 1e-9 * channel.rmse);
    }
    for (const dynamics::ChannelError& channel : before.channels) {
        EXPECT_NEAR(channel.rmse, error_of(found, channel.name).before.rmse, 1e-9 * channel.rmse);
    }
}

/// Every so many readings of gap and pitch far off, a gap far below the ground among them.
void spoil(dynamics::Measurements& data) {
    for (dynamics::MeasuredRun& run : data.runs) {
        core::Table spoilt;
        for (const core::Column& column : run.table.columns()) {
            std::vector<double> values = column.numbers;
            for (std::size_t i = 0; i < values.size(); ++i) {
                values[i] += column.name == "gap" && i % 97 == 40     ? (i % 2 == 0 ? 0.5 : -0.5)
                             : column.name == "pitch" && i % 89 == 11 ? 0.4
                                                                      : 0.0;
            }
            spoilt.add_numbers(column.name, column.unit, values);
        }
        spoilt.source = run.table.source;
        run.table = spoilt;
    }
}

TEST_F(HeavePitchDiscovery, WildReadingsAreNoEffectNoTouchAndNoError) {
    PitchRig rig = short_rig();
    rig.moment = [](const PitchMoment& now) { return 0.015 * std::cos(now.pitch) * now.input; };
    dynamics::Measurements data = test::pitch_rig_runs(rig, 5, 43), fresh = test::pitch_rig_runs(rig, 3, 1043);
    data.motion = "";  // seen from the pitch, which moves by more than its noise without its wild readings too
    const std::vector<MotionRecord> whole = [&] {
        core::Problems problems;
        return motion_records(dynamics::heave_pitch_motion(), model_, data, {0, 1, 2, 3, 4}, problems);
    }();
    spoil(data);
    core::Problems problems;
    const std::vector<MotionRecord> records =
        motion_records(dynamics::heave_pitch_motion(), model_, data, {0, 1, 2, 3, 4}, problems);
    ASSERT_EQ(records.size(), whole.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_EQ(records[i].last, whole[i].last) << records[i].name;
    }
    const Discovery found = discover(model_, data, quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
    EXPECT_EQ(found.effects[0].name, "input_arm") << found.sentence;
    EXPECT_LT(error_of(found, "pitch").after.rmse, 1.3 * rig.pitch_noise);
    spoil(fresh);
    const dynamics::Prediction after = dynamics::predict(found.model, fresh);
    for (const dynamics::ChannelError& channel : after.channels) {
        EXPECT_LT(channel.in_noise, 1.5) << channel.name;
    }
    const auto says = [](const core::Problems& among, const std::string& text) {
        return std::any_of(among.begin(), among.end(),
                           [&](const core::Problem& one) { return one.message.find(text) != std::string::npos; });
    };
    for (const core::Problems& among : {after.remarks, found.problems}) {
        EXPECT_TRUE(says(among, "gap readings of ")) << found.sentence;
        EXPECT_TRUE(says(among, "pitch readings of ")) << found.sentence;
    }
}

/// An actuator at three quarters of what is recorded was an added inertia, a factor of the table and a damping.
TEST_F(HeavePitchDiscovery, NamesAnActuatorThatTurnsTheBodyLess) {
    dynamics::Measurements data = test::pitch_rig_runs(short_rig(), 5, 71);
    for (dynamics::MeasuredRun& run : data.runs) {
        core::Table table;
        for (const core::Column& column : run.table.columns()) {
            std::vector<double> values = column.numbers;
            for (double& value : values) {
                value /= column.name == "input_moment" ? 0.75 : 1;
            }
            table.add_numbers(column.name, column.unit, values);
        }
        run.table = table;
    }
    const Discovery found = discover(model_, data, quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
    EXPECT_EQ(found.effects[0].name, "moment_gain") << found.sentence;
    const FoundParameter& gain = found.effects[0].parameters[0];
    EXPECT_NEAR(gain.value, 0.75, std::max(4 * gain.sigma, 0.01)) << found.sentence;
    dynamics::PredictOptions options;
    options.horizon = 1;
    EXPECT_LT(dynamics::predict(found.model, data, options).channels[1].in_noise, 1.4);
    for (dynamics::MeasuredRun& run : data.runs) {  // without such a column it is not looked for
        core::Table table;
        for (const core::Column& column : run.table.columns()) {
            if (column.name != "input_moment") {
                table.add_numbers(column.name, column.unit, column.numbers);
            }
        }
        run.table = table;
    }
    for (const FoundEffect& effect : discover(model_, data, quick()).alternatives) {
        EXPECT_EQ(effect.name.find("moment_gain"), std::string::npos);
    }
}

TEST_F(HeavePitchDiscovery, NamesAnEffectInTheForce) {
    PitchRig rig = short_rig();
    rig.force = [](const PitchMoment& now) { return -0.5 * now.rise; };
    const Discovery found = discover(model_, test::pitch_rig_runs(rig, 5, 45), quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects[0].name, "linear_damping") << found.sentence;
    const FoundParameter& value = found.effects[0].parameters[0];
    EXPECT_NEAR(value.value, 0.5, std::max(4 * value.sigma, 0.01)) << found.sentence;
    EXPECT_EQ(found.error.front().channel, "gap");
    EXPECT_LT(found.axes[0].rms_after, 0.5 * found.axes[0].rms_before);
}

/// A ring of lift in the gap, and a wave of it over the pitch: laws that no effect of the catalogue resembles.
TEST_F(HeavePitchDiscovery, PutsALawWithoutANameIntoTheModel) {
    const std::vector<std::pair<std::string, std::function<double(const PitchMoment&)>>> laws = {
        {"gap", [](const PitchMoment& now) { return 0.02 * std::sin(now.gap / 0.02); }},
        {"pitch", [](const PitchMoment& now) { return 0.02 * std::cos(now.pitch / 0.025); }}};
    for (const auto& [over, law] : laws) {
        PitchRig rig = short_rig();
        rig.force = law;
        const Discovery found = discover(model_, test::pitch_rig_runs(rig, 6, 61), quick());
        ASSERT_EQ(found.verdict, "unknown") << found.sentence;
        EXPECT_EQ(found.depends_on, std::vector<std::string>{over}) << found.sentence;
        ASSERT_EQ(found.effects.size(), 1U);
        ASSERT_EQ(found.effects[0].uses.size(), 1U) << found.sentence;
        EXPECT_NE(found.sentence.find("A smooth correction was put into the model"), std::string::npos)
            << found.sentence;
        const ErrorChange& gap = error_of(found, "gap");
        EXPECT_LT(gap.after.rmse, 0.5 * gap.before.rmse) << found.sentence;
        // as large as the law and no larger
        const tables::ForceTable& table = *found.effects[0].uses[0].table;
        EXPECT_LT(
            *std::max_element(table.points().numbers("lift_force").begin(), table.points().numbers("lift_force").end()),
            1.5 * 0.02);
        // the model as written predicts runs of another controller that nothing saw
        dynamics::write_model(found.model, folder_.path() / over / "model.toml");
        const dynamics::Model written = dynamics::read_model(folder_.path() / over / "model.toml");
        dynamics::PredictOptions options;
        options.horizon = 1;
        rig.gain = 1.3;
        const dynamics::Measurements fresh = test::pitch_rig_runs(rig, 4, 1061);
        const double before = dynamics::predict(model_, fresh, options).channels[0].rmse;
        const double after = dynamics::predict(written, fresh, options).channels[0].rmse;
        EXPECT_LT(after, 0.6 * before) << over;
    }
}

TEST_F(HeavePitchDiscovery, IsSilentOnACleanRigWithWhiteOrColouredNoiseFedBack) {
    for (const double colour : {0.0, 0.9}) {
        PitchRig rig = short_rig();
        rig.colour = colour;
        const Discovery found = discover(model_, test::pitch_rig_runs(rig, 5, 46), quick());
        EXPECT_EQ(found.verdict, "none") << colour << ": " << found.sentence;
        EXPECT_TRUE(found.effects.empty());
    }
}

TEST_F(HeavePitchDiscovery, TakesPitchAsItMovesAndNotAtItsMean) {
    const PitchRig rig = short_rig();
    dynamics::Measurements data = test::pitch_rig_runs(rig, 1, 47);
    data.motion.clear();
    EXPECT_TRUE(dynamics::moves_in_pitch(model_, data));
    dynamics::PredictOptions options;
    options.horizon = 4;  // long enough for a lift that is off to show
    const dynamics::Prediction moving = dynamics::predict(model_, data, options);
    EXPECT_EQ(moving.motion, "heave_pitch");
    ASSERT_EQ(moving.channels.size(), 2U);
    EXPECT_LT(moving.channels[0].in_noise, 1.4);
    EXPECT_LT(moving.channels[1].in_noise, 1.4);
    // with the pitch held at its mean the gap is not predicted as well
    dynamics::Measurements held = data;
    held.motion = "heave";
    std::vector<double> pitch = data.runs[0].table.numbers("pitch");
    const double middle = mean(pitch);
    core::Table table;
    for (const core::Column& column : data.runs[0].table.columns()) {
        table.add_numbers(column.name, column.unit,
                          column.name == "pitch" ? std::vector<double>(pitch.size(), middle) : column.numbers);
    }
    held.runs[0].table = table;
    const dynamics::Prediction flat = dynamics::predict(model_, held, options);
    EXPECT_GT(flat.channels[0].rmse, 1.3 * moving.channels[0].rmse);
    // a guide that holds the pitch: noise alone is no motion
    dynamics::Measurements guided = data;
    core::Random random(5);
    core::Table still;
    for (const core::Column& column : data.runs[0].table.columns()) {
        std::vector<double> values = column.numbers;
        for (double& value : values) {
            value = column.name == "pitch" ? 1e-3 * random.normal() : value;
        }
        still.add_numbers(column.name, column.unit, values);
    }
    guided.runs[0].table = still;
    EXPECT_FALSE(dynamics::moves_in_pitch(model_, guided));
}

/// Files as a user has them; their truth stands in tests/data/heave-pitch/README.md.
TEST(HeavePitchExample, GetsItsTruth) {
    const std::filesystem::path folder = test::data_folder() / "heave-pitch";
    const dynamics::Model model = dynamics::read_model(folder / "model.toml");
    DiscoverOptions options = quick();
    options.horizon = 2;
    const Discovery found = discover(model, dynamics::read_measurements(folder / "runs"), options);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects[0].name, "input_arm") << found.sentence;
    const FoundParameter& arm = found.effects[0].parameters[0];
    EXPECT_NEAR(arm.value, 0.008, std::max(4 * arm.sigma, 1e-4)) << found.sentence;
}

TEST_F(HeavePitchDiscovery, TheLinearFilterOfTheNoiseSearchAgreesWithTheFilter) {
    PitchRig rig = short_rig();
    rig.colour = 0.9;
    const dynamics::Measurements data = test::pitch_rig_runs(rig, 1, 49);
    core::Problems problems;
    const std::vector<MotionRecord> records =
        motion_records(dynamics::heave_pitch_motion(), model_, data, {0}, problems);
    dynamics::PitchRun run(model_, data.runs[0], model_.records);
    MotionNoise noise;
    noise.white = {1e-4, 0, 3e-4, 0};
    noise.load[0] = 1e-3;
    noise.load[1] = 1e-5;
    const LinearMotionRun about = linear_motion(run, records[0], noise);
    std::vector<double> innovations;
    EXPECT_NEAR(linear_cost(about, noise), about.cost, 0.3) << "at the noise of the path only its bends differ";
    for (const double slow : {0.0, 1.5e-4}) {
        for (const double force : {3e-4, 5e-3}) {
            MotionNoise other = noise;
            other.slow[0] = slow;
            other.slow[2] = 2 * slow;
            other.load[0] = force;
            const double exact = filter_motion(run, records[0], other, innovations);
            const double scale = std::abs(exact - about.cost);
            EXPECT_GT(scale, 20) << "the noise makes a difference";
            EXPECT_NEAR(linear_cost(about, other), exact, 0.02 * scale + 0.5) << slow << " " << force;
        }
    }
}

TEST_F(HeavePitchDiscovery, LinearAnswersAreThoseOfTheFilter) {
    const dynamics::Measurements data = test::pitch_rig_runs(short_rig(), 1, 48);
    core::Problems problems;
    const MotionExperiment experiment(dynamics::heave_pitch_motion(), model_, data,
                                      motion_records(dynamics::heave_pitch_motion(), model_, data, {0}, problems));
    MotionNoise noise;
    noise.white = {2e-4, 1e-3, 5e-4, 1e-2};
    noise.load[0] = 1e-3;
    noise.load[1] = 1e-5;
    std::vector<double> base, there;
    std::vector<MotionTrace> traces;
    experiment.evaluate({}, noise, base, nullptr, &traces);
    const DesignMatrix linear = experiment.answers(MotionSmooth{1, {}, {}}, traces);
    ASSERT_EQ(linear.columns, 1U);
    const double small = 1e-5;
    experiment.evaluate({dynamics::make_use("moment_offset", {{"moment", small}})}, noise, there);
    double error = 0, size = 0;
    for (std::size_t i = 0; i < base.size(); ++i) {
        error += std::pow((there[i] - base[i]) / small - linear.values[i], 2);
        size += std::pow(linear.values[i], 2);
    }
    EXPECT_LT(std::sqrt(error / size), 0.03);
}

/// How coloured noise changes from reading to reading is known far better than its size and its time.
TEST_F(HeavePitchDiscovery, ColouredNoiseIsFoundWithItsSizeAndItsTime) {
    test::PitchRig rig;
    rig.seconds = 8;
    rig.colour = 0.9;
    for (const std::uint64_t seed : {15411, 15412, 15413, 15414}) {
        const dynamics::Measurements data = test::pitch_rig_runs(rig, 7, seed);
        core::Problems problems;
        const MotionExperiment experiment(
            dynamics::heave_pitch_motion(), model_, data,
            motion_records(dynamics::heave_pitch_motion(), model_, data, {0, 1, 2, 3, 4, 5, 6}, problems));
        MotionNoise noise;  // begun as discover() begins, with how readings scatter
        noise.white = {9e-5, 0, 2.2e-4, 0};
        noise.load[0] = 4e-3;
        noise.load[1] = 1e-5;
        experiment.fit_noise({}, noise);
        EXPECT_NEAR(noise.total(0), rig.gap_noise, 0.2 * rig.gap_noise) << seed;
        EXPECT_NEAR(noise.total(2), rig.pitch_noise, 0.2 * rig.pitch_noise) << seed;
        EXPECT_NEAR(noise.slow_time, -0.04 / std::log(rig.colour), 0.13) << seed;
    }
}

}  // namespace

}  // namespace underbody::discovery
