// Conditions of cases: the user's own words with their units, and the water and speed of each case, from the names of
// files to tables and maps.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "cases/study.h"
#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/tables/fit/force_table.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ConditionsOfCases : public testing::Test {
protected:
    core::TemporaryFolder folder;
    void put(const std::string& name, const std::string& text) { core::write_file(folder.path() / name, text); }
    /// Cubes whose lift is 0.1 N for each millimetre of their overhang.
    void cubes(const std::string& name, const std::vector<std::pair<std::string, double>>& files) {
        for (const auto& [number, lift] : files) {
            put("fields/" + name + number + ".csv", test::cube_field(1e-3, lift / 1e-3));
        }
    }
    StudyResults run(const std::string& study) {
        put("study.toml", study);
        opened_ = Study::open(folder.path());
        RunOptions options;
        options.write_report = false;
        return run_study(*opened_, options);
    }
    static double load_of(const StudyResults& results, const std::string& name, const std::string& load) {
        const auto& names = results.loads.text("case");
        const auto row = std::find(names.begin(), names.end(), name) - names.begin();
        return results.loads.numbers(load).at(static_cast<std::size_t>(row));
    }
    std::optional<Study> opened_;
};

TEST_F(ConditionsOfCases, AUserOwnQuantityKeepsItsUnitIntoTheTable) {
    cubes("c", {{"1", 0.1}, {"2", 0.2}, {"4", 0.4}});
    const StudyResults results =
        run("title = \"t\"\n[[case]]\nfiles = \"fields/c{overhang:mm}.csv\"\n"
            "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"overhang\"]\n"
            "[[table]]\nname = \"near\"\nquantity = \"lift_force\"\naxes = [\"overhang\"]\n"
            "where = { overhang = \"2 mm\" }\n");
    EXPECT_EQ(results.loads.find("overhang")->unit, "m");
    EXPECT_EQ(results.loads.find("overhang")->written_unit, "mm");
    const TableResult* table = find_result(results.tables, "lift");
    ASSERT_NE(table, nullptr);
    EXPECT_EQ(table->points.find("overhang")->unit, "m");
    EXPECT_DOUBLE_EQ(table->points.numbers("overhang").back(), 0.004);
    EXPECT_EQ(opened_->cases[1].conditions.label(), "overhang 2 mm");
    // Selected by the number with its unit, though the word is the user's own.
    Conditions where;
    where.texts = {{"overhang", "0.4 cm"}};
    EXPECT_EQ(opened_->select(where).size(), 1U);
    where.texts = {{"overhang", "4 s"}};
    EXPECT_TRUE(opened_->select(where).empty());
    EXPECT_EQ(table_points(opened_->tables[1], results).rows(), 1U);
}

TEST_F(ConditionsOfCases, OneWordIsOfOneDimension) {
    cubes("c", {{"1", 0.1}});
    cubes("d", {{"2", 0.2}});
    put("study.toml",
        "title = \"t\"\n[[case]]\nfiles = \"fields/c{wait:mm}.csv\"\n[[case]]\nfiles = \"fields/d{wait:s}.csv\"\n");
    try {
        (void)Study::open(folder.path());
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("'wait' is in s in 'fields/d{wait:s}.csv', and in mm elsewhere"));
        EXPECT_EQ(error.place().line, 5);
    }
    put("study.toml", "title = \"t\"\n[[case]]\nfiles = \"fields/c{density:mm}.csv\"\n");
    EXPECT_THROW((void)Study::open(folder.path()), core::InputError);
}

TEST_F(ConditionsOfCases, TheDensityAndSpeedOfACaseAreThoseOfItsCoefficients) {
    cubes("c", {{"1000", 0.1}, {"2000", 0.1}});
    cubes("d", {{"1", 0.1}});
    cubes("e", {{"", 0.1}});
    const StudyResults results =
        run("title = \"t\"\n[reference]\nlength = 0.1\nwidth = 0.1\nheight = 0.1\ndensity = 500\nspeed = 0.5\n"
            "[[case]]\nfiles = \"fields/c{density:kg/m^3}.csv\"\n[[case]]\nfiles = \"fields/d{gap:mm}.csv\"\n"
            "[[case]]\nfiles = \"fields/e.csv\"\nconditions = { density = \"4 g/cm^3\", speed = \"2 m/s\" }\n");
    const double area = M_PI / 4 * 0.1 * 0.1;
    const auto expect = [&](const std::string& name, double density, double speed) {
        EXPECT_NEAR(load_of(results, name, "lift_coefficient"), 0.1 / (0.5 * density * speed * speed * area), 1e-9)
            << name;
    };
    expect("c1000", 1000, 0.5);
    expect("c2000", 2000, 0.5);
    expect("d1", 500, 0.5);  // of [reference], where the case says nothing
    expect("e", 4000, 2);
}

