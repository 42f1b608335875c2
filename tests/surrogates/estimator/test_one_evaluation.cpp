// One force: heave, heave with pitch, the whole body, the run over the ground, static values, exported tables and the
// estimator evaluate a model's forces alike, whatever effect it has; where an effect does not act the program names it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "surrogates/dynamics/model/force_tables.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/surface_motion.h"
#include "surrogates/estimator/model/training.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::estimator {

namespace {

using namespace dynamics;

/// A quantity over the gap alone.
ForceSource source(const std::string& quantity, double (*force)(double), std::vector<ForceScale> scales,
                   double factor = 1) {
    core::Table table;
    table.source = quantity + ".csv";
    std::vector<double> gap, value;
    for (int i = 0; i <= 12; ++i) {
        gap.push_back(0.001 + 0.04 * std::pow(i / 12.0, 2));
        value.push_back(force(gap.back()));
    }
    table.add_numbers("gap", "m", gap);
    table.add_numbers(quantity, quantity.ends_with("moment") ? "N m" : "N", value);
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    return {quantity,       table.source, table.source, tables::ForceTable::fit(table, quantity, options),
            {Channel::gap}, scales,       factor};
}

/// Passive and jet lift, drag and moment over the gap; inertias for every motion.
Model vehicle() {
    Model model = test::free_model(2.2, 0.03, 0.02, 6);
    model.vehicle.added_mass_heave = 1.7;
    model.vehicle.roll_inertia = model.vehicle.yaw_inertia = 0.01;
    model.vehicle.pitch_inertia = 0.008;
    model.vehicle.base_depth = 0.05;
    model.vehicle.base_half_length = 0.08;
    model.conditions[Channel::speed] = 0.63;
    model.conditions[Channel::jet_voltage] = 8.2;
    model.conditions[Channel::temperature] = 290;
    model.forces.push_back(source(
        "lift_force", [](double h) { return -2e-4 / (h + 0.002) + 0.02 * std::sin(90 * h); },
        {{Channel::speed, 0.5, 2, 0}}, 1.1));
    model.forces.push_back(
        source("lift_force", [](double h) { return 4e-4 / (h + 0.003); }, {{Channel::jet_voltage, 10, 2, 1.5}}));
    model.forces.push_back(
        source("drag_force", [](double h) { return 0.02 + 1e-5 / (h + 0.001); }, {{Channel::speed, 0.5, 2, 0}}));
    model.forces.push_back(
        source("pitch_moment", [](double h) { return -1e-6 / (h + 0.001); }, {{Channel::speed, 0.5, 2, 0}}));
    return model;
}

tables::ForceTable correction(const std::string& quantity) {
    return source(quantity, [](double h) { return 0.004 * std::sin(150 * h); }, {}).table;
}

/// Every effect of the catalogue at a random size; those that may name a quantity also for lift and drag alone.
std::vector<EffectUse> every_effect(core::Random& random) {
    std::vector<EffectUse> uses;
    for (const Effect* effect : effects()) {
        const EffectInfo& info = effect->info();
        for (const char* quantity : {"", "lift_force", "drag_force"}) {
            if (*quantity != 0 && !info.takes_quantity) {
                continue;
            }
            EffectUse use = neutral_use(info.name);
            for (std::size_t i = 0; i < info.parameters.size(); ++i) {
                const EffectParameter& p = info.parameters[i];
                use.values[i] = std::clamp(p.neutral + random.uniform(0.3, 1) * p.typical, p.lower, p.upper);
            }
            use.quantity = quantity;
            if (info.takes_table) {
                use.quantity = *quantity == 0 ? "lift_force" : quantity;
                use.table = correction(use.quantity);
            }
            if (info.takes_parameter) {
                use.parameter = "force.1.factor";
                use.values[0] = 1.3;
            }
            uses.push_back(use);
        }
    }
    return uses;
}

std::string words(const core::Problems& problems) {
    std::string text;
    for (const core::Problem& problem : problems) {
        text += problem.message + "\n";
    }
    return text;
}

double mass_at(const HeavePlant& plant, double h) {
    double slope = 0;
    return plant.inertia(h, slope);
}

struct State {
    double t = 0, h = 0, w = 0, u = 0;
};

/// dq/dt of heave with pitch and of the whole body, level and without speed (by which the inertia of the water along
/// and across the body turns the whole body alone).
struct PitchRates {
    double heave_pitch = 0, body = 0;
};

PitchRates pitch_rates(Model model, const State& s, const Surroundings& around) {
    model.conditions[Channel::speed] = 0;
    PitchState pitch_rate{};
    HeavePitch(model).rate({s.h, s.w, 0, 0}, ContactState::free, pitch_rate, around);
    const RigidBody body(model);
    BodyState y{}, rate{};
    y[state_w] = -s.w;
    y[state_z] = body.height_for_gap(s.h, 0);
    body.rate(y, {}, ContactState::free, rate, around);
    return {pitch_rate[3], rate[state_q]};
}

/// dw/dt of the coupled motions in pure heave, and what the run over the ground presses.
void expect_coupled(const Model& model, const std::string& who, const State& s) {
    const HeavePlant plant(model);
    const double a = plant.acceleration(s.h, s.w, {s.t, s.u}), size = std::abs(a) + 1e-2;
    Surroundings around;
    around.t = s.t;
    around.input = s.u;
    PitchState pitch_rate{};
    const HeavePitch pitch(model);
    pitch.rate({s.h, s.w, 0, 0}, ContactState::free, pitch_rate, around);
    // The moments turn the body about its centre of gravity, whose rise is that of heave; so is the base's where it
    // lies under that.
    EXPECT_NEAR(pitch_rate[1] - pitch.arm(0) * pitch_rate[3], a, 1e-12 * size) << who << ", heave and pitch";

    const RigidBody body(model);
    BodyState y{}, rate{};
    y[state_u] = model.conditions[Channel::speed];
    y[state_w] = -s.w;
    y[state_z] = body.height_for_gap(s.h, 0);
    body.rate(y, {}, ContactState::free, rate, around);
    EXPECT_NEAR(-rate[state_w], a, 1e-12 * size) << who << ", the whole body";
    Model bare = model;
    bare.effects.clear();
    const PitchRates with = pitch_rates(model, s, around), without = pitch_rates(bare, s, around);
    EXPECT_NEAR(with.body - without.body, with.heave_pitch - without.heave_pitch,
                1e-12 * (std::abs(with.body) + std::abs(without.body) + 1e-2))
        << who << ", the pitch of the whole body";

    const SurfaceMotion ground(model);
    const double touching = plant.contact_gap(), mass = mass_at(plant, touching);
    const double pressed = -mass * plant.acceleration(touching, 0, {s.t, s.u});
    EXPECT_NEAR(ground.contact({model.conditions[Channel::speed], 0, 0, 0, 0, 0}, {}, around).normal, pressed,
                1e-12 * (std::abs(pressed) + 1e-2))
        << who << ", over the ground";

    if (plant.terms.history == 0) {
        const SeparatedPlant apart = separate(model, {});
        EXPECT_NEAR(apart.acceleration(s.h, s.w, s.u, s.t), a, 1e-12 * size) << who << ", estimator";
    }
}

/// The forces of the tables: as measured, as exported, as heave and heave with pitch see them.
void expect_static(const Model& model, const EffectUse& use, const std::string& who, double h) {
    const EffectInfo& info = effect(use.name).info();
    ForceTablesOptions options;
    options.held = model.conditions;
    const ForceTables exported = force_tables(model, options);
    if (info.belongs_to_the_rig || info.seen_in == SeenIn::time_series) {
        EXPECT_THAT(words(exported.remarks), testing::HasSubstr(use.name)) << who << ": left out, and said so";
    }
    if (info.belongs_to_the_rig) {
        const bool moves = info.seen_in == SeenIn::time_series;  // a cable pulls in the surface motion
        EXPECT_THAT(words(effects_without_motion(model)), testing::HasSubstr(moves ? "" : use.name)) << who;
        return;
    }
    EXPECT_EQ(words(effects_without_motion(model)), "") << who;
    Conditions at;
    at[Channel::gap] = h;
    const double lift = static_value(model, "lift_force", at), moment = static_value(model, "pitch_moment", at),
                 drag = static_value(model, "drag_force", at);
    for (const tables::ForceTable& table : exported.tables) {
        const double wanted = table.quantity() == "lift_force"   ? lift
                              : table.quantity() == "drag_force" ? drag
                                                                 : moment;
        EXPECT_NEAR(table.value(&h), wanted, table.sampling_error() + 1e-12)
            << who << ", exported " << table.quantity();
    }
    const HeavePlant plant(model);
    HeaveLoad load = plant.table_lift(h, 0);
    for (const HeaveTerms::Correction& correction : plant.terms.corrections) {
        load.force += correction.curve.empty() ? 0 : correction.curve(h);  // over the velocity too: none at rest
    }
    EXPECT_NEAR(load.force, lift, 1e-12) << who << ", heave";
    double seen_lift = 0, seen_moment = 0;
    HeavePitch(model).table_loads({h, 0, 0, 0}, {}, seen_lift, seen_moment);
    for (const HeaveTerms::Correction& correction : plant.terms.corrections) {
        seen_lift += correction.curve.empty() ? 0 : correction.curve(h);
    }
    EXPECT_NEAR(seen_lift, lift, 1e-12) << who << ", heave and pitch";
    EXPECT_NEAR(seen_moment, moment, 1e-12) << who << ", heave and pitch";
    const RigidBody body(model);
    BodyState y{};
    y[state_u] = model.conditions[Channel::speed];
    y[state_z] = body.height_for_gap(h, 0);
    const RigidBody::TableLoads loads = body.table_loads(y, {});
    EXPECT_NEAR(loads.drag, drag, 2e-6 * std::abs(drag)) << who << ", the whole body (its drag is smooth through rest)";
    EXPECT_NEAR(loads.moment, moment, 1e-12) << who << ", the whole body";
}

TEST(OneEvaluation, EveryMotionSeesEveryEffectAlike) {
    core::Random random(11);
    for (int round = 0; round < 3; ++round) {
        for (const EffectUse& use : every_effect(random)) {
            const Model model = vehicle().with_effect(use);
            const std::string who = use.name + (use.quantity.empty() ? "" : " of " + use.quantity);
            for (int i = 0; i < 6; ++i) {
                expect_coupled(model, who,
                               {random.uniform(0, 20), random.uniform(0.002, 0.05), random.uniform(-0.08, 0.08),
                                random.uniform(-0.02, 0.02)});
                expect_static(model, use, who, random.uniform(0.0011, 0.0409));
            }
        }
    }
}

TEST(OneEvaluation, SeveralEffectsAtOnceInAnyOrder) {
    core::Random random(12);
    EffectUse unknown = neutral_use("unknown");
    unknown.quantity = "lift_force";
    unknown.table = correction("lift_force");
    const EffectUse temperature = make_use("temperature", {{"sensitivity", 0.4}}),
                    pump = make_use("pump_curve", {{"dead_zone", 1}, {"saturation", 0.3}, {"exponent", 0.2}}),
                    rough = make_use("surface_roughness", {{"near", 0.3}, {"far", 0.1}, {"length", 0.01}});
    for (const Model& model :
         {vehicle().with_effect(unknown).with_effect(temperature).with_effect(rough).with_effect(pump),
          vehicle().with_effect(rough).with_effect(pump).with_effect(temperature).with_effect(unknown)}) {
        for (int i = 0; i < 20; ++i) {
            expect_coupled(model, "several", {0, random.uniform(0.002, 0.05), random.uniform(-0.08, 0.08), 0});
            expect_static(model, rough, "several", random.uniform(0.0011, 0.0409));
        }
    }
}

TEST(OneEvaluation, RecordedConditionsActAsHeldOnesDo) {
    core::Random random(13);
    for (const EffectUse& use : every_effect(random)) {
        const EffectInfo& info = effect(use.name).info();
        if (info.belongs_to_the_rig || info.seen_in == SeenIn::time_series) {
            continue;
        }
        const Model model = vehicle().with_effect(use);
        InputSignals inputs;
        inputs.time = {0, 1, 2, 3, 4};
        std::vector<double> speed, voltage, kelvin;
        for (std::size_t i = 0; i < 5; ++i) {
            speed.push_back(random.uniform(0.3, 0.8));
            voltage.push_back(random.uniform(3, 12));
            kelvin.push_back(random.uniform(280, 300));
        }
        inputs.signals = {{Channel::speed, speed}, {Channel::jet_voltage, voltage}, {Channel::temperature, kelvin}};
        const HeavePlant plant = plant_for(model, inputs);
        const HeaveRun run(plant, inputs);
        const HeavePitch pitch(model, {}, varying_channels(inputs));
        RecordedInputs recorded(pitch.vertical(), inputs);
        for (std::size_t i = 0; i < 5; ++i) {
            Conditions at;
            at[Channel::gap] = random.uniform(0.0011, 0.0409);
            at[Channel::speed] = speed[i];
            at[Channel::jet_voltage] = voltage[i];
            at[Channel::temperature] = kelvin[i];
            const double wanted = static_value(model, "lift_force", at), h = at[Channel::gap];
            double corrections = 0;
            for (const HeaveTerms::Correction& correction : plant.terms.corrections) {
                corrections += correction.curve(h);
            }
            EXPECT_NEAR(plant.lift(h, run.moment(i)) + corrections, wanted, 1e-12) << use.name;
            double lift = 0, moment = 0;
            pitch.table_loads({h, 0, 0, 0}, recorded.at(inputs.time[i]), lift, moment);
            EXPECT_NEAR(lift + corrections, wanted, 1e-12) << use.name;
            EXPECT_NEAR(moment, static_value(model, "pitch_moment", at), 1e-12) << use.name;
        }
    }
}

TEST(OneEvaluation, SlopesAtTheEndsOfATableAreItsOwn) {
    const Model model = vehicle();
    for (const std::size_t i : {0, 1}) {
        const tables::ForceTable& table = model.forces[i].table;
        const Curve curve = Curve::along(table, 0, std::vector<double>{0});
        for (const double end : {curve.lower(), curve.upper()}) {
            const tables::Evaluation at = table.at(std::vector<double>{end});
            double slope = 0;
            EXPECT_NEAR(curve.value(end, slope), at.value, 1e-15);
            EXPECT_NEAR(slope, at.slope[0], 1e-9 * std::abs(at.slope[0]) + 1e-12);
        }
        double slope = 1;
        EXPECT_EQ(curve.value(curve.lower() - 1e-9, slope), curve(curve.lower()));
        EXPECT_EQ(slope, 0);
    }
}

}  // namespace

}  // namespace underbody::estimator
