// FMUs of motions, loaded by a small importer of FMI 2.0, move as simulate() does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/exports/motion_fmu.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "tests/support/support.h"
#include "tests/surrogates/dynamics/models.h"
#include "tests/surrogates/tables/fmu_loader.h"
#include "tests/surrogates/tables/fmu_wine.h"

namespace underbody::dynamics {

namespace {

using ::testing::HasSubstr;
using underbody::test::ok;

/// An FMU that was written, unpacked and loaded, and its variables by name.
class LoadedMotion {
public:
    LoadedMotion(const Model& model, FmuMotion motion, std::vector<double> start, Conditions held = {}) {
        MotionFmuOptions options;
        options.motion = motion;
        options.start = std::move(start);
        options.held = held;
        written = export_motion_fmu(model, folder_.path() / "motion.fmu", options);
        entries = underbody::test::unzipped(core::read_file(written.file));
        const std::string& xml = entries.at("modelDescription.xml");
        const std::regex variable("<ScalarVariable name=\"([^\"]+)\" valueReference=\"([0-9]+)\"");
        for (auto at = std::sregex_iterator(xml.begin(), xml.end(), variable); at != std::sregex_iterator(); ++at) {
            references_[(*at)[1]] = static_cast<unsigned>(std::stoul((*at)[2]));
        }
        const std::size_t g = xml.find("guid=\"") + 6;
        guid_ = xml.substr(g, xml.find('"', g) - g);
        if (has_binary()) {
            core::write_file(folder_.path() / "motion.so", entries.at("binaries/linux64/motion.so"));
            fmu_ = std::make_unique<underbody::test::Fmu>(folder_.path() / "motion.so");
        }
    }
    ~LoadedMotion() {
        if (instance != nullptr) {
            fmu_->free(instance);
        }
    }
    LoadedMotion(const LoadedMotion&) = delete;
    LoadedMotion& operator=(const LoadedMotion&) = delete;

    [[nodiscard]] bool has_binary() const { return entries.contains("binaries/linux64/motion.so"); }
    /// 0: model exchange, 1: co-simulation.
    void begin(int type, double tolerance = 1e-11) {
        ASSERT_TRUE(fmu_->loaded()) << ::dlerror();
        instance = fmu_->instantiate(type, guid_);
        ASSERT_NE(instance, nullptr);
        ASSERT_EQ(call("fmi2SetupExperiment", 1, tolerance, 0.0, 0, 0.0), ok);
        ASSERT_EQ(call("fmi2EnterInitializationMode"), ok);
    }
    void started() { ASSERT_EQ(call("fmi2ExitInitializationMode"), ok); }
    template <class... Arguments>
    int call(const char* name, Arguments... arguments) {
        return fmu_->call(name, instance, arguments...);
    }
    [[nodiscard]] const std::string& guid() const { return guid_; }
    [[nodiscard]] unsigned reference(const std::string& name) const { return references_.at(name); }
    double get(const std::string& name) {
        const unsigned vr = reference(name);
        double value = 0;
        EXPECT_EQ(call("fmi2GetReal", &vr, std::size_t{1}, &value), ok) << name;
        return value;
    }
    void set(const std::string& name, double value) {
        const unsigned vr = reference(name);
        ASSERT_EQ(
            call("fmi2SetReal", static_cast<const unsigned*>(&vr), std::size_t{1}, static_cast<const double*>(&value)),
            ok)
            << name;
    }
    void slope(const std::string& name, double value) {
        const unsigned vr = reference(name);
        const int order = 1;
        ASSERT_EQ(call("fmi2SetRealInputDerivatives", static_cast<const unsigned*>(&vr), std::size_t{1}, &order,
                       static_cast<const double*>(&value)),
                  ok);
    }
    void step(double t, double width) { ASSERT_EQ(call("fmi2DoStep", t, width, 1), ok) << "at " << t; }

