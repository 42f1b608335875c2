// One heave equation: simulation, coupled motions, discovery's filter and the estimator agree for every effect of the
// catalogue.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "surrogates/discovery/heave/heave_filter.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/estimator/model/training.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::discovery {

namespace {

using namespace dynamics;

/// A correction table of the lift over the given axes.
tables::ForceTable correction(const std::vector<std::string>& axes) {
    core::Table table;
    table.source = "correction.csv";
    std::vector<std::vector<double>> columns(axes.size());
    std::vector<double> force;
    const int n = 6;
    for (int i = 0; i < (axes.size() > 1 ? n * n : n); ++i) {
        const double a = i % n, b = i / n;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            const double place = (k == 0 ? a : b) / (n - 1);
            columns[k].push_back(axes[k] == "gap" ? 0.4 * place : axes[k] == "time" ? 20 * place : 0.2 * place - 0.1);
        }
        force.push_back(1e-3 * (std::sin(a) + 0.3 * a * b));
    }
    for (std::size_t k = 0; k < axes.size(); ++k) {
        table.add_numbers(axes[k], axes[k] == "gap" ? "m" : axes[k] == "time" ? "s" : "m/s", columns[k]);
    }
    table.add_numbers("lift_force", "N", force);
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    options.axes = axes;
    return tables::ForceTable::fit(table, "lift_force", options);
}

/// Every effect that moves the body, at sizes that matter.
std::vector<EffectUse> every_effect() {
    std::vector<EffectUse> uses;
    for (const Effect* effect : effects()) {
        const EffectInfo& info = effect->info();
        if (info.seen_in == SeenIn::static_set) {
            continue;
        }
        if (info.takes_table) {
            for (const std::vector<std::string>& axes : std::vector<std::vector<std::string>>{
                     {"gap"}, {"heave_velocity"}, {"gap", "heave_velocity"}, {"gap", "time"}}) {
                EffectUse use = neutral_use(info.name);
                use.quantity = "lift_force";
                use.table = correction(axes);
                uses.push_back(use);
            }
            continue;
        }
        EffectUse use = neutral_use(info.name);
        for (std::size_t i = 0; i < info.parameters.size(); ++i) {
            const EffectParameter& p = info.parameters[i];
            use.values[i] = std::clamp(p.shape ? p.neutral : p.neutral + 0.5 * p.typical, p.lower, p.upper);
        }
        if (info.takes_parameter) {
            use.parameter = "vehicle.mass";
            use.values[0] = 3;
        }
        uses.push_back(use);
    }
    return uses;
}

/// REF-A with drag, a current and the inertia that a pitching body needs.
Model base_model(bool mixed) {
    Model model =
        test::ref_a_model(0.02, 6, 0.01).with_effect(make_use("ambient_heave_current", {{"velocity", 0.013}}));
    model.vehicle.pitch_inertia = 0.02;
    model.vehicle.base_depth = 0.05;
    model.vehicle.base_half_length = 0.07;
    if (mixed) {
        model.drag_heave.kind = dynamics::DragLaw::Kind::mixed;
        model.drag_heave.length = 0.152;
    }
    return model;
}

struct Told {
    double acceleration = 0;
    HeaveSlopes slopes;
};

void expect_same(const Told& one, const Told& other, const std::string& who) {
    const double size = std::abs(one.acceleration) + 1e-3;
    EXPECT_NEAR(other.acceleration, one.acceleration, 1e-12 * size) << who;
    EXPECT_NEAR(other.slopes.gap, one.slopes.gap, 1e-12 * (std::abs(one.slopes.gap) + 1))
        << who << ": slope along the gap";
    EXPECT_NEAR(other.slopes.velocity, one.slopes.velocity, 1e-12 * (std::abs(one.slopes.velocity) + 1))
        << who << ": slope along the velocity";
}

void compare_at(const Model& model, const std::string& name, double t, double h, double w, double u) {
    const HeavePlant plant(model);
    const std::string who = name + " at h " + test::number(h) + ", w " + test::number(w);
    std::vector<double> memory(history_states, -w);  // as after long steady motion: it pulls nothing, but has its mass
    const bool history = plant.terms.history != 0;
    const double* kept = history ? memory.data() : nullptr;
    Told simulation;
    simulation.acceleration = plant.acceleration(h, w, {t, u}, kept, simulation.slopes);
    EXPECT_EQ(plant.acceleration(h, w, {t, u}, kept), simulation.acceleration) << who;

    HeaveRecord record;
    record.plant = std::make_shared<HeavePlant>(plant);
    HeaveExplanation explanation;
    explanation.terms = plant.terms;
    Told filter;
    filter.acceleration = acceleration_of(record, explanation, t, h, w, u, filter.slopes);
    if (history) {  // the memory follows the velocity in the filter's steps: its slope belongs to the simulator's law
                    // alone
        double weights = 0;
        for (const double weight : history_kernel().weight) {
            weights += weight;
        }
        filter.slopes.velocity -= plant.terms.history * weights / filter.slopes.mass;
    }
    expect_same(simulation, filter, who + ", discovery");

    const estimator::SeparatedPlant apart = estimator::separate(model, {});
    if (history) {
        EXPECT_FALSE(apart.remarks.empty());
    } else {
        EXPECT_TRUE(apart.remarks.empty()) << who;
        Told estimate;
        estimate.acceleration = apart.acceleration(h, w, u, t, estimate.slopes);
        expect_same(simulation, estimate, who + ", estimator");
    }

    // What the region integrates: the force at rest, and the resistance beside that at rest.
    if (plant.autonomous()) {
        double slope = 0;
        const double mass = plant.inertia(h, slope);
        const double moved =
            plant.static_force(h, {t, u}) + plant.resistance(h, 0) - plant.resistance(h, w) - 0.5 * slope * w * w;
        const bool both = std::any_of(plant.terms.corrections.begin(), plant.terms.corrections.end(),
                                      [](const auto& c) { return c.curve.empty(); });
        if (!both) {
            EXPECT_NEAR(moved / mass, simulation.acceleration, 1e-12 * (std::abs(simulation.acceleration) + 1e-3))
                << who;
        }
    }

    const HeavePitch pitch(model);
    PitchState rate{};
    Surroundings around;
    around.t = t;
    around.input = u;
    around.memory = kept;
    pitch.rate({h, w, 0, 0}, ContactState::free, rate, around);
    // The rise of the centre of gravity is that of heave; the base's centre turns about it where it lies aside.
    EXPECT_NEAR(rate[1] - pitch.arm(0) * rate[3], simulation.acceleration,
                1e-8 * (std::abs(simulation.acceleration) + 1e-3))
        << who << ", heave and pitch";

    // The slopes are those of the acceleration.
    const auto a = [&](double gap, double velocity) { return plant.acceleration(gap, velocity, {t, u}, kept); };
    const double dh = 1e-5 * h, dw = 1e-7;
    EXPECT_NEAR((a(h + dh, w) - a(h - dh, w)) / (2 * dh), simulation.slopes.gap,
                2e-5 * (std::abs(simulation.slopes.gap) + 0.1))
        << who;
    EXPECT_NEAR((a(h, w + dw) - a(h, w - dw)) / (2 * dw), simulation.slopes.velocity,
                2e-5 * (std::abs(simulation.slopes.velocity) + 0.1))
        << who;
}

