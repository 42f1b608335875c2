// The lift of one case at 4 mm, followed from its file to the report and the header that a controller is built with,
// and what was tried to make it wrong on the way. docs/one-number.md says it in words: each attempt here is a row
// there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "cases/study.h"
#include "core/file.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double truth = 0.3;  // N, of the cube at 4 mm

void replace(const fs::path& file, const std::string& old, const std::string& by, bool all = false) {
    std::string text = core::read_file(file);
    std::size_t at = text.find(old);
    ASSERT_NE(at, std::string::npos) << file << ": " << old;
    for (; at != std::string::npos; at = all ? text.find(old, at + by.size()) : std::string::npos) {
        text.replace(at, old.size(), by);
    }
    core::write_file(file, text);
}

/// What a run says of the case, of the study as a whole, and the lift that it has; NaN: none.
struct Said {
    std::string words;
    double lift = std::nan("");
    std::size_t points = 0;  ///< of the table
};

Said run(const fs::path& folder) {
    Said said;
    try {
        const Study study = Study::open(folder);
        RunOptions options;
        options.pictures = false;
        const StudyResults results = run_study(study, options);
        for (const auto& one : results.case_loads) {
            for (const auto& warning : one.warnings) {
                said.words += one.name + ": " + warning.message + "\n";
            }
            said.lift = one.name == "cube-h4" && !one.values.empty() ? one.value("lift_force") : said.lift;
        }
        for (const auto& step : results.steps) {
            said.words += step.error + "\n";
        }
        said.points = results.tables.empty() ? 0 : results.tables.front().points.rows();
    } catch (const core::Error& error) {
        said.words += error.message() + " | " + error.hint() + "\n";
    }
    return said;
}

struct Attempt {
    const char* row;  ///< the first cell of its row in the page
    std::function<void(const fs::path& study, const fs::path& file)> change;
    const char* told;
    double lift = NAN;     ///< that comes of it; NaN: none, or of no matter
    bool refused = false;  ///< there is no lift
};

const std::vector<Attempt>& attempts() {
    static const std::vector<Attempt> all = {
        {"header in mm, numbers in m",
         [](auto&, auto& file) { replace(file, "X [ m ], Y [ m ], Z [ m ]", "X [ mm ], Y [ mm ], Z [ mm ]", true); },
         "the gap is declared as 4 mm, but in the file"},
        {"one column in mm", [](auto&, auto& file) { replace(file, "Z [ m ]", "Z [ mm ]", true); },
         "coordinates have different units"},
        {"pressure in kPa", [](auto&, auto& file) { replace(file, "Pressure [ Pa ]", "Pressure [ kPa ]", true); },
         "times those of every other case"},
        {"pressure over density",
         [](auto&, auto& file) { replace(file, "Pressure [ Pa ]", "Pressure [ m^2 s^-2 ]", true); },
         "does not say the density", NAN, true},
        {"columns Y and Z changed places",
         [](auto&, auto& file) { replace(file, "Y [ m ], Z [ m ]", "Z [ m ], Y [ m ]", true); },
         "(zone 'base') faces sideways", 0},
        {"a value is NaN", [](auto&, auto& file) { replace(file, ", 100, 0", ", nan, 0"); }, "not a finite number", NAN,
         true},
        {"the end is cut off", [](auto&, auto& file) { fs::resize_file(file, fs::file_size(file) - 6); },
         "node numbers where at least 3", NAN, true},
        {"a face runs the other way", [](auto&, auto& file) { replace(file, "1, 2, 6, 5", "5, 6, 2, 1"); },
         "were turned to agree", truth},
        {"a face stands twice", [](auto&, auto& file) { replace(file, "2, 3, 7, 6", "2, 3, 7, 6\n2, 3, 7, 6"); },
         "is not closed"},
        {"the base is left out",
         [](auto&, auto& file) {
             const std::string text = core::read_file(file);
             core::write_file(file, "\n" + text.substr(text.find("[Name]\nhull")));
         },
         "is not closed"},
        {"a half model among whole ones",
         [](auto&, auto& file) { core::write_file(file, test::half_cube_field(4e-3, truth / 1e-3)); }, "a half model?",
         truth / 2},
        {"a copy of another case's file",
         [](auto& study, auto& file) {
             fs::copy_file(study / "fields" / "cube-h3.csv", file, fs::copy_options::overwrite_existing);
         },
         "is one file a copy of the other?", 0.4},
        {"the name says another gap",
         [](auto& study, auto& file) { fs::rename(file, study / "fields" / "cube-h40.csv"); },
         "the gap is declared as 40 mm"},
        {"the pattern in metres", [](auto& study, auto&) { replace(study / "study.toml", "{gap:mm}", "{gap:m}"); },
         "the gap is declared as 4 m"},
        {"up is down",
         [](auto& study, auto&) { replace(study / "study.toml", "[[case]]", "[frame]\nup = \"-z\"\n[[case]]"); },
         "(zone 'base') faces up", -truth},
        {"a solution that has not settled",
         [](auto& study, auto&) {
             std::string monitor = "\"lift\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n";
             for (int i = 1; i <= 60; ++i) {
                 monitor += std::to_string(i) + " " + core::format_number(truth + (i % 2 == 0 ? 0.2 : -0.2)) + "\n";
             }
             core::write_file(study / "fields" / "cube-h4-lift.out", monitor);
         },
         "the solution has not settled", truth},
        {"a condition mistyped",
         [](auto& study, auto&) { replace(study / "study.toml", "conditions.speed", "conditions.sped"); },
         "did you mean 'speed'", NAN, true},
        {"an axis mistyped",
         [](auto& study, auto&) { replace(study / "study.toml", "axes = [\"gap\"]", "axes = [\"gab\"]"); }, "gab",
         truth},
        {"another force at the same set point",
         [](auto& study, auto&) {
             core::write_file(study / "fields" / "cube-h4.0.csv", test::cube_field(4e-3, 1.1 * truth / 1e-3));
         },
         "occurs twice", truth},
    };
    return all;
}