    MotionFmu written;
    std::map<std::string, std::string> entries;
    void* instance = nullptr;

private:
    core::TemporaryFolder folder_;
    std::unique_ptr<underbody::test::Fmu> fmu_;
    std::map<std::string, unsigned> references_;
    std::string guid_;
};

#define NEEDS_BINARY(motion)                                                \
    if (!(motion).has_binary()) {                                           \
        GTEST_SKIP() << "skipped: no C compiler, so the FMU has no binary"; \
    }

TrajectoryOptions sharp(double duration, double step) {
    TrajectoryOptions options;
    options.duration = duration;
    options.output_step = step;
    options.tolerance = 1e-12;
    return options;
}

/// Every effect of the heave equation that stays a number.
Model with_everything(Model model) {
    model.contact.restitution = 0.4;
    return model.with_effect(make_use("tether_stiffness", {{"stiffness", 0.3}, {"gap", 0.08}}))
        .with_effect(make_use("actuator_lag", {{"time_constant", 0.2}}))
        .with_effect(make_use("input_dead_zone", {{"width", 0.002}}))
        .with_effect(make_use("input_gain", {{"gain", 1.1}}))
        .with_effect(make_use("coulomb_friction", {{"force", 0.003}}))
        .with_effect(make_use("squeeze_film_damping", {{"coefficient", 2e-7}}))
        .with_effect(make_use("linear_damping", {{"coefficient", 0.05}}))
        .with_effect(make_use("quadratic_damping", {{"coefficient", 2}}))
        .with_effect(make_use("ambient_heave_current", {{"velocity", 0.002}}))
        .with_effect(make_use("history_force", {{"area", 0.01}}))
        .with_effect(make_use("gap_dependent_added_mass", {{"mass", 0.5}, {"length", 0.02}}))
        .with_effect(make_use("thrust_by_gap", {{"loss", 0.2}, {"length", 0.03}}))
        .with_effect(make_use("growing_force", {{"rate", 2e-4}, {"force", -0.001}}))
        .with_effect(
            make_use("surface_roughness", {{"near", 0.1}, {"far", 0.05}, {"length", 0.01}, {"sharpness", 1.4}}))
        .with_effect(make_use("periodic_disturbance", {{"amplitude", 0.004}, {"frequency", 0.5}, {"phase", 0.3}}));
}

void expect_heave(const Model& model, double gap, double velocity, double force, double duration, double within) {
    LoadedMotion motion(model, FmuMotion::heave, {gap, velocity});
    NEEDS_BINARY(motion);
    motion.begin(1);
    motion.set("input_force", force);
    motion.started();
    InputSignals inputs;
    inputs.held[Channel::input_force] = force;
    const double step = 0.1;
    const Trajectory wanted = simulate(model, gap, velocity, inputs, sharp(duration, step));
    double t = 0;
    for (std::size_t i = 0; i < wanted.time.size(); ++i) {
        ASSERT_NEAR(wanted.time[i], t, 1e-9);
        ASSERT_NEAR(motion.get("gap"), wanted.gap[i], within) << "at " << t;
        ASSERT_NEAR(motion.get("heave_velocity"), wanted.heave_velocity[i], within) << "at " << t;
        ASSERT_NEAR(motion.get("lift_force"), wanted.lift_force[i], 100 * within) << "at " << t;
        motion.step(t, step);
        t = static_cast<double>(i + 1) * step;
    }
}

TEST(MotionFmu, InHeaveMovesAsSimulateDoes) {
    expect_heave(test::ref_a_model(), 0.1, 0, 0, 30, 1e-9);
    expect_heave(test::ref_a_model(0.1, 15, 0.005), 0.3, -0.05, 0.002, 30, 1e-9);
}

TEST(MotionFmu, CarriesTheEffectsOfTheHeaveEquation) {
    expect_heave(with_everything(test::ref_a_model(0.1, 15)), 0.1, 0.01, 0.01, 20, 1e-9);
}

TEST(MotionFmu, BouncesAndRestsAndLeavesTheGround) {
    Model heavy = test::ref_a_model(0.1, 15, 0.06);
    heavy.contact.gap = 0.01;
    heavy.contact.restitution = 0.6;
    // Falls, bounces, comes to rest; a slow wave lifts it off again.
    heavy =
        heavy.with_effect(make_use("periodic_disturbance", {{"amplitude", 0.08}, {"frequency", 0.05}, {"phase", 3.2}}));
    InputSignals none;
    const Trajectory wanted = simulate(heavy, 0.05, 0, none, sharp(60, 0.1));
    std::map<std::string, int> kinds;
    for (const TrajectoryEvent& event : wanted.events) {
        ++kinds[event.kind];
    }
    ASSERT_GT(kinds["contact"], 3) << "it bounces";
    ASSERT_GT(kinds["lift_off"], 0) << "and is lifted again";
    expect_heave(heavy, 0.05, 0, 0, 60, 1e-7);  // each bounce multiplies the differences of the two integrators
}

TEST(MotionFmu, TakesInputsThatAreLinearBetweenSamples) {
    const Model model = read_model(underbody::test::source_folder() / "cases/evie/model.toml");
    LoadedMotion motion(model, FmuMotion::heave, {0.02, 0});
    NEEDS_BINARY(motion);
    InputSignals inputs;
    core::Random random(3);
    const double step = 0.05;
    std::vector<double> force, speed, voltage;
    for (int i = 0; i <= 200; ++i) {
        inputs.time.push_back(step * i);
        force.push_back(0.15 + 0.05 * random.normal());
        speed.push_back(0.35 + 0.1 * std::sin(0.02 * i));
        voltage.push_back(6 + 3 * std::cos(0.03 * i));
    }
    inputs.signals = {{Channel::input_force, force}, {Channel::speed, speed}, {Channel::jet_voltage, voltage}};
    // Between samples simulate() draws the factors of forces as straight lines over its half steps, the FMU what they
    // scale: they meet as the square of that step.
    const Trajectory wanted = simulate(model, 0.02, 0, inputs, sharp(10, step));
    motion.begin(1);
    motion.set("input_force", force[0]);
    motion.set("speed", speed[0]);
    motion.set("jet_voltage", voltage[0]);
    motion.started();
    for (std::size_t i = 0; i + 1 < force.size(); ++i) {
        ASSERT_NEAR(motion.get("gap"), wanted.gap[i], 1e-7) << "sample " << i;
        for (const auto& [name, values] : {std::pair<const char*, const std::vector<double>&>{"input_force", force},
                                           {"speed", speed},
                                           {"jet_voltage", voltage}}) {
            motion.set(name, values[i]);
            motion.slope(name, (values[i + 1] - values[i]) / step);
        }
        motion.step(step * static_cast<double>(i), step);
    }
}

void expect_pitch(const Model& model, const PitchState& start, const Conditions& held, double duration, double within,
                  bool touches) {
    LoadedMotion motion(model, FmuMotion::heave_pitch, {start.begin(), start.end()}, held);
    NEEDS_BINARY(motion);
    const HeavePitch plant(model, held);
    const PitchTrajectory wanted = simulate(plant, start, sharp(duration, 0.05));
    ASSERT_EQ(touches, !wanted.events.empty());
    motion.begin(1);
    motion.started();
    static const char* const names[] = {"gap", "heave_velocity", "pitch", "pitch_rate"};
    for (std::size_t i = 0; i < wanted.time.size(); ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            ASSERT_NEAR(motion.get(names[k]), wanted.state[i][k], within) << names[k] << " at " << wanted.time[i];
        }
        ASSERT_NEAR(motion.get("pitch_moment"), wanted.moment[i], 10 * within);
        ASSERT_EQ(motion.get("contact"), static_cast<int>(wanted.contact[i])) << "at " << wanted.time[i];
        motion.step(0.05 * static_cast<double>(i), 0.05);
    }
}

Conditions at_speed(double speed) {
    Conditions held;
    held[Channel::speed] = speed;
    held[Channel::jet_voltage] = 0;
    return held;
}

TEST(MotionFmu, InHeaveAndPitchMovesAsSimulateDoes) {
    const Model model = read_model(underbody::test::source_folder() / "cases/evie/model.toml");
    expect_pitch(model, {0.012, 0.01, 0.02, 0}, at_speed(0.35), 1.0, 1e-9, false);
    expect_pitch(with_everything(model), {0.03, 0, 0.01, 0}, at_speed(0), 0.8, 1e-9, false);
}

TEST(MotionFmu, InHeaveAndPitchLandsAsSimulateDoes) {
    Model model = read_model(underbody::test::source_folder() / "cases/evie/model.toml");
    expect_pitch(model, {0.01, -0.02, 0.05, 0}, at_speed(0), 6, 1e-8, true);
    model.contact.restitution = 0.3;
    expect_pitch(model, {0.01, -0.02, -0.03, 0}, at_speed(0.2), 3, 1e-7, true);
}

void expect_body(const Model& model, const BodyState& start, const std::vector<double>& thrust, double duration,
                 double within, bool touches) {
    LoadedMotion motion(model, FmuMotion::body, {start.begin(), start.end()});
    NEEDS_BINARY(motion);
    const RigidBody body(model);
    BodyOptions options;
    options.duration = duration;
    options.output_step = 0.05;
    options.tolerance = 1e-12;
    const BodyTrajectory wanted = simulate_body(
        body, start, [&](double, const BodyState&) { return thrust; }, options);
    ASSERT_EQ(touches, std::any_of(wanted.contact.begin(), wanted.contact.end(),
                                   [](ContactState state) { return state != ContactState::free; }));
    motion.begin(1);
    for (std::size_t k = 0; k < thrust.size(); ++k) {
        motion.set(model.jets[k].name + "_command", thrust[k]);
    }
    motion.started();
    for (std::size_t i = 0; i < wanted.time.size(); ++i) {
        for (std::size_t k = 0; k < start.size(); ++k) {
            ASSERT_NEAR(motion.get(body_state_names()[k]), wanted.state[i][k], within)
                << body_state_names()[k] << " at " << wanted.time[i];
        }
        ASSERT_NEAR(motion.get("gap"), wanted.gap[i], within);
        ASSERT_NEAR(motion.get("drag_force"), wanted.loads[i].drag, 10 * within);
        ASSERT_NEAR(motion.get("nose_edge_force"), wanted.normal[i][0], 1e4 * within) << "at " << wanted.time[i];
        ASSERT_EQ(motion.get("contact"), static_cast<int>(wanted.contact[i])) << "at " << wanted.time[i];
        motion.step(0.05 * static_cast<double>(i), 0.05);
    }
}

BodyState body_start(const Model& model, double gap, double pitch, double speed) {
    const RigidBody body(model);
    BodyState y{};
    y[state_u] = speed;
    y[state_v] = 0.01;
    y[state_r] = 0.05;
    y[state_theta] = pitch;
    y[state_w] = body.down_velocity_for(0, y);
    y[state_z] = body.height_for_gap(gap, pitch);
    return y;
}

TEST(MotionFmu, OfTheBodyMovesAsSimulateDoes) {
    const Model model = read_model(underbody::test::source_folder() / "cases/evie/model.toml");
    const std::vector<double> thrust{0.1, 0.08, 0, 0.02, 0, 0, 0.03, 0, 0.02};
    expect_body(model, body_start(model, 0.03, 0.01, 0.35), thrust, 1.0, 1e-9, false);
}

TEST(MotionFmu, OfTheBodySlidesOverTheGroundAsSimulateDoes) {
    const Model model = read_model(underbody::test::source_folder() / "cases/evie/model.toml");
    const std::vector<double> thrust{0.2, 0.15, 0, 0, 0, 0, 0, 0, 0};
    expect_body(model, body_start(model, 0.01, 0.03, 0.2), thrust, 4, 1e-6, true);
}

/// Derivatives of everything along random directions against fourth-order differences of the FMU itself.
void check_slopes(LoadedMotion& motion, const std::vector<double>& centre, const std::vector<double>& spread,
                  const std::vector<std::pair<std::string, double>>& inputs) {
    motion.begin(0);
    for (const auto& [name, value] : inputs) {
        motion.set(name, value);
    }
    motion.started();
    const std::size_t n = motion.written.states.size();
    std::vector<unsigned> known, unknown;
    for (const auto& [name, value] : inputs) {
        known.push_back(motion.reference(name));
    }
    for (const MotionFmuVariable& state : motion.written.states) {
        known.push_back(motion.reference(state.name));
        unknown.push_back(motion.reference("der(" + state.name + ")"));
    }
    for (const MotionFmuVariable& output : motion.written.outputs) {
        unknown.push_back(motion.reference(output.name));
    }
    core::Random random(11);
    int compared = 0, all = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<double> x(n), along(known.size()), change(unknown.size());
        for (std::size_t i = 0; i < n; ++i) {
            x[i] = (i < centre.size() ? centre[i] : 0) + (i < spread.size() ? spread[i] : 0.01) * random.uniform(-1, 1);
        }
        for (double& a : along) {
            a = random.uniform(-1, 1);
        }
        for (std::size_t i = 0; i < n; ++i) {  // a direction of the states' own sizes
            along[inputs.size() + i] *= i < spread.size() ? spread[i] : 0.01;
        }
        const auto place = [&](double by) {
            std::vector<double> moved = x;
            for (std::size_t i = 0; i < n; ++i) {
                moved[i] += by * along[inputs.size() + i];
            }
            ASSERT_EQ(motion.call("fmi2SetContinuousStates", static_cast<const double*>(moved.data()), n), ok);
            for (std::size_t i = 0; i < inputs.size(); ++i) {
                motion.set(inputs[i].first, inputs[i].second + by * along[i]);
            }
        };
        place(0);
        ASSERT_EQ(motion.call("fmi2GetDirectionalDerivative", static_cast<const unsigned*>(unknown.data()),
                              unknown.size(), static_cast<const unsigned*>(known.data()), known.size(),
                              static_cast<const double*>(along.data()), change.data()),
                  ok);
        // Two step sizes: where the differences of both do not meet, a kink of a table or a limit lies between.
        std::vector<double> coarse(unknown.size()), fine(unknown.size());
        for (const auto& [width, result] : {std::pair{2e-4, &coarse}, std::pair{1e-4, &fine}}) {
            for (const auto& [factor, weight] :
                 {std::pair{-2.0, 1.0}, std::pair{-1.0, -8.0}, std::pair{1.0, 8.0}, std::pair{2.0, -1.0}}) {
                std::vector<double> at(unknown.size());
                place(factor * width);
                ASSERT_EQ(
                    motion.call("fmi2GetReal", static_cast<const unsigned*>(unknown.data()), unknown.size(), at.data()),
                    ok);
                for (std::size_t i = 0; i < at.size(); ++i) {
                    (*result)[i] += weight * at[i] / (12 * width);
                }
            }
        }
        for (std::size_t i = 0; i < unknown.size(); ++i) {
            const double size = std::max(std::abs(fine[i]), 1e-3);
            ++all;
            if (std::abs(coarse[i] - fine[i]) < 1e-8 * size) {
                ++compared;
                EXPECT_NEAR(change[i], fine[i], 3e-7 * size) << "unknown " << unknown[i] << ", trial " << trial;
            }
        }
    }
    EXPECT_GT(compared, 0.8 * all);
}

