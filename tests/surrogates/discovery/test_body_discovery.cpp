// Runs of the whole body: residual forces and moments in its axes, effects with their arms, predictions at the noise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "body_rig.h"
#include "core/file.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/residual.h"
#include "surrogates/dynamics/simulate/measured_motion.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/recorded_thrusts.h"

namespace underbody::discovery {

namespace {

using dynamics::make_use;
using test::BodyLoads;
using test::BodyMoment;
using test::BodyRig;

class BodyRuns : public testing::Test {
protected:
    void expect_at_noise(const dynamics::Model& model, const BodyRig& rig, std::size_t channels) const {
        const dynamics::Prediction found = dynamics::predict(model, test::body_rig_runs(rig, 3, 61));
        EXPECT_EQ(found.motion, "body");
        ASSERT_EQ(found.channels.size(), channels);
        for (const dynamics::ChannelError& channel : found.channels) {
            EXPECT_LT(channel.in_noise, 1.4) << channel.name;
            EXPECT_GT(channel.in_noise, 0.8) << channel.name;
        }
    }
    core::TemporaryFolder folder_{"body"};
    dynamics::Model model_ = test::body_rig_model(folder_.path());
};

TEST_F(BodyRuns, ACleanRigIsPredictedAtItsNoise) { expect_at_noise(model_, {}, 5); }

TEST_F(BodyRuns, SpeedsAndRatesServeWherePlacesAlongTheGroundAndHeadingWereNotRead) {
    BodyRig rig;
    rig.rates_only = true;
    expect_at_noise(model_, rig, 7);
}

// What a logger wrote of a ramp, and what simulate writes of a continuous command.
TEST_F(BodyRuns, ThrustsThatAreLinearBetweenTheirSamplesAreReadSo) {
    BodyRig rig;
    rig.linear = true;
    expect_at_noise(model_, rig, 5);
    const dynamics::Prediction found = dynamics::predict(model_, test::body_rig_runs(rig, 3, 61));
    EXPECT_EQ(found.input_between, "linear");
    EXPECT_EQ(found.input_between_from, "data");
    dynamics::Model held = model_;
    held.records.input_between = dynamics::RecordReading::Between::held;
    double worst = 0;
    for (const dynamics::ChannelError& channel : dynamics::predict(held, test::body_rig_runs(rig, 3, 61)).channels) {
        worst = std::max(worst, channel.in_noise);
    }
    EXPECT_GT(worst, 3);
    rig.linear = false;
    expect_at_noise(model_, rig, 5);
    EXPECT_EQ(dynamics::predict(model_, test::body_rig_runs(rig, 3, 61)).input_between, "held");
}

/// The rig's law against the effect's: with the effect in the model what is left is noise, without it is not.
struct Declared {
    const char* name;
    std::vector<dynamics::ParameterValue> values;
    void (*change)(BodyRig& rig);
};
void PrintTo(const Declared& one, std::ostream* out) { *out << one.name; }

class BodyEffects : public BodyRuns, public testing::WithParamInterface<Declared> {};

TEST_P(BodyEffects, PredictAtTheNoiseWhatTheyAreIn) {
    BodyRig rig;
    GetParam().change(rig);
    expect_at_noise(model_.with_effect(make_use(GetParam().name, GetParam().values)), rig, 5);
    double worst = 0;
    for (const dynamics::ChannelError& channel : dynamics::predict(model_, test::body_rig_runs(rig, 3, 61)).channels) {
        worst = std::max(worst, channel.in_noise);
    }
    EXPECT_GT(worst, 2);
}

BodyLoads none() { return {}; }

const std::vector<Declared> declared{
    {"thrust_gain", {{"gain", 0.9}}, [](BodyRig& rig) { rig.thrust_gain = 0.9; }},
    {"jet_misalignment", {{"angle", 0.05}}, [](BodyRig& rig) { rig.jet_angle = 0.05; }},
    {"mass_centre_offset", {{"distance", 3e-4}}, [](BodyRig& rig) { rig.mass_forward = 3e-4; }},
    {"mass_centre_aside", {{"offset", 0.01}}, [](BodyRig& rig) { rig.mass_aside = 0.01; }},
    {"added_mass", {{"mass", 1}}, [](BodyRig& rig) { rig.added_mass = 1; }},
    {"constant_force",
     {{"force", 0.02}},
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment&) {
             BodyLoads more = none();
             more[2] = 0.02;
             return more;
         };
     }},
    {"cable_pull",
     {{"along", 0.03}, {"across", 0.02}},
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) {
             const double c = std::cos(now.heading), s = std::sin(now.heading);
             return BodyLoads{0.03 * c + 0.02 * s, 0.02 * c - 0.03 * s, 0, 0, 0};
         };
     }},
    {"tether_with_arm",
     {{"stiffness", 0.3}, {"gap", 0.2}, {"arm", 0.05}},
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) {
             const double pull = -0.3 * (now.gap + 0.05 * std::sin(now.pitch) - 0.2);
             const double arm = 0.05 * std::cos(now.pitch) + 0.05 * std::sin(now.pitch);  // ahead, and the base's depth
             return BodyLoads{0, 0, pull, arm * pull, 0};
         };
     }},
    {"yaw_damping",
     {{"coefficient", 0.01}},
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) { return BodyLoads{0, 0, 0, 0, -0.01 * now.turn_rate}; };
     }},
    {"pitch_damping",
     {{"coefficient", 0.02}},
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) { return BodyLoads{0, 0, 0, -0.02 * now.nose_rate, 0}; };
     }},
};