class OneNumber : public testing::TestWithParam<Attempt> {
protected:
    core::TemporaryFolder scratch;
    const fs::path folder = scratch.path() / "study";
    void SetUp() override { test::write_small_study(folder); }
};

TEST_P(OneNumber, IsToldOrRightWhateverIsDone) {
    const Attempt& attempt = GetParam();
    const Said before = run(folder);
    EXPECT_NEAR(before.lift, truth, 1e-9);
    EXPECT_EQ(before.points, 6U);
    attempt.change(folder, folder / "fields" / "cube-h4.csv");
    const Said after = run(folder);
    EXPECT_THAT(after.words, HasSubstr(attempt.told));
    EXPECT_THAT(before.words, testing::Not(HasSubstr(attempt.told))) << "it is said anyway";
    EXPECT_EQ(std::isnan(after.lift) && attempt.refused, attempt.refused) << after.lift;
    if (!std::isnan(attempt.lift)) {
        EXPECT_NEAR(after.lift, attempt.lift, 1e-9);
    }
    EXPECT_THAT(core::read_file(test::source_folder() / "docs" / "one-number.md"),
                HasSubstr("| " + std::string(attempt.row) + " |"));
}

INSTANTIATE_TEST_SUITE_P(, OneNumber, testing::ValuesIn(attempts()), [](const auto& attempt) {
    std::string name = attempt.param.row;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
});

class OneNumberKept : public testing::Test {
protected:
    core::TemporaryFolder scratch;
    const fs::path folder = scratch.path() / "study";
    void SetUp() override { test::write_small_study(folder); }
};

// Bytes, not times: the file has its old size and the time that it had.
TEST_F(OneNumberKept, AByteThatChangesBehindTheClockIsSeen) {
    const fs::path file = folder / "fields" / "cube-h4.csv";
    (void)run(folder);
    const auto time = fs::last_write_time(file);
    replace(file, ", 100, 0", ", 101, 0");
    fs::last_write_time(file, time);
    const double changed = run(folder).lift;
    EXPECT_GT(std::abs(changed - truth), 1e-3);
    replace(file, ", 101, 0", ", 100, 0");
    fs::last_write_time(file, time);
    EXPECT_NEAR(run(folder).lift, truth, 1e-12);
}

// What was written beside the report is written again when somebody edits it; the store goes with the study.
TEST_F(OneNumberKept, AnEditedHeaderIsMadeAgainAndAMovedStudyStaysTrue) {
    (void)run(folder);
    const fs::path header = folder / "report" / "exports" / "lift.h";
    const std::string made = core::read_file(header);
    core::write_file(header, made + "/* mine */");
    (void)run(folder);
    EXPECT_EQ(core::read_file(header), made);
    const fs::path moved = scratch.path() / "moved";
    fs::rename(folder, moved);
    const Study study = Study::open(moved);
    RunOptions options;
    options.pictures = false;
    const StudyResults results = run_study(study, options);
    EXPECT_EQ(results.computed, 0U);
    EXPECT_EQ(core::read_file(moved / "report" / "exports" / "lift.h"), made);
}

}  // namespace
}  // namespace underbody::cases