TEST(OnePlant, SimulationDiscoveryAndEstimatorAgreeForEveryEffect) {
    core::Random random(5);
    for (const EffectUse& use : every_effect()) {
        for (const bool mixed : {false, true}) {
            const Model model = base_model(mixed).with_effect(use);
            for (int i = 0; i < 12; ++i) {
                compare_at(model, use.name, random.uniform(0, 20), random.uniform(0.002, 0.35),
                           random.uniform(-0.08, 0.08), random.uniform(-0.02, 0.02));
            }
        }
    }
}

TEST(OnePlant, AllEffectsAtOnce) {
    Model model = base_model(true);
    for (const EffectUse& use : every_effect()) {
        if (use.name != "history_force" && use.name != "declared_parameter") {
            model = model.with_effect(use);
        }
    }
    core::Random random(6);
    for (int i = 0; i < 100; ++i) {
        compare_at(model, "all", random.uniform(0, 20), random.uniform(0.002, 0.35), random.uniform(-0.08, 0.08),
                   random.uniform(-0.02, 0.02));
    }
}

TEST(OnePlant, TheEstimatorMovesAsTheSimulatorDoes) {
    for (const EffectUse& use : every_effect()) {
        if (use.name == "history_force") {
            continue;  // its memory is no state of the estimator, which says so
        }
        const Model model = base_model(false).with_effect(use);
        InputSignals inputs;
        inputs.held[Channel::input_force] = 0.012;
        TrajectoryOptions options;
        options.duration = 12;
        options.output_step = 1;
        const Trajectory exact = simulate(model, 0.12, 0.01, inputs, options);
        const estimator::SeparatedPlant plant = estimator::separate(model, {});
        const double felt = plant.actuator.felt(0.012);
        double h = 0.12, w = 0.01;
        for (int k = 0; k < 600; ++k) {
            plant.advance(h, w, felt, 0.02, 0.02 * k);
        }
        EXPECT_NEAR(h, exact.gap.back(), 2e-6) << use.name;
        EXPECT_NEAR(w, exact.heave_velocity.back(), 2e-6) << use.name;
    }
}

TEST(OnePlant, TheFilterRunsAtTenthsOfAMillimetreThroughAFilm) {
    // 12 mu G of a base of 71.7 x 53.6 mm: at 0.1 mm the film stops the body within 0.1 ms.
    const Model model =
        test::free_model(4, 0.02, 0.1, 5).with_effect(make_use("squeeze_film_damping", {{"coefficient", 6.7e-8}}));
    for (const double start : {3e-4, 1.5e-4, 1e-4, 5e-5}) {
        InputSignals inputs;
        for (int i = 0; i <= 200; ++i) {
            inputs.time.push_back(0.04 * i);
        }
        std::vector<double> u;
        for (const double t : inputs.time) {
            u.push_back(0.02 + 0.01 * std::sin(2 * t));
        }
        inputs.signals = {{Channel::input_force, u}};
        inputs.input_between = InputSignals::Between::held;
        TrajectoryOptions options;
        options.duration = 8;
        options.output_step = 0.04;
        const Trajectory exact = simulate(model, start, 0, inputs, options);
        HeaveRecord record;
        record.plant = std::make_shared<HeavePlant>(model);
        record.time = inputs.time;
        record.raw_time = inputs.time;
        record.raw_input = u;
        record.gap.assign(inputs.time.size(), start);
        prepare_input(record);
        HeaveExplanation explanation;
        explanation.terms = record.plant->terms;
        std::vector<double> predicted;
        free_run(record, explanation, record.held_input, 0, record.time.size() - 1, start, 0, predicted);
        ASSERT_EQ(predicted.size(), exact.gap.size());
        for (std::size_t i = 0; i < predicted.size(); ++i) {
            EXPECT_NEAR(predicted[i], exact.gap[i], 0.01 * start) << "from " << start << " at " << exact.time[i];
        }
    }
}

}  // namespace

}  // namespace underbody::discovery
