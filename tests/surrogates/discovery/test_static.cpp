#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/residual.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

Discovery found_on(const std::function<double(double, double)>& truth, std::uint64_t seed, bool figures = false) {
    core::TemporaryFolder folder("static");
    test::write_bench(folder.path(), truth, seed);
    DiscoverOptions options;
    options.figures = figures;
    return discover(dynamics::read_model(folder.path() / "model.toml"), dynamics::read_measurements(folder.path()),
                    options);
}

bool warned(const Discovery& found, const std::string& words) {
    return std::any_of(found.problems.begin(), found.problems.end(),
                       [&](const core::Problem& problem) { return problem.message.find(words) != std::string::npos; });
}

double declared(double gap, double voltage) { return test::lift_of(gap) * voltage * voltage / 100; }

}  // namespace

TEST(StaticDiscovery, SaysNoneOnCleanDataAndLeavesTheModelAlone) {
    int false_alarms = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Discovery found = found_on(declared, seed);
        false_alarms += found.verdict != "none";
        if (found.verdict == "none") {
            EXPECT_TRUE(found.effects.empty());
            EXPECT_TRUE(found.model.effects.empty());
            EXPECT_EQ(found.error.front().before.rmse, found.error.front().after.rmse);
            EXPECT_FALSE(found.limits.empty());
        }
    }
    EXPECT_LE(false_alarms, 1);
}

TEST(StaticDiscovery, NamesABiasAGapOffsetAndADeadZoneWithTheirSizes) {
    const Discovery bias = found_on([](double h, double v) { return declared(h, v) + 0.004; }, 3);
    ASSERT_EQ(bias.verdict, "effect");
    EXPECT_EQ(bias.effects.at(0).name, "force_bias");
    EXPECT_NEAR(bias.effects.at(0).parameters.at(0).value, 0.004, 4 * bias.effects.at(0).parameters.at(0).sigma + 1e-5);
    EXPECT_LT(bias.error.front().after.rmse, 0.5 * bias.error.front().before.rmse);
    const Discovery offset = found_on([](double h, double v) { return declared(h + 0.006, v); }, 4);
    ASSERT_EQ(offset.verdict, "effect");
    EXPECT_EQ(offset.effects.at(0).name, "gap_offset");
    const Discovery pump = found_on([](double h, double v) { return declared(h, std::max(0.0, v - 2) * 10 / 8); }, 5);
    ASSERT_EQ(pump.verdict, "effect");
    EXPECT_EQ(pump.effects.at(0).name, "pump_curve");
}

TEST(StaticDiscovery, NamesALargeOffsetBesideAScaleThatHidesItsSlope) {
    // a zero off by 12 mm where the table bends over 30 mm: from half a millimetre the way leads over hills
    for (const double offset : {0.012, 0.03}) {
        const Discovery found = found_on([&](double h, double v) { return 1.3 * declared(h + offset, v); }, 6);
        ASSERT_EQ(found.verdict, "effect") << found.sentence;
        ASSERT_EQ(found.effects.size(), 2U) << found.sentence;
        for (const FoundEffect& effect : found.effects) {
            const FoundParameter& number = effect.parameters.at(0);
            EXPECT_NEAR(number.value, effect.name == "gap_offset" ? offset : 1.3, 4 * number.sigma) << found.sentence;
        }
    }
}

TEST(StaticDiscovery, CallsWhatTheCatalogueLacksUnknownAndSaysOnWhatItDepends) {
    const Discovery found = found_on(
        [](double h, double v) { return declared(h, v) + 0.006 * std::exp(-std::pow(std::log(h / 0.03), 2) / 0.15); },
        6, true);
    EXPECT_EQ(found.verdict, "unknown");
    EXPECT_EQ(found.depends_on, std::vector<std::string>{"gap"});
    EXPECT_LT(found.error.front().after.rmse, found.error.front().before.rmse);
    ASSERT_EQ(found.model.effects.size(), 1U);
    EXPECT_TRUE(found.model.effects.front().table.has_value());
    EXPECT_GE(found.figures.size(), 3U);
}

