// Records as rigs give them: short and fast, with rows of other sensors between the readings, out of a vehicle's log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave/heave_record.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "tests/support/log_writers.h"

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

TEST(VehicleLogs, GiveTheVerdictOfTheCsv) {
    FastRig rig;
    rig.more_damping = 0.1;
    const core::TemporaryFolder folder;
    std::string csv_set = "kind = \"time_series\"\n[noise]\ngap = \"20 um\"\n", log_set = csv_set;
    for (std::uint64_t r = 0; r < 10; ++r) {
        const FastRig::Run run = rig.run(20 + r, 0.5, 1000);
        std::string csv = "time [s], gap [m], input_force [N]\n";
        for (std::size_t i = 0; i < run.time.size(); ++i) {
            csv += core::format_number(run.time[i]) + ", " + core::format_number(run.gap[i]) + ", " +
                   core::format_number(run.push[i]) + "\n";
        }
        const std::string name = "run-" + std::to_string(r);
        core::write_file(folder.path() / "csv" / (name + ".csv"), csv);
        core::write_file(folder.path() / "log" / (name + ".bin"),
                         test::dataflash_bytes(
                             {{"RFND", "", "Dist", run.time, run.gap}, {"PUSH", "", "Force", run.time, run.push}}));
        csv_set += "[[run]]\nfile = \"" + name + ".csv\"\n";
        log_set += "[[run]]\nfile = \"" + name + ".bin\"\n";
    }
    log_set +=
        "[log]\nchannel.gap = { message = \"RFND\", field = \"Dist\" }\nchannel.input_force = { message = "
        "\"PUSH\", field = \"Force\" }\n";
    core::write_file(folder.path() / "csv/dataset.toml", csv_set);
    core::write_file(folder.path() / "log/dataset.toml", log_set);
    const Discovery by_csv = discover(FastRig::model(), dynamics::read_measurements(folder.path() / "csv"), quick());
    const Discovery by_log = discover(FastRig::model(), dynamics::read_measurements(folder.path() / "log"), quick());
    ASSERT_EQ(by_csv.verdict, "effect") << by_csv.sentence;
    ASSERT_FALSE(by_csv.effects.empty());
    ASSERT_EQ(by_csv.effects.size(), by_log.effects.size());
    ASSERT_FALSE(by_csv.error.empty());
    ASSERT_FALSE(by_log.error.empty());
    EXPECT_EQ(by_csv.effects[0].name, by_log.effects[0].name);
    EXPECT_NEAR(by_csv.effects[0].parameters[0].value, by_log.effects[0].parameters[0].value, 1e-6);
    EXPECT_NEAR(by_csv.effects[0].probability, by_log.effects[0].probability, 1e-6);
    EXPECT_NEAR(by_csv.error[0].after.rmse, by_log.error[0].after.rmse, 1e-9);
}

}  // namespace
}  // namespace underbody::discovery
