// Every static effect of the catalogue once through the loop: named, written, read back, and better on data that nobody
// fitted.
#include <gtest/gtest.h>

#include <array>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/dynamics/simulate/predict.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

constexpr double noise = 2e-3;

/// Lift and drag over gap and speed; `jet`: lift over gap and voltage instead; `two`: both sources at once.
dynamics::Model rig(const std::filesystem::path& folder, const std::string& kind) {
    std::string glide = "gap [m], lift_force [N], drag_force [N]\n";
    std::string jet = "gap [m], lift_force [N]\n";
    for (int k = 0; k <= 120; ++k) {
        const double h = 0.0005 * std::pow(600.0, k / 120.0);
        glide += test::written(h) + ", " +
                 test::written(0.05 - 0.6 * std::exp(-h / 0.02) * (1 - 0.5 * std::exp(-h / 0.002))) + ", " +
                 test::written(0.15 + 0.2 * std::exp(-h / 0.003)) + "\n";
        jet += test::written(h) + ", " + test::written(2 * test::lift_of(h)) + "\n";
    }
    core::write_file(folder / "glide.csv", glide);
    core::write_file(folder / "jet.csv", jet);
    const std::string by_speed = "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n";
    std::string text = "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = 1.7\nnet_weight = 0.03\n";
    if (kind != "jet") {
        text += "[[force]]\nquantity = \"lift_force\"\ntable = \"glide.csv\"\n" + by_speed;
    }
    if (kind == "glide") {
        text += "[[force]]\nquantity = \"drag_force\"\ntable = \"glide.csv\"\n" + by_speed;
    }
    if (kind != "glide") {
        text +=
            "[[force]]\nquantity = \"lift_force\"\ntable = \"jet.csv\"\nscale.jet_voltage = { reference = \"10 V\", "
            "exponent = 2 }\n";
    }
    core::write_file(folder / "model.toml", text);
    return dynamics::read_model(folder / "model.toml");
}

dynamics::Measurements measure(const dynamics::Model& truth, const std::string& kind, std::uint64_t seed,
                               double shift) {
    core::Random random(seed);
    std::vector<double> time, gap, speed, voltage, temperature, way, lift, drag;
    const dynamics::StaticModel lifts(truth, "lift_force");
    std::vector<std::array<double, 4>> points;
    for (const double h : {0.0015, 0.003, 0.005, 0.008, 0.013, 0.02, 0.035, 0.06, 0.1, 0.15}) {
        for (const double v : {0.3, 0.5, 0.7, 0.9}) {
            for (const double d : {1.0, -1.0}) {
                points.push_back({h * (1 + shift), v - 0.5 * shift, 12 * v + 10 * shift, d});
            }
        }
    }
    for (std::size_t k = points.size(); k > 1; --k) {
        std::swap(points[k - 1], points[random.below(k)]);
    }
    dynamics::Measurements data;
    data.kind = dynamics::MeasurementKind::steady;
    for (const auto& [h, v, volt, d] : points) {
        dynamics::Conditions at;
        at[dynamics::Channel::time] = 100.0 * static_cast<double>(time.size());
        at[dynamics::Channel::gap] = h;
        at[dynamics::Channel::speed] = v;
        at[dynamics::Channel::jet_voltage] = kind == "two" ? 4 + 8 * random.uniform() : volt;
        at[dynamics::Channel::temperature] = 293.15 + 4 * (random.uniform() - 0.5);
        at[dynamics::Channel::approach_direction] = d;
        time.push_back(at[dynamics::Channel::time]);
        gap.push_back(h);
        speed.push_back(v);
        voltage.push_back(at[dynamics::Channel::jet_voltage]);
        temperature.push_back(at[dynamics::Channel::temperature]);
        way.push_back(d);
        lift.push_back(lifts(at) + noise * random.normal());
        drag.push_back(kind == "glide" ? dynamics::static_value(truth, "drag_force", at) + noise * random.normal() : 0);
    }
    dynamics::MeasuredRun run;
    run.name = "bench";
    run.table.source = "bench.csv";
    run.table.add_numbers("time", "s", time);
    run.table.add_numbers("gap", "m", gap);
    if (kind != "jet") run.table.add_numbers("speed", "m/s", speed);
    if (kind != "glide") run.table.add_numbers("jet_voltage", "V", voltage);
    run.table.add_numbers("temperature", "K", temperature);
    run.table.add_numbers("approach_direction", "1", way);
    run.table.add_numbers("lift_force", "N", lift);
    if (kind == "glide") run.table.add_numbers("drag_force", "N", drag);
    data.runs.push_back(std::move(run));
    data.noise["lift_force"] = noise;
    if (kind == "glide") data.noise["drag_force"] = noise;
    return data;
}