TEST(StaticDiscovery, NamesNothingThatTheHeldOutSetPointsDoNotShow) {
    // a bias in the fitted readings of most sets at 0.45 of the noise, beyond chance in the others at once the noise
    int named = 0, refused = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Discovery found = found_on([](double h, double v) { return declared(h, v) + 0.00045; }, seed);
        if (warned(found, "the held-out error does not fall")) {
            EXPECT_EQ(found.verdict, "none") << found.sentence;
            EXPECT_TRUE(found.model.effects.empty());
            EXPECT_LT(found.none_probability, 0.5) << "what the readings hold is not nothing for want of a name";
            for (const FoundEffect& rival : found.alternatives) {
                EXPECT_LE(rival.probability, 0.5);
            }
            ++refused;
        }
        const Discovery twice = found_on([](double h, double v) { return declared(h, v) + 0.001; }, seed);
        named += twice.verdict == "effect" && twice.effects.front().name == "force_bias" ? 1 : 0;
    }
    EXPECT_GE(refused, 2);
    EXPECT_GE(named, 11);
}

TEST(StaticDiscovery, FindsOutThatADeclaredNoiseIsWrong) {
    core::TemporaryFolder folder("static");
    test::write_bench(folder.path(), declared, 8);
    dynamics::Measurements data = dynamics::read_measurements(folder.path());
    data.noise["lift_force"] = 0.0005;  // half the truth: everything would look real
    const Discovery found = discover(dynamics::read_model(folder.path() / "model.toml"), data);
    EXPECT_EQ(found.verdict, "none");
    EXPECT_NE(found.noise.at("lift_force").from.find("wrong"), std::string::npos);
    EXPECT_NEAR(found.noise.at("lift_force").value, 0.001, 1.5e-4);
}

TEST(StaticDiscovery, WritesEverythingAndItsModelIsReadBack) {
    core::TemporaryFolder folder("static");
    test::write_bench(
        folder.path(), [](double h, double v) { return declared(h, v) + 0.004; }, 3);
    const dynamics::Model model = dynamics::read_model(folder.path() / "model.toml");
    const dynamics::Measurements data = dynamics::read_measurements(folder.path());
    const Discovery found = discover(model, data);
    write_discovery(found, model, data, folder.path() / "found", {});
    const nlohmann::json json = nlohmann::json::parse(core::read_file(folder.path() / "found" / "discovery.json"));
    for (const char* key :
         {"verdict", "effects", "alternatives", "depends_on", "noise", "error", "consequence", "next_experiment"}) {
        EXPECT_TRUE(json.contains(key)) << key;
    }
    EXPECT_EQ(json["effects"][0]["name"], "force_bias");
    EXPECT_EQ(json["effects"][0]["parameters"]["bias"]["unit"], "N");
    EXPECT_GT(json["error"]["in_noise"]["before"], json["error"]["in_noise"]["after"]);
    const dynamics::Model again = dynamics::read_model(folder.path() / "found" / "model.toml");
    ASSERT_EQ(again.effects.size(), 1U);
    EXPECT_EQ(again.effects.front().name, "force_bias");
    EXPECT_NE(core::read_file(folder.path() / "found" / "report.html").find("force_bias"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "found" / "next-experiment.csv"));
    EXPECT_TRUE(json["consequence"]["estimator"].is_null()) << "set points have no motion to estimate";
}

TEST(StaticDiscovery, CountsHowOftenResampledSetPointsGiveTheSameVerdict) {
    const Discovery none = found_on(declared, 5);
    ASSERT_EQ(none.verdict, "none") << none.sentence;
    EXPECT_GT(none.stability, 0.8);
    EXPECT_NE(none.stability, none.none_probability);
    // a bias at the edge of what can be seen: some draws of the same set points show it, others do not
    const Discovery faint = found_on([](double h, double v) { return declared(h, v) + 0.0004; }, 5);
    EXPECT_LT(faint.stability, 1);
    const auto bump = [](double h, double v) {
        return declared(h, v) + 0.012 * std::exp(-std::pow((h - 0.025) / 0.015, 2));
    };
    const Discovery unknown = found_on(bump, 5);
    ASSERT_EQ(unknown.verdict, "unknown") << unknown.sentence;
    EXPECT_GT(unknown.stability, 0.8);
}

