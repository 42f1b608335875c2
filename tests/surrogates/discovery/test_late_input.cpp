// A recorded input that comes late beside an effect that explains more than its lateness does.
#include <gtest/gtest.h>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"

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
