// Motions whose forces are fast beside the time step: films at small gaps, steep springs, hard friction; and what
// predict says of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/file.h"
#include "core/random.h"
#include "surrogates/dynamics/simulate/measured_motion.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

InputSignals rocking(double duration, double step, double mean, double amplitude) {
    InputSignals inputs;
    std::vector<double> u;
    for (int i = 0; i * step < duration + 1e-9; ++i) {
        inputs.time.push_back(i * step);
        u.push_back(mean + amplitude * std::sin(1.7 * inputs.time.back()));
    }
    inputs.signals = {{Channel::input_force, u}};
    inputs.input_between = InputSignals::Between::held;
    return inputs;
}

double worst_beside_cvode(const Model& model, double gap, double velocity, const InputSignals& inputs, double duration,
                          double step) {
    TrajectoryOptions options;
    options.duration = duration;
    options.output_step = step;
    const Trajectory exact = simulate(model, gap, velocity, inputs, options);
    const HeavePlant plant = plant_for(model, inputs);
    const HeaveRun run(plant, inputs);
    std::vector<double> fast(run.samples()), w(run.samples());
    run.simulate(plant, 0, run.samples() - 1, gap, velocity, fast, w);
    double worst = 0;
    for (std::size_t i = 0; i < std::min(fast.size(), exact.gap.size()); ++i) {
        worst = std::max(worst, std::isfinite(fast[i]) ? std::abs(fast[i] - exact.gap[i]) : 1e9);
    }
    return worst;
}

TEST(Stiff, FilmsOfEveryThicknessAgreeWithCvode) {
    for (const double film : {6.7e-8, 1e-6, 3e-5}) {
        const Model model =
            test::free_model(4, 0, 0.1, 5).with_effect(make_use("squeeze_film_damping", {{"coefficient", film}}));
        for (const double gap : {0.01, 1e-3, 2e-4, 5e-5}) {
            EXPECT_LT(worst_beside_cvode(model, gap, -0.02, rocking(10, 0.02, -0.005, 0.02), 10, 0.02),
                      2e-3 * gap + 1e-7)
                << "film " << film << " from " << gap;
        }
    }
}

/// A body that sinks onto its film, as predict follows it in heave with pitch or as a whole, beside the whole body as
/// CVODE has it; m.
double worst_of_sinking(const Model& model, const Motion& motion, double gap) {
    const RigidBody body(model);
    BodyState start{};
    start[state_w] = 0.01;
    start[state_z] = body.height_for_gap(gap, 0);
    BodyOptions options;
    options.duration = 4;
    options.output_step = 0.02;
    const BodyTrajectory exact = simulate_body(body, start, nullptr, options);
    MeasuredRun run;
    run.table.add_numbers("time", "s", exact.time);
    run.table.add_numbers("gap", "m", exact.gap);
    for (const auto& [name, unit] :
         {std::pair{"pitch", "rad"}, {"heading", "rad"}, {"position_x", "m"}, {"position_y", "m"}}) {
        run.table.add_numbers(name, unit, std::vector<double>(exact.time.size(), 0.0));
    }
    const std::unique_ptr<MeasuredMotion> followed = motion.run(model, run, {});
    const bool whole = &motion == &body_motion();
    MotionState begin{};
    begin[whole ? 2 : 0] = gap;
    begin[whole ? 7 : 1] = -0.01;
    const std::vector<MotionState> states = motion_from(*followed, begin, 0, exact.time.size() - 1);
    double worst = 0;
    for (std::size_t k = 0; k < states.size(); ++k) {
        const double error = std::abs(states[k][whole ? 2 : 0] - exact.gap[k]);
        worst = std::isfinite(error) ? std::max(worst, error) : 1e9;
    }
    return worst;
}

