// Tables of roll and yaw moment, from the study to the export.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cases/study.h"
#include "core/file.h"
#include "core/table.h"
#include "surrogates/tables/fit/force_table.h"
#include "tests/support/small_study.h"

namespace underbody::cases {
namespace {

namespace fs = std::filesystem;

/// A cube whose only force, (7 - gap in mm) / 10 N, lies along the file's z axis, through the middle of its base.
StudyResults results_of(const fs::path& folder, const std::string& frame, const std::string& quantity) {
    for (int gap = 1; gap <= 6; ++gap) {
        core::write_file(folder / "fields" / ("cube-h" + std::to_string(gap) + ".csv"),
                         test::cube_field(1e-3 * gap, (7 - gap) / 10.0 / 1e-3));
    }
    core::write_file(
        folder / "study.toml",
        "title = \"moments\"\n[frame]\n" + frame +
            "[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\n[[table]]\nname = \"turn\"\nquantity = \"" +
            quantity + "\"\naxes = [\"gap\"]\nexports = [\"c\", \"csv\"]\n");
    RunOptions options;
    options.pictures = false;
    return run_study(Study::open(folder), options);
}

void expect_moment(const fs::path& folder, const StudyResults& results, const std::string& quantity, double arm) {
    for (const auto& step : results.steps) {
        EXPECT_EQ(step.error, "") << step.kind << " " << step.name;
    }
    const fs::path exported = folder / "report" / "exports" / "turn.csv";
    ASSERT_TRUE(fs::exists(exported));
    const tables::ForceTable table = tables::ForceTable::fit(core::read_csv(exported), quantity, {});
    for (int gap = 1; gap <= 6; ++gap) {
        const double h = 1e-3 * gap;
        EXPECT_NEAR(table.value(&h), arm * (7 - gap) / 10.0, 1e-6) << gap;
    }
    const std::string header = core::read_file(folder / "report" / "exports" / "turn.h");
    EXPECT_NE(header.find(quantity), std::string::npos);
    EXPECT_NE(core::read_file(results.report).find("turn"), std::string::npos);
}

TEST(MomentTables, RollIsPositiveStarboardDownFromStudyToExport) {
    const core::TemporaryFolder folder;
    // Moments about a point 10 mm to port (+y): the lift acts to starboard of it and takes starboard up.
    const auto results = results_of(folder.path(), "moments_about = [\"0 m\", \"10 mm\", \"0 m\"]\n", "roll_moment");
    expect_moment(folder.path(), results, "roll_moment", -0.010);
}

TEST(MomentTables, YawIsPositiveBowToStarboardFromStudyToExport) {
    const core::TemporaryFolder folder;
    // With y up the force is one to starboard (z), aft of a point 20 mm ahead: it takes the stern to starboard.
    const auto results =
        results_of(folder.path(), "up = \"+y\"\nmoments_about = [\"20 mm\", \"0 m\", \"0 m\"]\n", "yaw_moment");
    expect_moment(folder.path(), results, "yaw_moment", -0.020);
}

/// Where another axis has no value the balance fails, and the hint is one that a study can follow.
TEST(MomentTables, AWeightOverTwoAxesSaysWhatAStudyCanDo) {
    const core::TemporaryFolder folder;
    for (int gap = 1; gap <= 4; ++gap) {
        for (const int speed : {400, 800}) {
            core::write_file(
                folder.path() / "fields" / ("cube-h" + std::to_string(gap) + "-s" + std::to_string(speed) + ".csv"),
                test::cube_field(1e-3 * gap, (7 - gap) * speed / 8.0));
        }
    }
    core::write_file(folder.path() / "study.toml",
                     "title = \"weight\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}-s{speed:mm/s}.csv\"\n"
                     "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"gap\", \"speed\"]\n"
                     "net_weight = \"0.3 N\"\n");
    RunOptions options;
    options.pictures = false;
    std::string error;
    for (const auto& step : run_study(Study::open(folder.path()), options).steps) {
        error += step.kind == "table" ? step.error : "";
    }
    EXPECT_THAT(error, testing::HasSubstr("axis 'speed' whose value is not given"));
    EXPECT_THAT(error, testing::HasSubstr("this table without net_weight, and one over gap alone with it"));
}

}  // namespace
}  // namespace underbody::cases
