// A number that differs from run to run, though the rig is one: no effect shows it that is the same in all.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "tests/support/support.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

using Change = std::function<void(std::size_t run, std::vector<double>& gap, std::vector<double>& input)>;

dynamics::Measurements changed(dynamics::Measurements data, const Change& change) {
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const core::Table& before = data.runs[r].table;
        std::vector<double> gap = before.numbers("gap"), input = before.numbers("input_force");
        change(r, gap, input);
        core::Table after;
        after.source = before.source;
        after.add_numbers("time", "s", before.numbers("time"));
        after.add_numbers("gap", "m", gap);
        after.add_numbers("input_force", "N", input);
        data.runs[r].table = std::move(after);
    }
    return data;
}

Discovery found_in(const dynamics::Measurements& data) {
    const core::TemporaryFolder folder("by-run");
    DiscoverOptions options;
    options.figures = options.consequence = false;
    return discover(test::heave_model(folder.path()), data, options);
}

double nothing(double, double, double) { return 0; }

}  // namespace

TEST(ByRun, AZeroOfTheSensorThatIsSetAnewForEachRunIsSaidWithItsRuns) {
    const std::vector<double> zero{2e-3, -2e-3, 1.5e-3, -1.5e-3, 2.5e-3, -2.5e-3, 1e-3, -1e-3};
    const dynamics::Measurements data = changed(test::heave_runs(nothing, 8, 50, 41),
                                                [&](std::size_t r, std::vector<double>& gap, std::vector<double>&) {
                                                    for (double& value : gap) {
                                                        value += zero[r];
                                                    }
                                                });
    const Discovery found = found_in(data);
    EXPECT_NE(found.verdict, "none") << found.sentence;
    EXPECT_TRUE(found.model.effects.empty()) << found.sentence;
    ASSERT_TRUE(found.by_run) << found.sentence;
    EXPECT_NE(found.sentence.find("differs from run to run"), std::string::npos) << found.sentence;
    EXPECT_EQ(found.by_run->runs.size(), found.by_run->value.size());
    EXPECT_EQ(to_json(found)["differs_by_run"]["name"], found.by_run->name);
    if (found.by_run->name == "gap_sensor_bias") {
        for (std::size_t i = 0; i < found.by_run->runs.size(); ++i) {
            const auto run = static_cast<std::size_t>(std::stoi(found.by_run->runs[i].substr(4))) - 1;
            EXPECT_NEAR(found.by_run->value[i], zero[run], 5 * found.by_run->sigma[i]) << found.by_run->runs[i];
        }
    }
}

TEST(ByRun, AClockThatIsLateInSomeRunsIsNeverSilentNorOneNumberForAll) {
    const dynamics::Measurements data = changed(test::heave_runs(nothing, 8, 50, 43),
                                                [&](std::size_t r, std::vector<double>&, std::vector<double>& input) {
                                                    const std::size_t by = r % 2 == 0 ? 0 : 10;
                                                    for (std::size_t i = input.size(); i-- > 0;) {
                                                        input[i] = input[i >= by ? i - by : 0];
                                                    }
                                                });
    const Discovery found = found_in(data);
    EXPECT_NE(found.verdict, "none") << found.sentence;
    bool said = found.by_run.has_value();
    for (const core::Problem& problem : found.problems) {
        said = said || problem.message.find("contradict each other") != std::string::npos;
    }
    EXPECT_TRUE(said) << found.sentence;
}

TEST(ByRun, RunsOfOneRigAreAlike) {
    for (const std::uint64_t seed : {51U, 52U, 53U, 54U}) {
        const Discovery found = found_in(test::heave_runs(nothing, 8, 50, seed));
        EXPECT_EQ(found.verdict, "none") << found.sentence;
        EXPECT_FALSE(found.by_run) << found.sentence;
    }
}

TEST(ByRun, ADriftingSensorOfTheHardExamplesIsNotSilent) {
    UNDERBODY_NEEDS_SHARED("examples/loop-hard");
    const std::filesystem::path folder = test::shared_folder() / "examples/loop-hard/sensor-drift";
    DiscoverOptions options;
    options.figures = options.consequence = false;
    const Discovery found =
        discover(dynamics::read_model(folder / "model.toml"), dynamics::read_measurements(folder), options);
    // "nothing is missing" before, beside a warning that run-02 has -1.1 mm and most runs 0.98 mm
    EXPECT_NE(found.verdict, "none") << found.sentence;
    EXPECT_EQ(found.depends_on, std::vector<std::string>{"time"}) << found.sentence;
}
