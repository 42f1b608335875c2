// A recorded input that comes late beside an effect that explains more than its lateness does.
#include <gtest/gtest.h>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/dynamics/simulate/predict.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

/// `steps` samples late in each run.
dynamics::Measurements late(dynamics::Measurements data, const std::vector<std::size_t>& steps) {
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const std::size_t by = steps[r % steps.size()];
        core::Table table;
        table.source = data.runs[r].table.source;
        for (const core::Column& column : data.runs[r].table.columns()) {
            std::vector<double> values = column.numbers;
            if (column.name == "input_force") {
                for (std::size_t i = values.size(); i-- > 0;) {
                    values[i] = column.numbers[i >= by ? i - by : 0];
                }
            }
            table.add_numbers(column.name, column.unit, values);
        }
        data.runs[r].table = std::move(table);
    }
    return data;
}

Discovery found_in(const dynamics::Measurements& data) {
    const core::TemporaryFolder folder("late-input");
    DiscoverOptions options;
    options.figures = options.consequence = false;
    return discover(test::heave_model(folder.path()), data, options);
}

double tether(double, double h, double) { return -0.15 * (h - 0.1); }
double push(double, double, double) { return 0.01; }
double damping(double, double, double w) { return -0.3 * w; }

}  // namespace

TEST(LateInput, HiddenByAnEffectIsAligned) {
    struct Hidden {
        const char* name;
        double (*force)(double, double, double);
        double noise;
    };
    for (const Hidden& one : {Hidden{"tether_stiffness", tether, 2e-4}, Hidden{"tether_stiffness", tether, 1e-3},
                              Hidden{"constant_force", push, 2e-4}, Hidden{"linear_damping", damping, 2e-4}}) {
        const Discovery found = found_in(late(test::heave_runs(one.force, 6, 50, 31, {.noise = one.noise}), {8}));
        EXPECT_NEAR(found.model.records.input_advance, 0.16, 0.03) << one.name << one.noise << ": " << found.sentence;
        ASSERT_EQ(found.verdict, "effect") << one.name << one.noise << ": " << found.sentence;
        EXPECT_EQ(found.effects.at(0).name, one.name) << one.noise << ": " << found.sentence;
        EXPECT_EQ(found.effects.size(), 1U) << one.noise << ": " << found.sentence;
    }
}

namespace {

std::string warnings_of(const core::Problems& problems) {
    std::string all;
    for (const core::Problem& problem : problems) {
        all += problem.message + "\n";
    }
    return all;
}

dynamics::Measurements times(dynamics::Measurements data, const std::string& name, double factor) {
    for (dynamics::MeasuredRun& run : data.runs) {
        core::Table table;
        table.source = run.table.source;
        for (const core::Column& column : run.table.columns()) {
            std::vector<double> values = column.numbers;
            for (double& value : values) {
                value *= column.name == name ? factor : 1;
            }
            table.add_numbers(column.name, column.unit, values);
        }
        run.table = std::move(table);
    }
    return data;
}

}  // namespace

// It gave an error of 60 noises and not a word, where discover knew.
TEST(LateInput, PredictSaysWhatDiscoverSaysOfALog) {
    const core::TemporaryFolder folder("late-input");
    const dynamics::Model model = test::heave_model(folder.path());
    const dynamics::Measurements as_it_is =
        test::heave_runs([](double, double, double) { return 0.0; }, 6, 50, 31, {.noise = 2e-4});
    struct Slip {
        dynamics::Measurements data;
        std::string words;
    };
    for (const Slip& slip :
         {Slip{times(as_it_is, "input_force", -1),
               "the motion fits an input_force -1 times the recorded one: its sign is "
               "turned round (up is positive)"},
          Slip{times(as_it_is, "input_force", 1e3),
               "the motion fits an input_force 0.001 times the recorded one: its unit "
               "is wrong by a thousand"},
          Slip{late(as_it_is, {8}), "s after the motion that it makes: the clocks of input_force and gap differ"}}) {
        const dynamics::Prediction predicted = dynamics::predict(model, slip.data);
        EXPECT_NE(warnings_of(predicted.remarks).find(slip.words), std::string::npos) << warnings_of(predicted.remarks);
        DiscoverOptions options;
        options.figures = options.consequence = false;
        const Discovery found = discover(model, slip.data, options);
        EXPECT_NE(warnings_of(found.problems).find(slip.words), std::string::npos) << warnings_of(found.problems);
        // with what discover has written there is nothing to say any more
        EXPECT_EQ(warnings_of(dynamics::predict(found.model, slip.data).remarks).find(slip.words), std::string::npos);
    }
    EXPECT_EQ(warnings_of(dynamics::predict(model, as_it_is).remarks), "");
}

TEST(LateInput, PredictDoubtsNoLogForWhatTheModelLacks) {
    const core::TemporaryFolder folder("late-input");
    const dynamics::Model model = test::heave_model(folder.path());
    for (double (*const force)(double, double, double) : {tether, push, damping}) {
        const core::Problems said =
            dynamics::predict(model, test::heave_runs(force, 4, 40, 34, {.noise = 2e-4})).remarks;
        EXPECT_EQ(warnings_of(said).find("recorded"), std::string::npos) << warnings_of(said);
    }
}

TEST(LateInput, PredictSaysOfChannelsWhatDiscoverSays) {
    const core::TemporaryFolder folder("late-input");
    const dynamics::Model model = test::heave_model(folder.path());
    const dynamics::Measurements as_it_is =
        test::heave_runs([](double, double, double) { return 0.0; }, 3, 40, 35, {.noise = 2e-4});
    const auto said = [&](const dynamics::Measurements& data) {
        return warnings_of(dynamics::predict(model, data).remarks);
    };
    EXPECT_NE(said(times(as_it_is, "gap", 1e3)).find("a thousandth would fit: is the column's unit mm"),
              std::string::npos)
        << said(times(as_it_is, "gap", 1e3));
    dynamics::Measurements still = as_it_is;
    const std::vector<double> held(still.runs[0].table.rows(), 0.1);
    core::Table table;
    table.source = still.runs[0].table.source;
    for (const core::Column& column : still.runs[0].table.columns()) {
        table.add_numbers(column.name, column.unit, column.name == "gap" ? held : column.numbers);
    }
    still.runs[0].table = table;
    EXPECT_NE(said(still).find("stands still for a fifth of the run: a stuck sensor?"), std::string::npos);
}