TEST(MotionFmu, GivesTrueDirectionalDerivatives) {
    const Model evie = read_model(underbody::test::source_folder() / "cases/evie/model.toml");
    {
        LoadedMotion motion(with_everything(evie), FmuMotion::heave, {0.02, 0});
        NEEDS_BINARY(motion);
        check_slopes(motion, {0.03, 0}, {0.02, 0.05},
                     {{"input_force", 0.1}, {"speed", 0.35}, {"jet_voltage", 6.0}, {"pitch", 0.01}});
    }
    {
        LoadedMotion motion(with_everything(evie), FmuMotion::heave_pitch, {0.02, 0, 0, 0}, at_speed(0.35));
        check_slopes(motion, {0.03, 0, 0, 0}, {0.015, 0.05, 0.05, 0.2}, {{"input_force", 0.1}, {"jet_voltage", 6.0}});
    }
    LoadedMotion motion(with_everything(evie), FmuMotion::body, std::vector<double>{0, 0, 0, 0, 0, 0, 0, 0, 0, -0.1});
    check_slopes(motion, {0.35, 0, 0, 0, 0, 0, 0.3, 0, 0, -0.07}, {0.2, 0.1, 0.1, 0.2, 0.2, 0.05, 1, 1, 1, 0.02},
                 {{"input_force", 0.1}, {"J1_command", 0.1}, {"Jj_command", 0.02}, {"jet_voltage", 6.0}});
}