struct Wanted {
    const char* kind;
    const char* name;
    std::vector<dynamics::ParameterValue> values;
    const char* parameter = "";
    const char* also = "";  ///< the same law under another name
};

class EveryStaticEffect : public testing::TestWithParam<Wanted> {};

}  // namespace

TEST_P(EveryStaticEffect, IsNamedAndItsModelPredictsNewSetPointsToTheNoise) {
    const Wanted& wanted = GetParam();
    core::TemporaryFolder folder("effect");
    const dynamics::Model declared = rig(folder.path(), wanted.kind);
    dynamics::EffectUse use = dynamics::make_use(wanted.name, wanted.values);
    use.parameter = wanted.parameter;
    const dynamics::Model truth = declared.with_effect(use);
    DiscoverOptions options;
    options.figures = false;
    const Discovery found = discover(declared, measure(truth, wanted.kind, 11, 0), options);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    const std::string name = found.effects.front().name;
    EXPECT_TRUE(name == wanted.name || name == wanted.also) << found.sentence;
    write_discovery(found, declared, measure(truth, wanted.kind, 11, 0), folder.path() / "found", {});
    const dynamics::Model again = dynamics::read_model(folder.path() / "found" / "model.toml");
    const dynamics::Measurements fresh = measure(truth, wanted.kind, 12, 0.15);
    double before = 0, after = 0;
    for (const dynamics::ChannelError& channel : dynamics::predict(declared, fresh).channels) {
        before = std::max(before, channel.rmse);
    }
    for (const dynamics::ChannelError& channel : dynamics::predict(again, fresh).channels) {
        after = std::max(after, channel.rmse);
    }
    EXPECT_LT(after, 0.7 * before);
    EXPECT_LT(after, 1.3 * noise);
}

INSTANTIATE_TEST_SUITE_P(
    OfTheCatalogue, EveryStaticEffect,
    testing::Values(
        Wanted{"glide", "gap_offset", {{"offset", 6e-4, 0}}}, Wanted{"jet", "force_bias", {{"bias", 0.004, 0}}},
        Wanted{"glide", "sensor_gain", {{"gain", 1.05, 0}}}, Wanted{"jet", "drift", {{"rate", 1.5e-6, 0}}},
        Wanted{"glide", "speed_exponent", {{"exponent", 2.12, 0}}},
        Wanted{"glide", "current", {{"velocity", 0.015, 0}}}, Wanted{"glide", "temperature", {{"sensitivity", 0.9, 0}}},
        Wanted{"glide", "strut_buoyancy", {{"slope", 0.08, 0}}, "", "cable_buoyancy"},
        Wanted{"jet", "cable_buoyancy", {{"slope", 0.08, 0}}, "", "strut_buoyancy"},
        Wanted{"jet", "guide_friction", {{"friction", 0.003, 0}}}, Wanted{"jet", "pump_curve", {{"dead_zone", 1.2, 0}}},
        Wanted{"glide", "pitch_misalignment", {{"angle", 0.012, 0}}},
        Wanted{"glide", "surface_roughness", {{"near", 0.12, 0}, {"far", 0.12, 0}, {"length", 0.012, 0}}},
        Wanted{"two", "declared_parameter", {{"value", 1.25, 0}}, "force.2.factor"}),
    [](const testing::TestParamInfo<Wanted>& one) { return std::string(one.param.kind) + "_" + one.param.name; });
