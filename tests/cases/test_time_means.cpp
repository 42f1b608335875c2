// Instants of runs in time count as their mean in a study.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/study.h"
#include "core/file.h"
#include "core/text.h"
#include "surrogates/tables/points/settled.h"
#include "tests/support/small_study.h"

namespace underbody::cases {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TimeMeans : public testing::Test {
protected:
    core::TemporaryFolder scratch;
    fs::path folder = scratch.path();

    StudyResults run() {
        RunOptions options;
        options.pictures = false;
        options.write_report = false;
        return run_study(Study::open(folder), options);
    }
    void write(const std::string& variant, int gap, int instant, double lift) {
        core::write_file(
            folder / "wake" /
                (variant + "-h" + std::to_string(gap) + "-" + core::format_number(0.01 * instant) + ".csv"),
            test::cube_field(1e-3 * gap, lift / 1e-3));
    }
    void study(const std::string& more) {
        core::write_file(folder / "study.toml",
                         "title = \"wakes\"\n[[case]]\nfiles = \"wake/{variant}-h{gap:mm}-{time:s}.csv\"\n" + more +
                             "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\n"
                             "fit = \"interpolation\"\n");
    }
};

TEST_F(TimeMeans, AreThePointsOfTablesWithErrorsThatKnowTheirCorrelation) {
    constexpr int count = 64;
    for (int gap = 2; gap <= 4; ++gap) {
        for (int i = 0; i < count; ++i) {
            write("wing", gap, i, 0.1 * gap + 0.05 * std::sin(2 * std::numbers::pi * i / 16));
        }
    }
    study("mean = true\n");
    const StudyResults results = run();
    ASSERT_EQ(results.failed, 0U);
    EXPECT_EQ(results.case_loads.size(), 3U * count);
    ASSERT_EQ(results.loads.rows(), 3U);
    for (std::size_t row = 0; row < 3; ++row) {
        const double gap = results.loads.numbers("gap")[row];
        EXPECT_NEAR(results.loads.numbers("lift_force")[row], 100 * gap, 1e-9) << "whole periods";
        const double sigma = results.loads.numbers("lift_force_sigma")[row];
        // Sixteen to a cycle: fewer than all of them are independent.
        EXPECT_GT(sigma, 0.05 / std::sqrt(2.0 * count));
        EXPECT_LT(sigma, 0.05);
        EXPECT_EQ(results.loads.text("settled")[row], "settled");
    }
    ASSERT_EQ(results.tables.size(), 1U);
    EXPECT_EQ(results.tables[0].points.rows(), 3U);
    EXPECT_GT(results.tables[0].points.numbers("lift_force_sigma")[0], 0);
    EXPECT_EQ(run().computed, 0U);
}

TEST_F(TimeMeans, OfARunThatDriftsHaveNotSettledAndATimeIsNeeded) {
    for (int i = 0; i < 40; ++i) {
        write("wing", 2, i, 0.2 + 0.01 * i);
        write("wing", 3, i, 0.3 + 0.001 * (i % 2));
    }
    study("mean = true\n");
    const StudyResults results = run();
    EXPECT_THAT(tables::not_settled(results.loads), testing::ElementsAre(HasSubstr("wing-h2")));
    // Without it each instant is a case of its own.
    study("");
    EXPECT_EQ(run().loads.rows(), 80U);
    core::write_file(folder / "wake" / "single-h5-1.csv", test::cube_field(0.005, 100));
    study("mean = true\n");
    const StudyResults single = run();
    EXPECT_THAT(single.gathered_warnings(true).front().message, HasSubstr("single instant"));
    core::write_file(folder / "study.toml",
                     "title = \"wakes\"\n[[case]]\nfiles = \"wake/{variant}-h2-*.csv\"\nmean = true\n");
    try {
        (void)Study::open(folder);
        ADD_FAILURE() << "no time is known";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("time of"));
        EXPECT_THAT(error.hint(), HasSubstr("{time:s}"));
    }
}

}  // namespace
}  // namespace underbody::cases