TEST(MotionFmu, InModelExchangeGivesTheDerivativesOfThePlantAndItsContact) {
    Model model = test::ref_a_model(0.1, 15, 0.06);
    model.contact.gap = 0.01;
    model.contact.restitution = 0.6;
    LoadedMotion motion(model, FmuMotion::heave, {0.05, 0});
    NEEDS_BINARY(motion);
    motion.begin(0);
    motion.started();
    const HeavePlant plant(model);
    core::Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const double x[2] = {random.uniform(0.0, 2.0), random.uniform(-0.1, 0.1)};
        double rate[2];
        ASSERT_EQ(motion.call("fmi2SetContinuousStates", static_cast<const double*>(x), std::size_t{2}), ok);
        ASSERT_EQ(motion.call("fmi2GetDerivatives", static_cast<double*>(rate), std::size_t{2}), ok);
        ASSERT_EQ(rate[0], x[1]);
        ASSERT_NEAR(rate[1], plant.acceleration(x[0], x[1], plant.held_moment()), 1e-15);
        double z = 0;
        ASSERT_EQ(motion.call("fmi2GetEventIndicators", &z, std::size_t{1}), ok);
        ASSERT_EQ(z, x[0] - 0.01);
    }
    const double struck[2] = {0.01 - 1e-9, -0.05};
    struct {
        int flags[5];
        double next;
    } event = {};
    double after[2];
    ASSERT_EQ(motion.call("fmi2SetContinuousStates", static_cast<const double*>(struck), std::size_t{2}), ok);
    ASSERT_EQ(motion.call("fmi2NewDiscreteStates", static_cast<void*>(&event)), ok);
    EXPECT_EQ(event.flags[3], 1) << "states changed";
    ASSERT_EQ(motion.call("fmi2GetContinuousStates", static_cast<double*>(after), std::size_t{2}), ok);
    EXPECT_EQ(after[0], 0.01);
    EXPECT_DOUBLE_EQ(after[1], 0.6 * 0.05);
}