INSTANTIATE_TEST_SUITE_P(Each, BodyEffects, testing::ValuesIn(declared),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_F(BodyRuns, ResidualsAreInTheirAxes) {
    const std::array<double, 5> sizes{0.03, 0.03, 0.02, 0.002, 0.002};
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
        BodyRig rig;
        BodyLoads more{};
        more[axis] = sizes[axis];
        rig.missing = [more](const BodyMoment&) { return more; };
        const std::vector<Residual> found = measured_residual(model_, test::body_rig_runs(rig, 3, 62));
        ASSERT_EQ(found.size(), 5U);
        for (std::size_t other = 0; other < sizes.size(); ++other) {
            EXPECT_NEAR(found[other].mean, more[other], 0.1 * sizes[other]) << found[other].quantity << " of " << axis;
        }
    }
}

// A random moment that makes up for what is missing follows a measured rate from reading to reading, as if the rate had
// no noise: the noise is looked for again beside the effect.
TEST_F(BodyRuns, TheNoiseOfARateIsItsSensorsThoughAnEffectIsMissing) {
    BodyRig rig;
    rig.rates_only = true;
    rig.frequency = 10;
    rig.seconds = 12;
    rig.jet_angle = 0.06;
    DiscoverOptions options;
    options.consequence = options.figures = false;
    options.candidates = {"jet_misalignment", "yaw_damping"};
    const Discovery found = discover(model_, test::body_rig_runs(rig, 4, 64), options);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects.front().name, "jet_misalignment");
    EXPECT_NEAR(found.noise.at("yaw_rate").value, 0.005, 0.001);
    EXPECT_TRUE(found.rest.is_noise) << found.sentence;
}

// One vehicle with a tracker, one with a gyro and a log of its speed: nothing is said of what no held-out run has.
TEST_F(BodyRuns, AChannelThatNoHeldOutRunHasHasNoError) {
    BodyRig rig;
    rig.seconds = 12;
    rig.thrust_gain = 0.9;
    dynamics::Measurements data = test::body_rig_runs(rig, 2, 65);
    rig.rates_only = true;
    dynamics::Measurements others = test::body_rig_runs(rig, 2, 66);
    for (dynamics::MeasuredRun& run : others.runs) {
        run.name += "-rates";
        data.runs.push_back(run);
    }
    data.runs.back().use = dynamics::RunUse::test;
    DiscoverOptions options;
    options.consequence = options.figures = false;
    options.candidates = {"thrust_gain"};
    const Discovery found = discover(model_, data, options);
    EXPECT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_FALSE(found.error.empty());
    for (const ErrorChange& change : found.error) {
        EXPECT_GT(change.before.rmse, 0) << change.channel;
        EXPECT_NE(change.channel, "position_x");
        EXPECT_NE(change.channel, "heading");
    }
}

/// The runs with one column changed.
dynamics::Measurements changed(dynamics::Measurements data, const std::string& name,
                               const std::function<void(std::vector<double>&)>& change) {
    for (dynamics::MeasuredRun& run : data.runs) {
        core::Table table;
        table.source = run.table.source;
        for (const core::Column& column : run.table.columns()) {
            std::vector<double> values = column.numbers;
            if (column.name == name || name.empty()) {
                change(values);
            }
            table.add_numbers(column.name, column.unit, values);
        }
        run.table = table;
    }
    return data;
}

std::string refusal(const dynamics::Model& model, const dynamics::Measurements& data) {
    try {
        dynamics::predict(model, data);
    } catch (const core::InputError& error) {
        return error.what();
    }
    return "none";
}