TEST(Stiff, FilmsOfCoupledMotionsAgreeWithCvode) {
    for (const double film : {6.7e-8, 1e-6}) {
        Model model =
            test::free_model(4, 0.05, 0.1, 5).with_effect(make_use("squeeze_film_damping", {{"coefficient", film}}));
        model.vehicle.roll_inertia = model.vehicle.pitch_inertia = model.vehicle.yaw_inertia = 0.007;
        model.vehicle.base_depth = 0.05;
        model.vehicle.base_half_length = 0.07;
        for (const double gap : {0.01, 2e-3, 6e-4}) {
            if (film < 1e-7 && gap < 1e-3) {
                continue;  // it comes to the ground
            }
            EXPECT_LT(worst_of_sinking(model, heave_pitch_motion(), gap), 2e-7) << "film " << film << " from " << gap;
            EXPECT_LT(worst_of_sinking(model, body_motion(), gap), 2e-7) << "film " << film << " from " << gap;
        }
    }
}

TEST(Stiff, SteepSpringsFrictionAndMemoryAgreeWithCvode) {
    const Model spring = test::spring_model(4e4, 4, 40, 0);  // 100 rad/s: two radians a step
    EXPECT_LT(worst_beside_cvode(spring, 0.1005, 0, rocking(5, 0.02, 0, 5), 5, 0.02), 2e-5);
    const Model stuck = test::free_model(4, 0, 0.1, 5).with_effect(make_use("coulomb_friction", {{"force", 1.0}}));
    EXPECT_LT(worst_beside_cvode(stuck, 0.1, 0.05, rocking(5, 0.02, 0, 1.5), 5, 0.02), 2e-5);
    const Model film =
        test::free_model(4, 0, 0.1, 5).with_effect(make_use("squeeze_film_damping", {{"coefficient", 1e-6}}));
    const Model remembering = film.with_effect(make_use("history_force", {{"area", 0.5}}));
    EXPECT_LT(worst_beside_cvode(remembering, 1e-3, -0.01, rocking(10, 0.02, -0.005, 0.02), 10, 0.02), 3e-6);
}

/// A run measured on `truth`, with white noise on the gap.
MeasuredRun measured(const Model& truth, const std::string& name, const InputSignals& inputs, double gap, double noise,
                     std::uint64_t seed) {
    const HeavePlant plant = plant_for(truth, inputs);
    const HeaveRun fine(plant, inputs, 0.001);
    std::vector<double> motion(fine.samples()), velocity(motion.size());
    fine.simulate(plant, 0, fine.samples() - 1, gap, 0, motion, velocity);
    core::Random random(seed);
    MeasuredRun run;
    run.name = name;
    std::vector<double> time, seen, u;
    for (std::size_t i = 0; i < inputs.time.size(); ++i) {
        time.push_back(inputs.time[i]);
        seen.push_back(motion[i] + noise * random.normal());
        u.push_back(inputs.signals[0].values[i]);
    }
    run.table.add_numbers("time", "s", time);
    run.table.add_numbers("gap", "m", seen);
    run.table.add_numbers("input_force", "N", u);
    return run;
}

TEST(Stiff, PredictFindsATrueModelWithAFilmTrue) {
    const Model model =
        test::free_model(4, 0.01, 0.1, 5).with_effect(make_use("squeeze_film_damping", {{"coefficient", 2e-6}}));
    Measurements data;
    for (int r = 0; r < 3; ++r) {
        data.runs.push_back(
            measured(model, "run-" + std::to_string(r), rocking(20, 0.02, 0.008, 0.03), 3e-3 - 1e-3 * r, 2e-5, 10 + r));
    }
    const Prediction found = predict(model, data);
    EXPECT_EQ(found.diverged, 0U);
    EXPECT_GT(found.windows, 15U);
    EXPECT_LT(found.channels[0].in_noise, 1.3);
    EXPECT_GT(found.channels[0].in_noise, 0.8);
}

TEST(Stiff, PredictSaysWhereAModelRunsAway) {
    const Model truth = test::spring_model(1.0, 4, 0.5, 0);
    const Model wrong =
        test::spring_model(-1.0, 4, 0.5, 0).with_effect(make_use("linear_damping", {{"coefficient", -60.0}}));
    Measurements data;
    data.runs.push_back(measured(truth, "run", rocking(20, 0.02, 0, 0.03), 0.12, 2e-5, 3));
    const Prediction found = predict(wrong, data);
    EXPECT_GT(found.diverged, 0U);
    const auto told = [](const core::Problem& p) { return p.message.find("run away") != std::string::npos; };
    EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), told));
}