/// Random commands at even times: in all steps of co-simulation.
std::vector<double> commands(int count, std::uint64_t seed) {
    core::Random random(seed);
    std::vector<double> force;
    for (int i = 0; i < count; ++i) {
        force.push_back(0.02 * random.normal());
    }
    return force;
}

Model late_model(double delay) {
    return with_everything(test::ref_a_model(0.1, 15)).with_effect(make_use("input_delay", {{"delay", delay}}));
}

TEST(MotionFmu, DelaysTheInputForceAsSimulateDoes) {
    // Shorter than a step of the simulator that drives it, one step, several, and no delay to compare with. Without a
    // dead zone, which simulate() draws as straight lines over its half steps.
    for (const double delay : {0.0, 0.0173, 0.025, 0.05, 0.6}) {
        Model model = test::ref_a_model(0.1, 15).with_effect(make_use("actuator_lag", {{"time_constant", 0.2}}));
        if (delay > 0) {
            model = model.with_effect(make_use("input_delay", {{"delay", delay}}));
        }
        LoadedMotion motion(model, FmuMotion::heave, {0.1, 0});
        NEEDS_BINARY(motion);
        EXPECT_TRUE(motion.written.remarks.empty());
        const double step = 0.05;
        InputSignals inputs;
        const std::vector<double> force = commands(201, 17);
        for (std::size_t i = 0; i < force.size(); ++i) {
            inputs.time.push_back(step * static_cast<double>(i));
        }
        inputs.signals = {{Channel::input_force, force}};
        const Trajectory wanted = simulate(model, 0.1, 0, inputs, sharp(10, step));
        motion.begin(1);
        motion.set("input_force", force[0]);
        motion.started();
        for (std::size_t i = 0; i + 1 < force.size(); ++i) {
            ASSERT_NEAR(motion.get("gap"), wanted.gap[i], 1e-7) << "delay " << delay << " at " << wanted.time[i];
            motion.set("input_force", force[i]);
            motion.slope("input_force", (force[i + 1] - force[i]) / step);
            motion.step(step * static_cast<double>(i), step);
        }
    }
}