TEST_F(BodyRuns, SayWhichColumnHasNoValue) {
    const dynamics::Measurements data = test::body_rig_runs({}, 2, 63);
    const auto nothing = [](std::vector<double>& values) { std::fill(values.begin(), values.end(), std::nan("")); };
    EXPECT_THAT(refusal(model_, changed(data, "thrust_bow", nothing)),
                testing::HasSubstr("the column thrust_bow has no value"));
    EXPECT_THAT(refusal(model_, changed(data, "pitch", nothing)), testing::HasSubstr("has no value of pitch"));
    EXPECT_THAT(refusal(model_, changed(data, "heading", nothing)), testing::HasSubstr("no heading and no yaw_rate"));
    EXPECT_THAT(refusal(model_, changed(data, "position_y", nothing)), testing::HasSubstr("no places"));
}

// Rows of other sensors stand between the samples of a thrust; the first may come before it.
TEST_F(BodyRuns, AThrustActsBetweenItsSamplesAndAsItsFirstBeforeIt) {
    const dynamics::Measurements data = test::body_rig_runs({}, 2, 63);
    const dynamics::MeasuredRun& run = data.runs[0];
    const std::vector<double> thrust = run.table.numbers("thrust_bow");
    const auto with_gaps = [&](bool linear) {
        const dynamics::Measurements gaps = changed(data, "thrust_bow", [](std::vector<double>& values) {
            for (const std::size_t k : {0, 1, 2, 3, 5}) {
                values[k] = std::nan("");
            }
        });
        EXPECT_TRUE(dynamics::column_moves(gaps.runs[0], "thrust_bow"));
        dynamics::RecordReading reading;
        reading.input_between =
            linear ? dynamics::RecordReading::Between::linear : dynamics::RecordReading::Between::held;
        dynamics::RecordedThrusts recorded(model_, gaps.runs[0], reading);
        EXPECT_EQ(recorded.remarks().size(), 1U) << "0.16 s without a value";
        EXPECT_EQ(recorded.at(0, 0.0)[2], thrust[4]);
        return recorded.at(5, 0.0)[2];
    };
    EXPECT_EQ(with_gaps(false), thrust[4]);
    EXPECT_NEAR(with_gaps(true), 0.5 * (thrust[4] + thrust[6]), 1e-12);
}

TEST_F(BodyRuns, ShorterThanTheHorizonArePredictedOverAQuarter) {
    const dynamics::Measurements data =
        changed(test::body_rig_runs({}, 2, 63), "", [](std::vector<double>& values) { values.resize(40); });
    const dynamics::Prediction found = dynamics::predict(model_, data);
    EXPECT_NEAR(found.horizon, 0.25 * 39 / 25, 1e-9);
    EXPECT_THAT(found.remarks.back().message, testing::HasSubstr("predicted over 0.39 s"));
}

// A model so wrong that its body tips over tells that it is wrong, not that nothing can be predicted.
TEST_F(BodyRuns, AModelThatTipsOverRunsAway) {
    const dynamics::Measurements data = test::body_rig_runs({}, 2, 61);
    for (const double height : {-0.005, -0.05}) {
        model_.vehicle.buoyancy_height = height;
        const dynamics::Prediction found = dynamics::predict(model_, data);
        EXPECT_GT(found.diverged, found.windows / 2) << height;
        EXPECT_THAT(found.remarks.back().message, testing::HasSubstr("away from every bound"));
        for (const dynamics::ChannelError& channel : found.channels) {
            EXPECT_LT(channel.in_noise, 1e4) << channel.name;
        }
    }
}

TEST_F(BodyRuns, SayWhatTheyLackAndWhatIsLeftOut) {
    dynamics::Measurements data = test::body_rig_runs({}, 3, 63);
    core::Table table;
    for (const core::Column& column : data.runs[1].table.columns()) {
        if (column.name != "heading") {
            table.add_numbers(column.name, column.unit, column.numbers);
        }
    }
    const core::Table whole = data.runs[1].table;
    data.runs[1].table = table;
    try {
        dynamics::predict(model_, data);
        FAIL() << "a run without heading and yaw rate is refused";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("run-2 of the whole body has no heading and no yaw_rate"));
    }
    data.runs[1].table = whole;
    std::vector<double> roll(whole.rows(), 0.0);
    roll[40] = -0.12;
    data.runs[1].table.add_numbers("roll", "rad", roll);
    bool said = false;
    for (const core::Problem& one : dynamics::predict(model_, data).remarks) {
        said = said || one.message.find("run-2: the roll reaches 6.88 deg") != std::string::npos;
    }
    EXPECT_TRUE(said);
}

}  // namespace

}  // namespace underbody::discovery