TEST_F(ConditionsOfCases, ATableOfSeveralWatersAndAMapOfAnotherSaySo) {
    cubes("c", {{"1-1000", 0.5}, {"2-1000", 0.4}, {"3-1025", 0.3}, {"4-1025", 0.2}});
    put("glide.toml",
        "[vehicle]\nmass = 2\nadded_mass_heave = 2\nnet_weight = 0.35\n[drag.heave]\nlinear = 0.5\n"
        "[environment]\ndensity = 998\n");
    const std::string head = "title = \"t\"\n[[case]]\nfiles = \"fields/c{gap:mm}-{density:kg/m^3}.csv\"\n";
    const std::string rest =
        "[[region]]\nname = \"map\"\nmodel = \"glide.toml\"\nforces = [\"lift\"]\n"
        "axes = \"gap=1mm:4mm,heave_velocity=-0.02:0.02\"\nfor = \"5 s\"\ncolumns = 10\nrows = 10\n";
    const std::string table = "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\n";
    const StudyResults mixed = run(head + table + rest);
    EXPECT_THAT(find_result(mixed.tables, "lift")->remarks,
                Contains(HasSubstr("no one density (1000 to 1025 kg/m^3), and it is no axis")));
    EXPECT_THAT(
        find_result(mixed.regions, "map")->remarks,
        Contains(HasSubstr("the table 'lift' is of water of 1000 to 1025 kg/m^3, the model's is of 998 kg/m^3")));
    const StudyResults one = run(head + table + "where = { density = \"1025 kg/m^3\" }\n" + rest);
    EXPECT_THAT(find_result(one.tables, "lift")->remarks, Not(Contains(HasSubstr("density"))));
    EXPECT_EQ(find_result(one.tables, "lift")->points.rows(), 2U);
    EXPECT_THAT(find_result(one.regions, "map")->remarks, Contains(HasSubstr("water of 1025 kg/m^3")));
}

TEST(StudyMeasurements, AreSearchedAsByTheCommand) {
    const core::TemporaryFolder folder;
    const auto put = [&](const std::string& name, const std::string& text) {
        core::write_file(folder.path() / name, text);
    };
    put("lift.csv", "gap [mm], lift_force [N]\n1, 0.1\n3, 0.05\n6, 0.02\n9, 0.01\n");
    put("model.toml",
        "[vehicle]\nmass = 2\nnet_weight = 0.03\n[drag.heave]\nlinear = 0.5\n"
        "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
    put("rig/dataset.toml", "kind = \"static\"\ntitle = \"t\"\n[[run]]\nfile = \"a.csv\"\n");
    core::Random random(4);
    std::string rows = "gap [mm], lift_force [N]\n";
    const auto lift = tables::ForceTable::fit(core::read_csv(folder.path() / "lift.csv"), "lift_force");
    for (int i = 0; i < 48; ++i) {
        const double gap = 1e-3 * (1 + i % 8);
        rows += core::format_number(1e3 * gap, 6) + ", " +
                core::format_number(lift.value(&gap) + 0.004 + random.normal(0, 0.0004), 9) + "\n";
    }
    put("rig/a.csv", rows);
    put("study.toml",
        "title = \"t\"\n[[measurement]]\nname = \"rig\"\nmodel = \"model.toml\"\ndata = \"rig\"\n"
        "discover = true\n");
    RunOptions options;
    options.write_report = false;
    const StudyResults results = run_study(Study::open(folder.path()), options);
    const auto found = std::find_if(results.documents.begin(), results.documents.end(),
                                    [](const auto& one) { return one.first == "discovery/rig"; });
    ASSERT_NE(found, results.documents.end());
    const auto document = nlohmann::json::parse(found->second);
    EXPECT_EQ(document["placebo"]["twins"], discovery::usual_placebo_twins);
    EXPECT_EQ(document["verdict"], "effect") << found->second.substr(0, 600);
    EXPECT_TRUE(document["consequence"].contains("map")) << document["consequence"].dump(1);
}

}  // namespace
}  // namespace underbody::cases
