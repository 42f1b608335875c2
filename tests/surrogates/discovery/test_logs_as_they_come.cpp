// Records as rigs give them: short and fast, with rows of other sensors between the readings, out of a vehicle's log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave/heave_record.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "tests/support/log_writers.h"
#include "tests/surrogates/discovery/make_data.h"

namespace underbody::discovery {
namespace {

/// 50 g on a spring of 200 N/m, ten swings a second, with more damping than its model knows.
struct FastRig {
    static dynamics::Model model() {
        return dynamics::read_model_text(
            "[vehicle]\nmass = 0.05\nnet_weight = 0\n[drag.heave]\nlinear = 0.05\n"
            "quadratic = 0\n[[effect]]\nname = \"tether_stiffness\"\nstiffness = 200\ngap = "
            "0.02\n",
            "fast.toml", ".");
    }
    double more_damping = 0;

    struct Run {
        std::vector<double> time, gap, push;
    };
    [[nodiscard]] Run run(std::uint64_t seed, double seconds, double rate) const {
        core::Random random(seed);
        double h = 0.02 + random.uniform(-0.004, 0.004), w = 0, u = 0;
        Run out;
        const auto count = static_cast<std::size_t>(seconds * rate);
        for (std::size_t i = 0; i < count; ++i) {
            if (i % (count / 5) == 0) {
                u = random.uniform(-0.3, 0.3);
            }
            out.time.push_back(static_cast<double>(i) / rate);
            out.gap.push_back(h + random.normal(0, 2e-5));
            out.push.push_back(u);
            constexpr int parts = 4;
            for (int k = 0; k < parts; ++k) {
                const double dt = 1 / rate / parts;
                const auto a = [&](double x, double v) {
                    return (u - 200 * (x - 0.02) - (0.05 + more_damping) * v) / 0.05;
                };
                const double a1 = a(h, w), wm = w + 0.5 * dt * a1, am = a(h + 0.5 * dt * w, wm);
                h += dt * wm;
                w += dt * am;
            }
        }
        return out;
    }
    [[nodiscard]] dynamics::Measurements data(double seconds, double rate) const {
        dynamics::Measurements all;
        all.noise["gap"] = 2e-5;
        for (std::uint64_t r = 0; r < 10; ++r) {
            const Run one = run(20 + r, seconds, rate);
            dynamics::MeasuredRun made;
            made.name = "run-" + std::to_string(r);
            made.table.source = made.name;
            made.table.add_numbers("time", "s", one.time);
            made.table.add_numbers("gap", "m", one.gap);
            made.table.add_numbers("input_force", "N", one.push);
            all.runs.push_back(std::move(made));
        }
        return all;
    }
};

DiscoverOptions quick() {
    DiscoverOptions options;
    options.consequence = false;
    options.figures = false;
    options.candidates = {"linear_damping", "constant_force", "added_mass"};
    return options;
}

TEST(ShortRuns, OfHalfASecondAreUsedInShorterSteps) {
    FastRig rig;
    const HeaveRecords records = prepare_heave_records(FastRig::model(), rig.data(0.5, 1500));
    ASSERT_EQ(records.records.size(), 10u);
    EXPECT_NEAR(records.step, 0.005, 2e-4);
    EXPECT_GE(records.records[0].time.size(), 90u);
    EXPECT_NEAR(records.gap_noise, 2e-5, 3e-6);
    // longer ones keep the usual step
    EXPECT_EQ(prepare_heave_records(FastRig::model(), rig.data(5, 300)).step, record_step);
}

TEST(ShortRuns, SayWhatIsMissing) {
    FastRig rig;
    rig.more_damping = 0.1;
    const Discovery found = discover(FastRig::model(), rig.data(0.5, 1500), quick());
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_EQ(found.effects.size(), 1u);
    EXPECT_EQ(found.effects[0].name, "linear_damping");
    EXPECT_NEAR(found.effects[0].parameters[0].value, 0.1, 0.03);
}

TEST(ShortRuns, ArePredictedOverWhatTheyLastAndThisIsSaid) {
    const auto prediction = dynamics::predict(FastRig::model(), FastRig{}.data(0.5, 1500));
    EXPECT_LT(prediction.channels[0].in_noise, 1.5);
    ASSERT_FALSE(prediction.remarks.empty());
    EXPECT_THAT(prediction.remarks.back().message, ::testing::HasSubstr("predicted over 0.12"));
}

/// 20 Hz readings of a slow rig in rows of their own, and the same with rows of a 200 Hz IMU between them, as one CSV
/// file each; 300 s.
struct SlowRig {
    static dynamics::Model model() {
        return dynamics::read_model_text(
            "[vehicle]\nmass = 4\nnet_weight = 0\n[drag.heave]\nlinear = 0.5\nquadratic = "
            "0\n[[effect]]\nname = \"tether_stiffness\"\nstiffness = 8\ngap = 0.1\n",
            "rig.toml", ".");
    }
    double friction = 0;
    /// `imu`: rows of it between two readings. `own_input_rows`: the input stands in rows of its own as well.
    [[nodiscard]] std::string csv(std::uint64_t seed, int imu, bool own_input_rows) const {
        core::Random random(seed);
        double h = 0.1 + random.uniform(-0.03, 0.03), w = 0, u = 0;
        std::string text = "time [s], gap [m], input_force [N], heave_acceleration [m/s^2]\n";
        for (int i = 0; i < 800; ++i) {
            if (i % 60 == 0) {
                u = random.uniform(-0.12, 0.12);
            }
            const std::string gap = core::format_number(h + random.normal(0, 2e-4), 9);
            const std::string time = core::format_number(0.05 * i, 9), force = core::format_number(u, 9);
            text += own_input_rows ? time + ", " + gap + ", ,\n" + core::format_number(0.05 * i + 1e-6, 12) + ", , " +
                                         force + ",\n"
                                   : time + ", " + gap + ", " + force + ",\n";
            constexpr int parts = 20;
            for (int k = 0; k < parts; ++k) {
                const double dt = 0.05 / parts;
                const double a = (u - 8 * (h - 0.1) - 0.5 * w - friction * std::tanh(w / 2e-4)) / 4;
                w += dt * a;
                h += dt * w;
                if (imu > 0 && k % (parts / (imu + 1)) == 0 && k > 0) {
                    text += core::format_number(0.05 * i + k * dt, 9) + ", , , " + core::format_number(a, 6) + "\n";
                }
            }
        }
        return text;
    }
    [[nodiscard]] dynamics::Measurements data(int imu, bool own_input_rows) const {
        const core::TemporaryFolder folder;
        std::string set = "kind = \"time_series\"\n[noise]\ngap = \"0.2 mm\"\n";
        for (std::uint64_t r = 0; r < 6; ++r) {
            const std::string name = "run-" + std::to_string(r) + ".csv";
            core::write_file(folder.path() / name, csv(50 + r, imu, own_input_rows));
            set += "[[run]]\nfile = \"" + name + "\"\n";
        }
        core::write_file(folder.path() / "dataset.toml", set);
        return dynamics::read_measurements(folder.path());
    }
};

TEST(RowsOfOtherSensors, DoNotHideTheReadings) {
    const dynamics::Measurements plain = SlowRig{}.data(0, false);
    const HeaveRecords expected = prepare_heave_records(SlowRig::model(), plain);
    const double error = dynamics::predict(SlowRig::model(), plain).channels[0].rmse;
    EXPECT_NEAR(error, 2e-4, 4e-5) << "the rig is the model";
    for (const bool own_input_rows : {false, true}) {
        const dynamics::Measurements mixed = SlowRig{}.data(9, own_input_rows);
        ASSERT_GT(mixed.runs[0].table.rows(), 7000u);
        const HeaveRecords records = prepare_heave_records(SlowRig::model(), mixed);
        ASSERT_EQ(records.records.size(), expected.records.size());
        EXPECT_NEAR(records.gap_noise, expected.gap_noise, 1e-9);
        EXPECT_NEAR(records.raw_step, expected.raw_step, 1e-9);
        for (std::size_t r = 0; r < records.records.size(); ++r) {
            ASSERT_EQ(records.records[r].time, expected.records[r].time) << "at the time of its own reading";
            ASSERT_EQ(records.records[r].gap, expected.records[r].gap);
            for (std::size_t k = 0; k < records.records[r].time.size(); ++k) {
                ASSERT_NEAR(records.records[r].held_input[k], expected.records[r].held_input[k], 2e-5);
                ASSERT_NEAR(records.records[r].linear_input[k], expected.records[r].linear_input[k], 2e-5);
            }
        }
        EXPECT_NEAR(dynamics::predict(SlowRig::model(), mixed).channels[0].rmse, error, 0.02 * error);
    }
}

TEST(RowsOfOtherSensors, LeaveTheVerdictAsItIs) {
    SlowRig rig;
    rig.friction = 0.006;
    DiscoverOptions options = quick();
    options.candidates = {"coulomb_friction", "linear_damping", "constant_force", "input_delay"};
    const Discovery plain = discover(SlowRig::model(), rig.data(0, false), options);
    const Discovery mixed = discover(SlowRig::model(), rig.data(9, true), options);
    ASSERT_EQ(plain.verdict, "effect") << plain.sentence;
    ASSERT_EQ(mixed.verdict, "effect") << mixed.sentence;
    ASSERT_FALSE(plain.effects.empty());
    ASSERT_FALSE(mixed.effects.empty());
    EXPECT_EQ(plain.effects[0].name, "coulomb_friction");
    EXPECT_EQ(mixed.effects[0].name, "coulomb_friction");
    EXPECT_NEAR(mixed.effects[0].parameters[0].value, plain.effects[0].parameters[0].value, 2e-4);
}

/// Runs of one rig, written by `write(name, sensors)` and named in a dataset.toml with `mapping`.
template <typename Write>
dynamics::Measurements logged_runs(const FastRig& rig, const std::string& ending, const std::string& gap_message,
                                   const std::string& gap_type, const std::string& mapping, const Write& write) {
    const core::TemporaryFolder folder;
    std::string set = "kind = \"time_series\"\n[noise]\ngap = \"20 um\"\n";
    for (std::uint64_t r = 0; r < 10; ++r) {
        FastRig::Run run = rig.run(20 + r, 0.5, 1000);
        for (double& gap : run.gap) {
            gap = static_cast<double>(static_cast<float>(gap));  // a Range holds no more
        }
        const std::string name = "run-" + std::to_string(r) + ending;
        write(folder.path() / name,
              std::vector<test::LoggedSensor>{
                  {gap_message, gap_type, "Dist", run.time, run.gap},
                  {gap_type.empty() ? "PUSH" : "/push", "std_msgs/msg/Float64", "Force", run.time, run.push}});
        set += "[[run]]\nfile = \"" + name + "\"\n";
    }
    core::write_file(folder.path() / "dataset.toml", set + mapping);
    return dynamics::read_measurements(folder.path());
}

void write_csv(const std::filesystem::path& file, const std::vector<test::LoggedSensor>& sensors) {
    std::string csv = "time [s], gap [m], input_force [N]\n";
    for (std::size_t i = 0; i < sensors[0].time.size(); ++i) {
        csv += core::format_number(sensors[0].time[i]) + ", " + core::format_number(sensors[0].value[i]) + ", " +
               core::format_number(sensors[1].value[i]) + "\n";
    }
    core::write_file(file, csv);
}

TEST(VehicleLogs, OfEveryKindGiveTheVerdictOfTheCsv) {
    FastRig rig;
    rig.more_damping = 0.1;
    const Discovery csv = discover(FastRig::model(), logged_runs(rig, ".csv", "RFND", "", "", write_csv), quick());
    ASSERT_EQ(csv.verdict, "effect") << csv.sentence;
    ASSERT_FALSE(csv.effects.empty());
    ASSERT_FALSE(csv.error.empty());
    EXPECT_EQ(csv.effects[0].name, "linear_damping");
    const auto expect_same = [&](const dynamics::Measurements& data, const char* kind) {
        const Discovery log = discover(FastRig::model(), data, quick());
        EXPECT_EQ(log.verdict, csv.verdict) << kind;
        ASSERT_EQ(log.effects.size(), csv.effects.size()) << kind;
        EXPECT_EQ(log.effects[0].name, csv.effects[0].name) << kind;
        EXPECT_NEAR(log.effects[0].parameters[0].value, csv.effects[0].parameters[0].value, 1e-6) << kind;
        EXPECT_NEAR(log.effects[0].probability, csv.effects[0].probability, 1e-6) << kind;
        ASSERT_FALSE(log.error.empty()) << kind;
        EXPECT_NEAR(log.error[0].after.rmse, csv.error[0].after.rmse, 1e-9) << kind;
    };
    using Sensors = std::vector<test::LoggedSensor>;
    const auto bytes_of = [](auto&& make) {
        return [make](const std::filesystem::path& file, const Sensors& sensors) {
            core::write_file(file, make(sensors));
        };
    };
    const std::string plain =
        "[log]\nchannel.gap = { message = \"RFND\", field = \"Dist\" }\nchannel.input_force = { message = \"PUSH\", "
        "field = \"Force\" }\n";
    expect_same(logged_runs(rig, ".ulg", "RFND", "", plain, bytes_of(test::ulog_bytes)), "ULog");
    expect_same(logged_runs(rig, ".bin", "RFND", "", plain, bytes_of(test::dataflash_bytes)), "DataFlash");
    expect_same(logged_runs(rig, ".log", "RFND", "", plain, bytes_of(test::dataflash_text)), "DataFlash text");
    const std::pair<const char*, const char*> ros_types[] = {{"sensor_msgs/msg/Range", "range"},
                                                             {"nav_msgs/msg/Odometry", "pose.pose.position.z"},
                                                             {"geometry_msgs/msg/PoseStamped", "pose.position.z"},
                                                             {"sensor_msgs/msg/Imu", "linear_acceleration.z"}};
    for (const auto& [type, field] : ros_types) {
        const bool imu = std::string(type).ends_with("Imu");  // any number may be the gap, where its unit is said
        const std::string ros = "[log]\nchannel.gap = { message = \"/gap\", field = \"" + std::string(field) + "\"" +
                                (imu ? ", unit = \"m\"" : "") +
                                " }\nchannel.input_force = { message = \"/push\", field = \"data\" }\n";
        expect_same(logged_runs(rig, ".mcap", "/gap", type, ros,
                                bytes_of([](const Sensors& sensors) { return test::mcap_bytes(sensors, "zstd"); })),
                    type);
        expect_same(logged_runs(rig, ".db3", "/gap", type, ros, test::write_sqlite_bag), type);
    }
}

/// The slow rig read at instants of its own.
dynamics::Measurements sampled(double friction, double seconds, const std::function<double(core::Random&)>& step) {
    dynamics::Measurements all;
    all.noise["gap"] = 2e-4;
    for (std::uint64_t r = 0; r < 6; ++r) {
        core::Random random(90 + r);
        double h = 0.1 + random.uniform(-0.03, 0.03), w = 0, u = 0, t = 0, change = 0;
        std::vector<double> time, gap, push;
        while (t < seconds) {
            if (t >= change) {
                u = random.uniform(-0.12, 0.12);
                change = t + 4;
            }
            time.push_back(t);
            gap.push_back(h + random.normal(0, 2e-4));
            push.push_back(u);
            const double until = t + step(random);
            const int parts = static_cast<int>(std::ceil((until - t) / 1e-3));
            for (int k = 0; k < parts; ++k) {
                const double dt = (until - t) / parts;
                w += dt * (u - 8 * (h - 0.1) - 0.5 * w - friction * std::tanh(w / 2e-4)) / 4;
                h += dt * w;
            }
            t = until;
        }
        dynamics::MeasuredRun run;
        run.name = "run-" + std::to_string(r);
        run.table.source = run.name;
        run.table.add_numbers("time", "s", time);
        run.table.add_numbers("gap", "m", gap);
        run.table.add_numbers("input_force", "N", push);
        all.runs.push_back(std::move(run));
    }
    return all;
}

void expect_friction(const dynamics::Measurements& data) {
    DiscoverOptions options = quick();
    options.candidates = {"coulomb_friction", "linear_damping", "constant_force", "added_mass"};
    const Discovery found = discover(SlowRig::model(), data, options);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    ASSERT_FALSE(found.effects.empty());
    EXPECT_EQ(found.effects[0].name, "coulomb_friction");
    EXPECT_NEAR(found.effects[0].parameters[0].value, 0.006, 0.001);
}

TEST(PiecesOfAFile, AreTheFileOnceInWhatAModelIsMadeFrom) {
    const core::TemporaryFolder folder("pieces");
    const FastRig rig;
    std::string text = "time [s], gap [m], input_force [N]\n";
    for (int piece = 0; piece < 4; ++piece) {
        const FastRig::Run run = rig.run(40 + static_cast<std::uint64_t>(piece), 1, 200);
        for (std::size_t i = 0; i < run.time.size(); ++i) {
            text += core::format_number(run.time[i] + 3600 * piece, 9) + ", " + core::format_number(run.gap[i], 9) +
                    ", " + core::format_number(run.push[i]) + "\n";
        }
    }
    core::write_file(folder.path() / "all.csv", text);
    core::write_file(folder.path() / "dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"all.csv\"\n");
    const dynamics::Measurements data = dynamics::read_measurements(folder.path());
    ASSERT_EQ(data.runs.size(), 4U);
    DiscoverOptions options;
    options.figures = options.consequence = false;
    std::size_t told = 0;
    for (const std::string& line : discover(FastRig::model(), data, options).model.lineage.made_from) {
        told += line.rfind("run all.csv, content ", 0) == 0 ? 1 : 0;
    }
    EXPECT_EQ(told, 1U);
}

TEST(UnevenRuns, SayWhatIsMissing) {
    expect_friction(sampled(0.006, 40, [](core::Random& random) {
        return random.uniform() < 0.01 ? random.uniform(0.5, 1.5) : random.uniform(0.01, 0.12);
    }));
}

TEST(LongRuns, AtTwoReadingsASecondSayWhatIsMissing) {
    expect_friction(sampled(0.006, 120, [](core::Random&) { return 0.5; }));
}

using Between = dynamics::RecordReading::Between;

TEST(InputBetweenSamples, DiscoveryPredictionAndEstimatorReadTheLogsAlike) {
    const core::TemporaryFolder folder;
    const dynamics::Model model = test::heave_model(folder.path());
    const auto nothing = [](double, double, double) { return 0.0; };
    const auto damped = [](double, double, double w) { return -0.5 * w; };
    for (const bool continuous : {false, true}) {
        for (const bool known : {true, false}) {
            test::HeaveRig rig;
            rig.seconds = 20;
            rig.continuous = continuous;
            const auto data =
                known ? test::heave_runs(nothing, 6, 12.5, 71, rig) : test::heave_runs(damped, 6, 12.5, 72, rig);
            const std::string who =
                std::string(continuous ? "linear" : "held") + (known ? "" : ", damping that the model lacks");
            const Between truth = continuous ? Between::linear : Between::held;
            const Discovery found = discover(model, data, quick());
            EXPECT_EQ(found.verdict, known ? "none" : "effect") << who << ": " << found.sentence;
            const Between read = found.model.records.input_between;
            const std::string before = dynamics::input_reading(model, data).between;
            if (known) {
                EXPECT_EQ(read, truth) << who;
                EXPECT_EQ(before, continuous ? "linear" : "held") << who;
            } else {  // half a sample hides behind the damping, but never the other way round
                EXPECT_TRUE(read == truth || read == Between::held) << who;
                EXPECT_EQ(before, "held") << who;
            }
            dynamics::Model unsaid = found.model;  // the effect known, the reading to be worked out
            unsaid.records.input_between = Between::unsaid;
            EXPECT_EQ(dynamics::input_reading(unsaid, data).between, read == Between::linear ? "linear" : "held")
                << who;
            const dynamics::Prediction predicted = dynamics::predict(found.model, data);
            EXPECT_EQ(predicted.input_between_from, "declared") << who;
            EXPECT_EQ(predicted.input_between, read == Between::linear ? "linear" : "held") << who;
            EXPECT_LT(predicted.channels[0].in_noise, 1.6) << who;
        }
    }
}

TEST(InputBetweenSamples, WhatTheModelDeclaresIsNotAskedOfTheData) {
    const core::TemporaryFolder folder;
    dynamics::Model model = test::heave_model(folder.path());
    const auto data = test::heave_runs([](double, double, double) { return 0.0; }, 4, 5, 73);
    for (const Between declared : {Between::held, Between::linear}) {
        model.records.input_between = declared;
        EXPECT_EQ(discover(model, data, quick()).model.records.input_between, declared);
        EXPECT_EQ(dynamics::input_reading(model, data).from, "declared");
    }
}

TEST(InputBetweenSamples, OneRule) {
    EXPECT_EQ(dynamics::between_samples(Between::unsaid, 100, 91), Between::held);
    EXPECT_EQ(dynamics::between_samples(Between::unsaid, 100, 89), Between::linear);
    EXPECT_EQ(dynamics::between_samples(Between::held, 100, 0), Between::held);
    EXPECT_EQ(dynamics::between_samples(Between::linear, 0, 100), Between::linear);
}

}  // namespace
}  // namespace underbody::discovery