void expect_given_later(double delay) {
    // Jumps in the middle of steps against an FMU without delay that is stepped from jump to jump.
    const double step = 0.02;
    LoadedMotion late(late_model(delay), FmuMotion::heave, {0.1, 0}),
        prompt(with_everything(test::ref_a_model(0.1, 15)), FmuMotion::heave, {0.1, 0});
    NEEDS_BINARY(late);
    const std::vector<double> force = commands(2000, 23);
    for (LoadedMotion* one : {&late, &prompt}) {
        one->begin(1);
        one->set("input_force", force[0]);
        one->started();
    }
    double reached = 0;
    void* kept = nullptr;
    for (std::size_t i = 0; i < force.size(); ++i) {
        late.set("input_force", force[i]);
        if (i % 100 == 50) {  // a step that is thrown away, with another command
            std::size_t size = 0;
            ASSERT_EQ(late.call("fmi2GetFMUstate", &kept), ok);
            ASSERT_EQ(late.call("fmi2SerializedFMUstateSize", kept, &size), ok);
            std::vector<char> bytes(size);
            ASSERT_EQ(late.call("fmi2SerializeFMUstate", kept, bytes.data(), size), ok);
            late.set("input_force", 1);
            late.step(step * static_cast<double>(i), 3 * step);
            ASSERT_EQ(late.call("fmi2DeSerializeFMUstate", static_cast<const char*>(bytes.data()), size, &kept), ok);
            ASSERT_EQ(late.call("fmi2SetFMUstate", kept), ok);
            EXPECT_EQ(late.call("fmi2DeSerializeFMUstate", static_cast<const char*>(bytes.data()), size - 1, &kept),
                      underbody::test::error);
        }
        late.step(step * static_cast<double>(i), step);
        const double end = step * static_cast<double>(i + 1);
        while (reached < end) {
            // The command that is felt after `reached`, and until when.
            const auto k = static_cast<std::size_t>(std::max(std::floor((reached - delay) / step + 1e-9), 0.0));
            prompt.set("input_force", force[std::min(k, i)]);
            const double next = std::min(end, step * static_cast<double>(k + 1) + delay);
            prompt.step(reached, next - reached);
            reached = next;
        }
        ASSERT_NEAR(late.get("gap"), prompt.get("gap"), 1e-9) << "at " << end;
        ASSERT_NEAR(late.get("heave_velocity"), prompt.get("heave_velocity"), 1e-9) << "at " << end;
    }
    ASSERT_EQ(late.call("fmi2FreeFMUstate", &kept), ok);
}

TEST(MotionFmu, DelaysAHeldCommandAsOneThatIsGivenLater) {
    expect_given_later(0.0731);
    expect_given_later(0.007);  // shorter than a step: what was commanded before the step is felt in it
}

struct EventInfo {
    int flags[5];  ///< the last: is there a time of a next event?
    double next;
};

