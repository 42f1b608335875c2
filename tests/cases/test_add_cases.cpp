// Cases that are added to a study: patterns guessed from names, units that the files do not say.
#include <gmock/gmock.h>

#include <algorithm>

#include "cases/add_cases.h"
#include "cases/case_loads.h"
#include "cases/guess_pattern.h"
#include "core/file.h"
#include "core/text.h"
#include "postproc/field/import_error.h"
#include "postproc/field/unstated_units.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(GuessedPattern, NamesAsPeopleWriteThem) {
    const auto pattern = [](std::vector<std::string> names) { return guess_pattern(std::move(names)).pattern; };
    EXPECT_EQ(pattern({"run7_h5mm_p0.csv", "run7_h10mm_p-2.csv"}), "run7_h{gap:mm}mm_p{pitch:deg}.csv");
    EXPECT_EQ(pattern({"fields/ellipse-h5-p0.csv", "fields/flat-h2.5-p0.csv"}),
              "fields/{variant}-h{gap:mm}-p{pitch:deg}.csv");
    EXPECT_EQ(pattern({"coarse/gap=5mm.cgns", "fine/gap=7mm.cgns"}), "{mesh}/gap={gap:mm}mm.cgns");
    EXPECT_EQ(pattern({"hull_U0.5ms_h3.dat.h5", "hull_U0.75ms_h3.dat.h5", "hull_U0.5ms_h3.cas.h5"}),
              "hull_U{speed:m/s}ms_h{gap:mm}.dat.h5");
    EXPECT_EQ(pattern({"a 1 left.csv", "b 1 right.csv"}), "{variant} 1 {variant2}.csv");
    EXPECT_EQ(pattern({"one.csv"}), "one.csv");
    EXPECT_EQ(pattern({}), "");
}

TEST(GuessedPattern, WhatIsBuiltOtherwiseIsLeftOut) {
    const auto guessed = guess_pattern({"b-h5.csv", "b-h7.csv", "readme of h.csv", "b-h5-old.csv"});
    EXPECT_EQ(guessed.pattern, "b-h{gap:mm}.csv");
    EXPECT_THAT(guessed.fitting, ElementsAre("b-h5.csv", "b-h7.csv"));
    EXPECT_THAT(guessed.others, ElementsAre("readme of h.csv", "b-h5-old.csv"));
}

/// A CFD-Post export of the shipped study whose header has lost its units; lengths in mm.
class WithoutUnits : public testing::Test {
protected:
    WithoutUnits() {
        const std::string text =
            core::read_file(test::source_folder() / "cases" / "evie" / "fields" / "ellipse-h5-p0.csv");
        original_ = test::source_folder() / "cases" / "evie" / "fields" / "ellipse-h5-p0.csv";
        core::write_file(file_, without(text));
    }
    static std::string without(std::string text) {
        for (const char* unit : {" [ m ]", " [ Pa ]", " [m]", " [Pa]"}) {
            for (auto at = text.find(unit); at != std::string::npos; at = text.find(unit)) {
                text.erase(at, std::string(unit).size());
            }
        }
        return text;
    }
    core::TemporaryFolder folder_;
    fs::path original_, file_ = folder_.path() / "ellipse-h5-p0.csv";
};

TEST_F(WithoutUnits, WhatIsMissingIsNamed) {
    const auto missing = postproc::unstated_units(file_);
    ASSERT_GE(missing.size(), 2U);
    EXPECT_EQ(missing.front(), (postproc::UnstatedUnit{"", "m", true}));
    const auto pressure =
        std::find_if(missing.begin(), missing.end(), [](const auto& one) { return one.variable == "Pressure"; });
    ASSERT_NE(pressure, missing.end());
    EXPECT_EQ(pressure->unit, "Pa");
    EXPECT_TRUE(postproc::unstated_units(original_).empty());
    try {
        (void)postproc::read_field(file_);
        ADD_FAILURE() << "read without units";
    } catch (const postproc::UnitMissing& error) {
        EXPECT_EQ(error.kind(), "unit");
        EXPECT_EQ(error.unit(), "m");
    }
}

