// Models: strict reading, exact writing, effects, static sets.
#include <gtest/gtest.h>

#include <cmath>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/tables/exports/export.h"
#include "tests/support/support.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

constexpr const char* plain =
    "# declared\n[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\nnet_weight = \"0.03 N\"\n"
    "[drag.heave]\nlinear = \"0.02 N s/m\"\nquadratic = \"6.0 N s^2/m^2\"\n"
    "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\nscale.speed = { reference = \"0.5 m/s\", exponent = 2 "
    "}\n";

constexpr const char* lift =
    "gap [mm], lift_force [N]\n1, 0.1\n2, 0.02\n5, -0.03\n20, -0.01\n50, 0.04\n100, 0.05\n300, 0.01\n";

class ModelFile : public testing::Test {
protected:
    core::TemporaryFolder folder_;
    Model read(const std::string& text) {
        core::write_file(folder_.path() / "lift.csv", lift);
        core::write_file(folder_.path() / "model.toml", text);
        return read_model(folder_.path() / "model.toml");
    }
    std::string refusal(const std::string& text) {
        try {
            read(text);
        } catch (const core::InputError& error) {
            return error.what();
        }
        return "accepted";
    }
};

TEST_F(ModelFile, ReadsUnitsAndKeepsWhatWasDeclared) {
    const Model model = read(plain);
    EXPECT_DOUBLE_EQ(model.heave_mass(), 3.954);
    EXPECT_DOUBLE_EQ(model.parameter("drag.heave.quadratic"), 6);
    EXPECT_DOUBLE_EQ(model.parameter("force.1.scale.speed.reference"), .5);
    EXPECT_EQ(model.quantities(), std::vector<std::string>{"lift_force"});
    Conditions point;
    point[Channel::gap] = .005;
    point[Channel::speed] = 1;
    EXPECT_NEAR(static_value(model, "lift_force", point), -.12, 1e-12);
    bool outside = false;
    point[Channel::gap] = .5;
    EXPECT_NEAR(static_value(model, "lift_force", point, &outside), .04, 1e-12);
    EXPECT_TRUE(outside);
}

TEST_F(ModelFile, TakesAnExportedTableAsItWasButHoldsItsEnds) {
    // Few points whose slopes make the curve: a new fit through the values alone would be another one.
    std::string text = "gap [mm], lift_force [N]\n";
    for (int i = 1; i <= 60; ++i) {
        text += core::format_number(i) + ", " + core::format_number(std::sin(0.1 * i) + 3.0 / i) + "\n";
    }
    core::write_file(folder_.path() / "many.csv", text);
    const auto many =
        tables::ForceTable::read(folder_.path() / "many.csv", "lift_force",
                                 {{tables::RangePolicy::refuse, {}}, tables::FitOptions::Kind::interpolation});
    tables::ExportOptions thin;
    thin.max_error = 0.01;
    const auto result = export_table(many, "csv", folder_.path() / "thin.csv", thin);
    ASSERT_LT(result.grid.at(0), 20u);
    std::string toml = plain;
    toml.replace(toml.find("lift.csv"), 8, "thin.csv");
    const Model model = read(toml);
    Conditions point;
    point[Channel::speed] = .5;
    for (double gap = 0.001; gap < 0.06; gap += 0.0007) {
        point[Channel::gap] = gap;
        EXPECT_NEAR(static_value(model, "lift_force", point), many.value(&gap), result.error) << gap;
    }
    double end = 0.06;
    point[Channel::gap] = 0.2;
    EXPECT_NEAR(static_value(model, "lift_force", point), many.value(&end), 1e-12);
    ASSERT_EQ(model.remarks.size(), 1u);
    EXPECT_NE(model.remarks[0].message.find(
                  "asks to refuse beyond the ends of gap: in a model every table holds its end values"),
              std::string::npos);
}