TEST(Stiff, PredictReadsTheInputAsTheDataFitAndAsTheModelSays) {
    const Model model = test::spring_model(1.0, 4, 0.5, 0);
    for (const auto between : {InputSignals::Between::held, InputSignals::Between::linear}) {
        InputSignals inputs = rocking(40, 0.2, 0, 0.2);
        inputs.input_between = between;
        Measurements data;
        data.runs.push_back(measured(model, "run", inputs, 0.12, 2e-5, 4));
        const Prediction found = predict(model, data);
        EXPECT_EQ(found.input_between, between == InputSignals::Between::held ? "held" : "linear");
        EXPECT_EQ(found.input_between_from, "data");
        EXPECT_LT(found.channels[0].in_noise, 1.3);
        Model told = model;
        told.records.input_between = RecordReading::Between::held;
        EXPECT_EQ(predict(told, data).input_between_from, "declared");
    }
}

TEST(Stiff, AModelSaysHowItsLogsAreRead) {
    Model model = test::spring_model(1.0, 4, 0.5, 0);
    const InputSignals inputs = rocking(40, 0.02, 0, 0.2);
    MeasuredRun run = measured(model, "run", inputs, 0.12, 2e-5, 5);
    // Logged with its sign turned round and 0.3 s late.
    std::vector<double> late(inputs.time.size());
    for (std::size_t i = 0; i < late.size(); ++i) {
        late[i] = -inputs.signals[0].values[i >= 15 ? i - 15 : 0];
    }
    Measurements data;
    MeasuredRun logged;
    logged.name = "run";
    logged.table.add_numbers("time", "s", run.table.numbers("time"));
    logged.table.add_numbers("gap", "m", run.table.numbers("gap"));
    logged.table.add_numbers("input_force", "N", late);
    data.runs.push_back(logged);
    EXPECT_GT(predict(model, data).channels[0].in_noise, 50);
    const core::TemporaryFolder folder;
    model.records.input_factor = -1;
    model.records.input_advance = 0.3;
    model.records.input_between = RecordReading::Between::held;
    write_model(model, folder.path() / "model.toml");
    const Model again = read_model(folder.path() / "model.toml");
    EXPECT_EQ(again.records, model.records);
    EXPECT_LT(predict(again, data).channels[0].in_noise, 1.3);
    write_model(again, folder.path() / "twice.toml");
    EXPECT_EQ(read_model(folder.path() / "twice.toml").records, model.records);
}

/// Half a sample is how a log was written: discovery writes it into the model, which was refused when it was below
/// zero.
TEST(Stiff, ALogStampedWithinTheSampleBeforeIsReadBack) {
    Model model = test::spring_model(1.0, 4, 0.5, 0);
    const InputSignals inputs = rocking(40, 0.02, 0, 0.2);
    const MeasuredRun run = measured(model, "run", inputs, 0.12, 2e-5, 6);
    Measurements data;
    MeasuredRun logged;
    logged.name = "run";
    logged.table.add_numbers("time", "s", run.table.numbers("time"));
    logged.table.add_numbers("gap", "m", run.table.numbers("gap"));
    std::vector<double> values(inputs.time.size());  // what acts 0.3 s later stands in each row
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = inputs.signals[0].values[std::min(i + 15, values.size() - 1)];
    }
    logged.table.add_numbers("input_force", "N", values);
    data.runs.push_back(logged);
    EXPECT_GT(predict(model, data).channels[0].in_noise, 50);
    const core::TemporaryFolder folder;
    model.records.input_advance = -0.3;
    model.records.input_between = RecordReading::Between::held;
    write_model(model, folder.path() / "model.toml");
    const Model again = read_model(folder.path() / "model.toml");
    EXPECT_EQ(again.records, model.records);
    EXPECT_LT(predict(again, data).channels[0].in_noise, 1.5);
}

}  // namespace

}  // namespace underbody::dynamics