// The loads of the file with its units said are those of the file that says them itself.
TEST_F(WithoutUnits, AStudySaysThemForItsCases) {
    NewCases cases;
    cases.files = "ellipse-h{gap:mm}-p{pitch:deg}.csv";
    cases.symmetry = "y";
    cases.length_unit = "m";
    for (const auto& unit : postproc::unstated_units(file_)) {
        if (!unit.variable.empty()) {
            cases.units.emplace_back(unit.variable, unit.unit);
        }
    }
    const auto added = with_new_cases(folder_.path(), cases);
    EXPECT_EQ(added.count, 1U);
    EXPECT_FALSE(fs::exists(added.file)) << "nothing is written yet";
    write_added(added);
    const Study study = Study::open(folder_.path());
    ASSERT_EQ(study.cases.size(), 1U);
    const Case& one = study.cases.front();
    const auto of = [&](const postproc::Field& field) {
        return postproc::loads(field, loads_options(study, one)).named.lift_force;
    };
    const double lift = of(postproc::read_field(one.file, read_options(one)));
    EXPECT_DOUBLE_EQ(lift, of(postproc::read_field(original_)));
    EXPECT_NE(lift, 0);
    RunOptions options;
    options.pictures = false;
    options.write_report = false;
    const auto results = run_study(study, options);
    EXPECT_EQ(results.failed, 0U);
    ASSERT_EQ(results.case_loads.size(), 1U);
    EXPECT_DOUBLE_EQ(results.case_loads.front().value("lift_force"), lift);
    // Another unit is another result: nothing of the store is taken for it.
    std::string text = core::read_file(folder_.path() / "study.toml");
    text.replace(text.find("length_unit = \"m\""), 17, "length_unit = \"mm\"");
    core::write_file(folder_.path() / "study.toml", text);
    const auto small = run_study(Study::open(folder_.path()), options);
    EXPECT_NEAR(small.case_loads.front().value("lift_force"), 1e-6 * lift, 1e-9 * std::abs(lift));
}

// Cases of one study that differ in their units alone are not taken for each other.
TEST_F(WithoutUnits, EachGroupOfCasesHasItsOwn) {
    core::write_file(folder_.path() / "small-h5-p0.csv", core::read_file(file_));
    for (const char* name : {"ellipse", "small"}) {
        NewCases cases;
        cases.files = std::string(name) + "-h{gap:mm}-p{pitch:deg}.csv";
        cases.symmetry = "y";
        cases.length_unit = name == std::string("small") ? "mm" : "m";
        for (const auto& unit : postproc::unstated_units(file_)) {
            if (!unit.variable.empty()) {
                cases.units.emplace_back(unit.variable, unit.unit);
            }
        }
        write_added(with_new_cases(folder_.path(), cases));
    }
    RunOptions options;
    options.pictures = false;
    options.write_report = false;
    for (int again = 0; again < 2; ++again) {
        const auto results = run_study(Study::open(folder_.path()), options);
        ASSERT_EQ(results.case_loads.size(), 2U);
        EXPECT_EQ(results.failed, 0U);
        const double lift = results.case_loads[0].value("lift_force");
        EXPECT_NEAR(results.case_loads[1].value("lift_force"), 1e-6 * lift, 1e-9 * std::abs(lift));
    }
}

TEST_F(WithoutUnits, AWrongUnitIsRefusedWithItsPlace) {
    for (const char* line :
         {"length_unit = \"Pa\"", "length_unit = \"nonsense\"", "units = { Pressure = \"nonsense\" }"}) {
        try {
            (void)Study::from_text(
                std::string("title = \"t\"\n[[case]]\nfiles = \"ellipse-h{gap:mm}-p{pitch:deg}.csv\"\n") + line + "\n",
                folder_.path() / "study.toml");
            ADD_FAILURE() << "accepted: " << line;
        } catch (const core::InputError& error) {
            EXPECT_EQ(error.kind(), "unit");
            EXPECT_EQ(error.place().line, 4) << error.what();
        }
    }
    NewCases cases;
    cases.files = "*.csv";
    cases.length_unit = "nonsense";
    EXPECT_THROW((void)with_new_cases(folder_.path(), cases), core::Error);
}

}  // namespace
}  // namespace underbody::cases