TEST(MotionFmu, DelaysTheInputForceInModelExchange) {
    // A jump commanded at 0.1 s arrives 0.0731 s later, by an event; steps of Runge and Kutta between the events.
    const double delay = 0.0731;
    LoadedMotion exchanged(late_model(delay), FmuMotion::heave, {0.1, 0}),
        own(late_model(delay), FmuMotion::heave, {0.1, 0});
    NEEDS_BINARY(exchanged);
    EXPECT_EQ(exchanged.entries.at("modelDescription.xml").find("completedIntegratorStepNotNeeded"), std::string::npos);
    EXPECT_THAT(exchanged.entries.at("modelDescription.xml"), HasSubstr("which it reaches 0.0731 s later"));
    exchanged.begin(0);
    exchanged.started();
    const std::size_t n = exchanged.written.states.size();
    EventInfo event{};
    const auto settle = [&] {
        ASSERT_EQ(exchanged.call("fmi2EnterEventMode"), ok);
        ASSERT_EQ(exchanged.call("fmi2NewDiscreteStates", static_cast<void*>(&event)), ok);
        ASSERT_EQ(exchanged.call("fmi2EnterContinuousTimeMode"), ok);
    };
    const auto rates = [&](double t, const std::vector<double>& x) {
        std::vector<double> rate(n);
        EXPECT_EQ(exchanged.call("fmi2SetTime", t), ok);
        EXPECT_EQ(exchanged.call("fmi2SetContinuousStates", x.data(), n), ok);
        EXPECT_EQ(exchanged.call("fmi2GetDerivatives", rate.data(), n), ok);
        return rate;
    };
    std::vector<double> x(n);
    ASSERT_EQ(exchanged.call("fmi2GetContinuousStates", x.data(), n), ok);
    const auto go = [&](double from, double to) {
        const int steps = 200;
        const double h = (to - from) / steps;
        for (int i = 0; i < steps; ++i) {
            const double t = from + i * h;
            const auto at = [&](double part, const std::vector<double>& k) {
                std::vector<double> y = x;
                for (std::size_t j = 0; j < n; ++j) {
                    y[j] += part * h * k[j];
                }
                return y;
            };
            const auto k1 = rates(t, x), k2 = rates(t + h / 2, at(0.5, k1)), k3 = rates(t + h / 2, at(0.5, k2)),
                       k4 = rates(i + 1 < steps ? t + h : to, at(1, k3));
            for (std::size_t j = 0; j < n; ++j) {
                x[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
            }
            rates(i + 1 < steps ? t + h : to, x);
            int wanted = 0, over = 0;
            ASSERT_EQ(exchanged.call("fmi2CompletedIntegratorStep", 1, &wanted, &over), ok);
        }
    };
    settle();
    EXPECT_EQ(event.flags[4], 0) << "nothing is on its way";
    go(0, 0.1);
    exchanged.set("input_force", 0.02);
    settle();
    ASSERT_EQ(event.flags[4], 1);
    EXPECT_NEAR(event.next, 0.1 + delay, 1e-12);
    go(0.1, event.next);
    EXPECT_EQ(exchanged.get("applied_force"), 0) << "the lag begins here";
    const double arrived = event.next;
    settle();
    EXPECT_EQ(event.flags[4], 0);
    go(arrived, 0.5);
    own.begin(1);
    own.started();
    own.step(0, 0.1);
    own.set("input_force", 0.02);
    own.step(0.1, 0.4);
    EXPECT_NEAR(x[0], own.get("gap"), 1e-10);
    EXPECT_NEAR(x[1], own.get("heave_velocity"), 1e-10);
    EXPECT_NEAR(exchanged.get("applied_force"), own.get("applied_force"), 1e-10);
    EXPECT_GT(own.get("applied_force"), 0.01);
    // What is commanded now changes nothing now.
    const unsigned unknown = exchanged.reference("der(acting_force)"), known = exchanged.reference("input_force");
    double along = 1, change = 1;
    ASSERT_EQ(exchanged.call("fmi2GetDirectionalDerivative", &unknown, std::size_t{1}, &known, std::size_t{1}, &along,
                             &change),
              ok);
    EXPECT_EQ(change, 0);
}

TEST(MotionFmu, AJumpOfTheInputLiftsABodyThatLies) {
    Model model = test::ref_a_model(0.1, 15, 0.06);
    model.contact.gap = 0.01;
    for (const double delay : {0.0, 0.25}) {
        const Model late = delay > 0 ? model.with_effect(make_use("input_delay", {{"delay", delay}})) : Model(model);
        LoadedMotion motion(late, FmuMotion::heave, {0.01, 0});
        NEEDS_BINARY(motion);
        motion.begin(1);
        motion.started();
        motion.step(0, 1);
        EXPECT_EQ(motion.get("contact"), 1);
        motion.set("input_force", 2);
        motion.step(1, 0.2);
        EXPECT_EQ(motion.get("contact"), delay > 0 ? 1 : 0);
        motion.step(1.2, 1);
        EXPECT_EQ(motion.get("contact"), 0);
        EXPECT_GT(motion.get("gap"), 0.02);
    }
}

TEST(MotionFmu, KeepsAndRestoresItsState) {
    LoadedMotion motion(with_everything(test::ref_a_model(0.1, 15)), FmuMotion::heave, {0.1, 0});
    NEEDS_BINARY(motion);
    motion.begin(1);
    motion.started();
    motion.step(0, 1);
    void* kept = nullptr;
    ASSERT_EQ(motion.call("fmi2GetFMUstate", &kept), ok);
    motion.step(1, 1);
    const double once = motion.get("gap");
    ASSERT_EQ(motion.call("fmi2SetFMUstate", kept), ok);
    motion.step(1, 1);
    EXPECT_EQ(motion.get("gap"), once);
    ASSERT_EQ(motion.call("fmi2FreeFMUstate", &kept), ok);
}

TEST(MotionFmu, UnderWindowsMovesAsHere) {
    UNDERBODY_NEEDS_WINE();
    const Model model = read_model(underbody::test::source_folder() / "cases/evie/model.toml");
    const PitchState start{0.01, -0.02, 0.05, 0};
    LoadedMotion motion(model, FmuMotion::heave_pitch, {start.begin(), start.end()}, at_speed(0));
    ASSERT_TRUE(motion.entries.contains("binaries/win64/motion.dll"));
    const std::string gap = std::to_string(motion.reference("gap")), pitch = std::to_string(motion.reference("pitch"));
    std::string commands;
    for (int i = 0; i < 2000; ++i) {
        commands += "get 2 " + gap + " " + pitch + "\nstep " + core::format_number(0.003 * i) + " 0.003\n";
    }
    const std::vector<double> out =
        underbody::test::called_under_wine(motion.entries.at("binaries/win64/motion.dll"), motion.guid(), commands);
    ASSERT_EQ(out.size(), 4000U);
    motion.begin(1, 1e-10);
    motion.started();
    for (std::size_t i = 0; i < 2000; ++i) {
        ASSERT_NEAR(out[2 * i], motion.get("gap"), 1e-10) << "step " << i;
        ASSERT_NEAR(out[2 * i + 1], motion.get("pitch"), 1e-9) << "step " << i;
        motion.step(0.003 * static_cast<double>(i), 0.003);
    }
}

TEST(MotionFmu, UnderWindowsDelaysTheInputForceAsHere) {
    UNDERBODY_NEEDS_WINE();
    const double step = 0.02;
    LoadedMotion motion(late_model(0.0731), FmuMotion::heave, {0.1, 0});
    const std::string force = std::to_string(motion.reference("input_force")),
                      gap = std::to_string(motion.reference("gap"));
    const std::vector<double> given = commands(2000, 29);
    std::string lines;
    for (std::size_t i = 0; i < given.size(); ++i) {
        lines += "set 1 " + force + " " + core::format_number(given[i]) + "\nstep " +
                 core::format_number(step * static_cast<double>(i)) + " " + core::format_number(step) + "\nget 1 " +
                 gap + "\n";
    }
    const std::vector<double> out =
        underbody::test::called_under_wine(motion.entries.at("binaries/win64/motion.dll"), motion.guid(), lines);
    ASSERT_EQ(out.size(), given.size());
    motion.begin(1, 1e-10);
    motion.started();
    for (std::size_t i = 0; i < given.size(); ++i) {
        motion.set("input_force", given[i]);
        motion.step(step * static_cast<double>(i), step);
        ASSERT_NEAR(out[i], motion.get("gap"), 1e-10) << "step " << i;
    }
}

TEST(MotionFmu, SaysWhatItCannotCarry) {
    core::TemporaryFolder folder;
    MotionFmuOptions options;
    options.start = {-0.01, 0};
    Model model = test::free_model(2, 0.1, 0.1, 1);
    try {
        export_motion_fmu(model, folder.path() / "m.fmu", options);
        FAIL() << "a start in the ground";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("10 mm below"));
    }
    options.start = {0.1, 0};
    core::write_file(folder.path() / "notes.fmu", "my notes");
    EXPECT_THROW(export_motion_fmu(model, folder.path() / "notes.fmu", options), core::InputError);
    EXPECT_EQ(core::read_file(folder.path() / "notes.fmu"), "my notes");
    export_motion_fmu(model.with_effect(make_use("input_delay", {{"delay", 0.05}})), folder.path() / "m.fmu", options);
    const std::string first = core::read_file(folder.path() / "m.fmu");
    export_motion_fmu(model.with_effect(make_use("input_delay", {{"delay", 0.05}})), folder.path() / "m.fmu", options);
    EXPECT_EQ(first, core::read_file(folder.path() / "m.fmu")) << "the same model must give the same bytes";
}

TEST(MotionFmu, RefusesEffectsThatItsCodeDoesNotKnow) {
    core::TemporaryFolder folder("fmu-effects");
    MotionFmuOptions options;
    options.motion = FmuMotion::body;
    const Model vehicle = read_model_text(
        "[vehicle]\nmass = 2\nnet_weight = 1\nroll_inertia = 0.01\npitch_inertia = 0.01\nyaw_inertia = 0.01\n"
        "base_depth = 0.03\nbase_half_length = 0.05\n",
        "body.toml", ".");
    for (const char* effect : {"moment_offset", "yaw_moment_offset"}) {
        try {
            export_motion_fmu(vehicle.with_effect(make_use(effect, {{"moment", 0.001}})), folder.path() / "a.fmu",
                              options);
            FAIL() << effect << " would be left out in silence";
        } catch (const core::InputError& error) {
            EXPECT_NE(std::string(error.what()).find(effect), std::string::npos) << error.what();
        }
    }
}

}  // namespace

}  // namespace underbody::dynamics