TEST(StaticDiscovery, DrawsABumpThatOnlyAFewGapsShow) {
    const auto bump = [](double h, double v) {
        return declared(h, v) + 0.012 * std::exp(-std::pow((h - 0.025) / 0.015, 2)) * v / 8;
    };
    const Discovery found = found_on(bump, 6);
    ASSERT_EQ(found.verdict, "unknown") << found.sentence;
    const dynamics::StaticModel corrected(found.model, "lift_force");
    double largest = 0;
    for (const double gap : {0.005, 0.01, 0.02, 0.04, 0.07, 0.1}) {  // at voltages between the measured ones
        for (const double volts : {5.0, 8.0, 11.0}) {
            dynamics::Conditions at;
            at[dynamics::Channel::gap] = gap;
            at[dynamics::Channel::jet_voltage] = volts;
            largest = std::max(largest, std::abs(corrected(at) - bump(gap, volts)));
        }
    }
    EXPECT_LT(largest, 0.2 * 0.012 * 11 / 8);
}

TEST(StaticDiscovery, WritesSetPointsForTheNextExperimentWithinTheMeasuredRange) {
    const Discovery found = found_on([](double h, double v) { return declared(h, v) + 0.004; }, 3);
    ASSERT_GT(found.next_set_points.rows(), 0U);
    for (const double gap : found.next_set_points.numbers("gap")) {
        EXPECT_GE(gap, 0.002 - 1e-12);
        EXPECT_LE(gap, 0.4 + 1e-12);
    }
    EXPECT_GT(found.next_power, 0);
    EXPECT_LE(found.next_power, 1);
}

TEST(StaticDiscovery, SaysWhetherAnEffectBelongsToTheRigOrGoesWithTheVehicle) {
    const Discovery rig = found_on([](double h, double v) { return declared(h, v) + 0.004; }, 3);
    EXPECT_NE(rig.consequence.text.find("belongs to the rig"), std::string::npos) << rig.consequence.text;
    EXPECT_TRUE(rig.consequence.region_after.empty());
    ASSERT_FALSE(rig.consequence.equilibria.empty());
    const Discovery body = found_on([](double h, double v) { return declared(h, std::max(0.0, v - 2) * 10 / 8); }, 5);
    EXPECT_NE(body.consequence.text.find("goes with the vehicle"), std::string::npos) << body.consequence.text;
}

TEST(StaticDiscovery, RunsItsPlaceboOnTwinsWithNothingMissing) {
    core::TemporaryFolder folder("static");
    test::write_bench(
        folder.path(), [](double h, double v) { return declared(h, v) + 0.004; }, 3);
    DiscoverOptions options;
    options.figures = options.consequence = false;
    options.placebo_twins = 4;
    const Discovery found = discover(dynamics::read_model(folder.path() / "model.toml"),
                                     dynamics::read_measurements(folder.path()), options);
    EXPECT_EQ(found.verdict, "effect");
    EXPECT_EQ(found.placebo.twins, 4U);
    EXPECT_LE(found.placebo.alarms, 1U);
}

TEST(StaticDiscovery, GivesTheSameBytesTwice) {
    const auto truth = [](double h, double v) { return declared(h, v) * 1.15; };
    const auto bytes = [&] {
        nlohmann::json json = to_json(found_on(truth, 9));
        for (nlohmann::json& problem : json["problems"]) {
            problem.erase("place");  // names the temporary folder
        }
        return json.dump();
    };
    EXPECT_EQ(bytes(), bytes());
}