TEST_F(ModelFile, RefusesMistakesAndNamesThem) {
    const auto with = [](const std::string& from, const std::string& to) {
        std::string text = plain;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    EXPECT_NE(refusal(with("net_weight", "net_wieght")).find("net_weight"), std::string::npos);
    EXPECT_NE(refusal(with("\"2.2 kg\"", "-2.2")).find("vehicle.mass"), std::string::npos);
    EXPECT_NE(refusal(with("\"2.2 kg\"", "\"2.2 m\"")).find("mass"), std::string::npos);
    EXPECT_NE(
        refusal(with("mass = \"2.2 kg\"", "mass = 2200\nlength = \"203 mm\"\nwidth = \"152 mm\"")).find("kilograms"),
        std::string::npos);
    EXPECT_NE(refusal(with("mass = \"2.2 kg\"", "mass = 2.2\nlength = 203.2")).find("203.2 mm"), std::string::npos);
    EXPECT_NE(refusal(with("lift_force", "lift_farce")).find("lift_force"), std::string::npos);
    EXPECT_NE(refusal(with("scale.speed", "scale.sped")).find("speed"), std::string::npos);
    EXPECT_NE(
        refusal(std::string(plain) + "[[effect]]\nname = \"coulomb_frictoin\"\nforce = 1\n").find("coulomb_friction"),
        std::string::npos);
    EXPECT_NE(refusal(std::string(plain) + "[[effect]]\nname = \"coulomb_friction\"\n").find("force"),
              std::string::npos);
    EXPECT_NE(refusal(std::string(plain) + "[[effect]]\nname = \"coulomb_friction\"\nforce = -1\n").find("outside"),
              std::string::npos);
    EXPECT_NE(refusal(std::string(plain) + "[[effect]]\nname = \"added_mass\"\nmass = \"-20 kg\"\n"), "");
    const Model light = read(std::string(plain) + "[[effect]]\nname = \"added_mass\"\nmass = \"-20 kg\"\n");
    EXPECT_THROW(HeavePlant{light}, core::InputError);
}

TEST_F(ModelFile, WritesItselfBackWithEffectsTablesAndLineage) {
    Model model = read(plain);
    model = model.with_effect(make_use("coulomb_friction", {{"force", 0.0098, 0.0004}}));
    EffectUse unknown = neutral_use("unknown");
    core::Table correction;
    correction.add_numbers("gap", "m", {.001, .1, .3});
    correction.add_numbers("lift_force", "N", {.01, .002, -.001});
    unknown.table = tables::ForceTable::fit(correction, "lift_force");
    unknown.quantity = "lift_force";
    model = model.with_effect(unknown).with_parameter("vehicle.mass", 2.35);
    model.lineage.made_from = {"model.toml", "runs \"of may\""};
    core::TemporaryFolder other;
    write_model(model, other.path() / "new" / "model.toml");
    const Model again = read_model(other.path() / "new" / "model.toml");
    EXPECT_EQ(again.lineage.made_from, model.lineage.made_from);
    EXPECT_EQ(again.effects.size(), 3U);
    EXPECT_DOUBLE_EQ(again.resolved().vehicle.mass, 2.35);
    Conditions held;
    held[Channel::speed] = .5;
    const HeavePlant a(model, held), b(again, held);
    for (double h = .001; h < .35; h += .0071) {
        EXPECT_NEAR(a.acceleration(h, .01, a.held_moment()), b.acceleration(h, .01, b.held_moment()), 1e-15);
    }
    EXPECT_EQ(core::read_file(other.path() / "new" / "model.toml").find("# declared"), 0U);
    // Once more: the same text.
    write_model(again, other.path() / "twice" / "model.toml");
    EXPECT_EQ(core::read_file(other.path() / "new" / "model.toml"),
              core::read_file(other.path() / "twice" / "model.toml"));
}

TEST_F(ModelFile, SaysWhatItsDataCouldNotTellApart) {
    const auto warned = [](const Model& model) {
        return std::count_if(model.remarks.begin(), model.remarks.end(), [](const core::Problem& remark) {
            return remark.message.find("(coulomb_friction, or linear_damping)") != std::string::npos;
        });
    };
    Model found = read(plain);
    EXPECT_EQ(warned(found), 0);
    found.lineage.made_from = {"verdict: ...", "tied: coulomb_friction, or linear_damping"};
    core::TemporaryFolder other;
    write_model(found, other.path() / "found" / "model.toml");
    const Model again = read_model(other.path() / "found" / "model.toml");
    EXPECT_EQ(warned(again), 1);
    write_model(again, other.path() / "twice" / "model.toml");
    EXPECT_EQ(warned(read_model(other.path() / "twice" / "model.toml")), 1);
}

TEST_F(ModelFile, EveryEffectIsNeutralAtItsNeutralValuesAndSurvivesTheFile) {
    const Model model = read(plain);
    Conditions point;
    point[Channel::gap] = .004;
    point[Channel::speed] = .7;
    point[Channel::temperature] = 293.15;
    point[Channel::time] = 100;
    point[Channel::approach_direction] = 1;
    const double expected = static_value(model, "lift_force", point);
    const HeavePlant plain_plant(model, point);
    const double acceleration = plain_plant.acceleration(.03, .01, plain_plant.held_moment());
    EXPECT_GE(effects().size(), 31U);
    for (const Effect* kind : effects()) {
        if (kind->info().takes_table || kind->info().takes_parameter) {
            continue;
        }
        const Model with = model.with_effect(neutral_use(kind->info().name));
        EXPECT_NEAR(static_value(with, "lift_force", point), expected, 1e-14) << kind->info().name;
        const HeavePlant plant(with, point);
        EXPECT_NEAR(plant.acceleration(.03, .01, plant.held_moment()), acceleration, 1e-14) << kind->info().name;
        EXPECT_FALSE(kind->info().source.empty());
        EffectUse typical = neutral_use(kind->info().name);
        for (std::size_t i = 0; i < typical.values.size(); ++i) {
            const EffectParameter& p = kind->info().parameters[i];
            typical.values[i] = std::clamp(p.neutral + p.typical, p.lower, p.upper);
        }
        core::TemporaryFolder other;
        write_model(model.with_effect(typical), other.path() / "m.toml");
        EXPECT_EQ(read_model(other.path() / "m.toml").effects.at(0).values, typical.values) << kind->info().name;
    }
}

TEST_F(ModelFile, StaticEffectsDoWhatTheySay) {
    const Model model = read(plain);
    Conditions point;
    point[Channel::gap] = .004;
    point[Channel::speed] = 1;
    const auto value = [&](const EffectUse& use, const Conditions& at) {
        return static_value(model.with_effect(use), "lift_force", at);
    };
    const double base = static_value(model, "lift_force", point);
    Conditions moved = point;
    moved[Channel::gap] = .0045;
    EXPECT_NEAR(value(make_use("gap_offset", {{"offset", 5e-4}}), point), static_value(model, "lift_force", moved),
                1e-15);
    EXPECT_NEAR(value(make_use("force_bias", {{"bias", .01}}), point), base + .01, 1e-15);
    EXPECT_NEAR(value(make_use("speed_exponent", {{"exponent", 1.8}}), point), base * std::pow(2, -.2), 1e-14);
    EXPECT_NEAR(value(make_use("current", {{"velocity", .1}}), point), base * 1.21, 1e-14);
    EffectUse drag_only = make_use("force_bias", {{"bias", .01}});
    drag_only.quantity = "drag_force";
    EXPECT_NEAR(value(drag_only, point), base, 1e-15);
    EffectUse declared = neutral_use("declared_parameter");
    declared.parameter = "force.1.factor";
    declared.values[0] = 1.1;
    EXPECT_NEAR(value(declared, point), base * 1.1, 1e-14);
}

TEST(Curve, IsItsTableExactly) {
    const Model model = test::ref_a_model();
    const tables::ForceTable& table = model.forces[0].table;
    const double nothing[1] = {0};
    const Curve curve = Curve::along(table, 0, nothing);
    double sum = 0;
    for (int i = -100; i <= 20000; ++i) {
        const double h = -.06 + 1e-4 * i;
        double slope = 0;
        EXPECT_NEAR(curve(h), table.value(&h), 2e-12);
        EXPECT_NEAR(curve.value(h, slope), curve(h), 1e-18);
        sum += 1;
    }
    EXPECT_EQ(curve.zeros().size(), 2U);
    EXPECT_NEAR(curve.integral(.16) - curve.integral(0), -1.4837219e-3, 1e-9);  // O56
}

TEST(Curve, SumsOverDifferentRanges) {
    const Curve a({0, 1, 2}, {0, 1, 0}, {1, 0, -1}), b({.5, 1.5}, {2, 3}, {0, 4});
    const Curve sum = a.plus(2, b, -1);
    for (double x = -.2; x < 2.2; x += .013) {
        EXPECT_NEAR(sum(x), 2 * a(x) - b(x), 1e-7) << x;
    }
}

TEST(RandomModels, NeverCrashAndNeverReturnNanInSilence) {
    core::Random random(20);
    for (int trial = 0; trial < 60; ++trial) {
        const int knots = 3 + static_cast<int>(random.below(20));
        std::vector<double> gap{random.uniform(0, .002)}, force{random.uniform(-.2, .5)};
        for (int i = 1; i < knots; ++i) {
            gap.push_back(gap.back() + std::exp(random.uniform(-8, -2)));
            force.push_back(random.uniform(-.2, .2));
        }
        core::Table table;
        table.source = "random.csv";
        table.add_numbers("gap", "m", gap);
        table.add_numbers("lift_force", "N", force);
        Model model = test::free_model(std::exp(random.uniform(-2, 3)), random.uniform(-.1, .1), random.uniform(0, 1),
                                       random.uniform(0, 30));
        tables::FitOptions options;
        options.kind = tables::FitOptions::Kind::interpolation;
        model.forces.push_back({"lift_force",
                                "random.csv",
                                "random.csv",
                                tables::ForceTable::fit(table, "lift_force", options),
                                {Channel::gap},
                                {},
                                1.0});
        for (const Effect* kind : effects()) {
            if (random.uniform() < .15 && !kind->info().takes_table && !kind->info().takes_parameter &&
                kind->info().seen_in != SeenIn::static_set) {
                EffectUse use = neutral_use(kind->info().name);
                for (std::size_t i = 0; i < use.values.size(); ++i) {
                    const EffectParameter& p = kind->info().parameters[i];
                    use.values[i] = std::clamp(p.neutral + p.typical * random.uniform(-1, 1), p.lower, p.upper);
                }
                model = model.with_effect(use);
            }
        }
        RegionOptions map;
        map.axes = {{"gap", 0, gap.back() * 1.2}, {"heave_velocity", -.1, .1}};
        map.columns = map.rows = 6;
        map.duration = 10;
        try {
            const StabilityRegion region = stability_region(model, map);
            double sum = 0;
            for (const EndClass& end : region.classes) {
                sum += end.fraction;
            }
            EXPECT_NEAR(sum, 1, 1e-9);
            TrajectoryOptions run;
            run.duration = 5;
            run.output_step = .1;
            run.tolerance = 1e-6;
            const Trajectory motion =
                simulate(model, gap.back() * random.uniform(.05, 1), random.uniform(-.05, .05), {}, run);
            for (const double h : motion.gap) {
                EXPECT_TRUE(std::isfinite(h));
            }
        } catch (const core::Error& error) {
            EXPECT_FALSE(std::string(error.what()).empty());
        }
    }
}

TEST(Predict, IsAsGoodAsTheNoiseWhereTheModelIsRight) {
    UNDERBODY_NEEDS_SHARED("examples/loop/example-02/model.toml");
    const auto folder = ::underbody::test::shared_folder() / "examples/loop";
    const Prediction right =
        predict(read_model(folder / "example-02/model.toml"), read_measurements(folder / "example-02"));
    ASSERT_EQ(right.channels.size(), 1U);
    EXPECT_LT(right.channels[0].in_noise, 1.1);
    EXPECT_GT(right.channels[0].in_noise, .95);
    const Model lacking = read_model(folder / "example-00/model.toml");
    const Measurements data = read_measurements(folder / "example-00");
    const double before = predict(lacking, data).channels[0].in_noise;
    const double after =
        predict(lacking.with_effect(make_use("coulomb_friction", {{"force", .01}})), data).channels[0].in_noise;
    EXPECT_GT(before, 5);
    EXPECT_LT(after, 1.2);
    const Prediction bench =
        predict(read_model(folder / "example-05/model.toml"), read_measurements(folder / "example-05"));
    EXPECT_FALSE(bench.time_series);
    EXPECT_NEAR(bench.channels[0].in_noise, 1, .15);
    EXPECT_NE(bench.table.find("lift_force_predicted"), nullptr);
}

TEST(Predict, EstimatesWhiteNoise) {
    core::Random random(5);
    std::vector<double> time, values;
    for (int i = 0; i < 4000; ++i) {
        time.push_back(.02 * i);
        values.push_back(.1 + .02 * std::sin(2 * time.back()) + random.normal(0, 2e-4));
    }
    EXPECT_NEAR(sensor_noise(time, values), 2e-4, 1.5e-5);
    // Coarse steps, unequal times, a fast motion, outliers: one estimate for all that read measurements.
    for (const double quantum : {1e-4, 5e-4, 1.5e-3}) {
        std::vector<double> rounded = values;
        double square = 0;
        for (std::size_t i = 0; i < rounded.size(); ++i) {
            const double truth = .1 + .02 * std::sin(2 * time[i]);
            rounded[i] = quantum * std::round(values[i] / quantum);
            square += (rounded[i] - truth) * (rounded[i] - truth);
        }
        const double really = std::sqrt(square / static_cast<double>(rounded.size()));
        EXPECT_NEAR(sensor_noise(time, rounded), really, .35 * really) << quantum;
    }
    std::vector<double> fast = values, jumping = values, uneven;
    double t = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        fast[i] += .02 * std::sin(9 * time[i]);
        jumping[i] += i % 97 == 0 ? .05 : 0;
        t += i % 5 == 0 ? .06 : .02;
        uneven.push_back(t);
    }
    EXPECT_NEAR(sensor_noise(time, fast), 2e-4, 4e-5);
    EXPECT_NEAR(sensor_noise(time, jumping), 2e-4, 3e-5);
    EXPECT_NEAR(sensor_noise(uneven, values), 2e-4, 3e-5);
    EXPECT_TRUE(std::isnan(sensor_noise(time, std::vector<double>(5, 1.0))));
}

}  // namespace

}  // namespace underbody::dynamics
