// Runs on the ground: residual forces and yaw moment, effects in each, clean sets, and predictions as reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "surface_rig.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/residual.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "tests/support/support.h"

namespace underbody::discovery {

namespace {

using test::SurfaceMoment;
using test::SurfaceRig;

DiscoverOptions quick() {
    DiscoverOptions options;
    options.consequence = false;
    options.figures = false;
    return options;
}

class SurfaceDiscovery : public testing::Test {
protected:
    core::TemporaryFolder folder_{"surface"};
    dynamics::Model model_ = test::surface_rig_model(folder_.path());
};

TEST_F(SurfaceDiscovery, ACleanRigIsPredictedAtItsNoise) {
    const dynamics::Prediction found = dynamics::predict(model_, test::surface_rig_runs({}, 3, 51));
    EXPECT_EQ(found.motion, "surface");
    ASSERT_EQ(found.channels.size(), 3U);
    for (const dynamics::ChannelError& channel : found.channels) {
        EXPECT_LT(channel.in_noise, 1.3) << channel.name;
        EXPECT_GT(channel.in_noise, 0.8) << channel.name;
    }
}

TEST_F(SurfaceDiscovery, ResidualsAreInTheirAxes) {
    SurfaceRig rig;
    rig.turn = [](const SurfaceMoment&) { return 0.002; };
    const std::vector<Residual> turned = measured_residual(model_, test::surface_rig_runs(rig, 3, 52));
    ASSERT_EQ(turned.size(), 3U);
    EXPECT_EQ(turned[2].quantity, "yaw_moment");
    EXPECT_NEAR(turned[2].mean, 0.002, 2e-4);
    EXPECT_LT(std::abs(turned[0].mean), 5e-3);
    EXPECT_LT(std::abs(turned[1].mean), 5e-3);
    rig.turn = {};
    rig.surge = [](const SurfaceMoment&) { return -0.05; };
    EXPECT_NEAR(measured_residual(model_, test::surface_rig_runs(rig, 3, 53))[0].mean, -0.05, 5e-3);
}

struct Case {
    const char* name;
    double value;
    void (*change)(SurfaceRig& rig);
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class SurfaceEffects : public SurfaceDiscovery, public testing::WithParamInterface<Case> {};

TEST_P(SurfaceEffects, AreNamedWithTheirNumber) {
    SurfaceRig rig;
    GetParam().change(rig);
    const Discovery found = discover(model_, test::surface_rig_runs(rig, 5, 54), quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_EQ(found.effects.size(), 1U) << found.sentence;
    EXPECT_EQ(found.effects[0].name, GetParam().name) << found.sentence;
    const FoundParameter& number = found.effects[0].parameters[0];
    EXPECT_NEAR(number.value, GetParam().value, std::max(4 * number.sigma, 0.02 * std::abs(GetParam().value)))
        << found.sentence;
    EXPECT_LT(found.error.front().after.rmse, 0.8 * found.error.front().before.rmse);
}

INSTANTIATE_TEST_SUITE_P(Each, SurfaceEffects,
                         testing::Values(Case{"thrust_gain", 0.9, [](SurfaceRig& rig) { rig.thrust_gain = 0.9; }},
                                         Case{"jet_misalignment", 0.05, [](SurfaceRig& rig) { rig.jet_angle = 0.05; }},
                                         Case{"yaw_damping", 0.01,
                                              [](SurfaceRig& rig) {
                                                  rig.turn = [](const SurfaceMoment& now) { return -0.01 * now.rate; };
                                              }},
                                         Case{"sway_damping", 0.8,
                                              [](SurfaceRig& rig) {
                                                  rig.sway = [](const SurfaceMoment& now) { return -0.8 * now.across; };
                                              }}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_F(SurfaceDiscovery, IsSilentOnACleanRigWithWhiteOrColouredNoiseFedBack) {
    for (const double colour : {0.0, 0.9}) {
        SurfaceRig rig;
        rig.colour = colour;
        const Discovery found = discover(model_, test::surface_rig_runs(rig, 5, 55), quick());
        EXPECT_EQ(found.verdict, "none") << colour << ": " << found.sentence;
    }
}

TEST_F(SurfaceDiscovery, ReportsTheErrorThatPredictFindsOnTheHeldOutRuns) {
    SurfaceRig rig;
    rig.turn = [](const SurfaceMoment&) { return 0.002; };
    dynamics::Measurements data = test::surface_rig_runs(rig, 4, 56), held = data;
    data.runs.back().use = dynamics::RunUse::test;
    held.runs = {data.runs.back()};
    const Discovery found = discover(model_, data, quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects[0].name, "yaw_moment_offset") << found.sentence;
    ASSERT_EQ(found.axes.size(), 3U);
    EXPECT_LT(found.axes[2].rms_after, 0.5 * found.axes[2].rms_before);
    dynamics::Model declared = model_;
    declared.records = found.model.records;
    dynamics::write_model(found.model, folder_.path() / "found" / "model.toml");
    const dynamics::Model written = dynamics::read_model(folder_.path() / "found" / "model.toml");
    for (const bool after : {false, true}) {
        for (const dynamics::ChannelError& channel : dynamics::predict(after ? written : declared, held).channels) {
            const auto own = std::find_if(found.error.begin(), found.error.end(),
                                          [&](const ErrorChange& one) { return one.channel == channel.name; });
            ASSERT_NE(own, found.error.end());
            EXPECT_NEAR(channel.rmse, (after ? own->after : own->before).rmse, 1e-6 * channel.rmse) << channel.name;
        }
    }
}

/// Files as a user has them; their truth stands in tests/data/surface/README.md.
TEST(SurfaceExample, GetsItsTruth) {
    const std::filesystem::path folder = test::data_folder() / "surface";
    const dynamics::Model model = dynamics::read_model(folder / "model.toml");
    const Discovery found = discover(model, dynamics::read_measurements(folder / "runs"), quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects[0].name, "jet_misalignment") << found.sentence;
    const FoundParameter& angle = found.effects[0].parameters[0];
    EXPECT_NEAR(angle.value, 0.02, std::max(4 * angle.sigma, 1e-4)) << found.sentence;
}

TEST_F(SurfaceDiscovery, SaysWhatARunLacks) {
    dynamics::Measurements data = test::surface_rig_runs({}, 3, 57);
    core::Table table;
    for (const core::Column& column : data.runs[1].table.columns()) {
        if (column.name != "thrust_bow") {
            table.add_numbers(column.name, column.unit, column.numbers);
        }
    }
    data.runs[1].table = table;
    try {
        dynamics::predict(model_, data);
        FAIL() << "a run without a thrust is refused";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("run-2 lacks the thrust of the jet 'bow'"));
    }
}

}  // namespace

}  // namespace underbody::discovery
