// `study compare` and `table compare`: which underbody is better, in what, over which range.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Two cubes: the lift of `low` falls by 0.1 N a mm, that of `high` by 0.2 N, both at gaps 1 to 6 mm.
std::filesystem::path two_cubes(const std::filesystem::path& folder, const std::string& quantity) {
    std::string text =
        "title = \"two\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\nconditions.speed = \"0.5 m/s\"\n";
    std::string points = "variant, gap [mm], lift_force [N]\n";
    for (const auto& [name, scale] : {std::pair{"low", 1.0}, {"high", 2.0}}) {
        for (int gap = 1; gap <= 6; ++gap) {
            const double lift = scale * (7 - gap) / 10.0;
            core::write_file(folder / "fields" / (std::string(name) + "-h" + std::to_string(gap) + ".csv"),
                             cube_field(1e-3 * gap, lift / 1e-3));
            points += std::string(name) + "," + std::to_string(gap) + "," + core::format_number(lift) + "\n";
        }
        text += "[[table]]\nname = \"" + std::string(name) + "\"\nquantity = \"" + quantity +
                "\"\naxes = [\"gap\"]\nwhere = { variant = \"" + name + "\" }\n";
    }
    core::write_file(folder / "points.csv", points);
    core::write_file(folder / "study.toml", text + "[[compare]]\nname = \"both\"\ntables = [\"low\", \"high\"]\n");
    return folder;
}

TEST(StudyCompare, NamesTheQuantityItComparesAndTheRange) {
    const core::TemporaryFolder scratch;
    for (const auto& [quantity, noun] : {std::pair{"drag_force", "drag"}, {"pitch_moment", "pitch moment"}}) {
        const auto study = two_cubes(scratch.path() / quantity, quantity);
        const auto run = run_underbody({"study", "compare", study.string()});
        ASSERT_EQ(run.exit_code, 0) << run.errors;
        EXPECT_THAT(run.output, Not(HasSubstr("lift")));
        EXPECT_THAT(run.output, HasSubstr(std::string("largest value of the ") + noun));
        EXPECT_THAT(run.output, Not(HasSubstr("restoring"))) << "neither restores anything along the gap";
        EXPECT_THAT(run.output, HasSubstr("Compared over the gap that all of them have, 1 mm to 6 mm."));
    }
}

TEST(StudyCompare, AgreesWithTableCompareOnTheSamePoints) {
    const core::TemporaryFolder scratch;
    const auto study = two_cubes(scratch.path(), "lift_force");
    const auto by_study = run_underbody({"study", "compare", study.string(), "--json"});
    ASSERT_EQ(by_study.exit_code, 0) << by_study.errors;
    const auto by_table = run_underbody({"table", "compare", "points.csv", "--json"}, study);
    ASSERT_EQ(by_table.exit_code, 0) << by_table.errors;
    const json row = json::parse(by_study.output).at("both").at("rows").at(0), table = json::parse(by_table.output);
    EXPECT_EQ(row.at("measure"), table.at("measure"));
    EXPECT_EQ(row.at("table"), table.at("winner"));
    EXPECT_EQ(row.at("table"), "high");
    EXPECT_NEAR(row.at("value").get<double>(), 200, 1e-6);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(row.at("values")[i].at("value").get<double>(), table.at("variants")[i].at("value").get<double>(),
                    1e-6);
    }
    EXPECT_EQ(json::parse(by_study.output).at("both").at("range"), table.at("range"));
    const auto text = run_underbody({"study", "compare", study.string()});
    EXPECT_THAT(text.output, HasSubstr("'high' less 'low': at most 0.6"));
}

TEST(TableCompare, PraisesNoSlopeWhereNoneRestores) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "up.csv",
                     "variant, gap [mm], lift_force [N]\na,1,.1\na,2,.2\na,4,.4\nb,1,.1\nb,2,.3\nb,4,.7\n");
    const auto run = run_underbody({"table", "compare", "up.csv"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(run.output, HasSubstr("a: restores nowhere\nb: restores nowhere\nnone of them restores; compared over "
                                      "the gap that all have, 1 mm to 4 mm"));
    EXPECT_THAT(run.output, Not(HasSubstr("wins")));
    const auto as_json = run_underbody({"table", "compare", "up.csv", "--json"}, folder.path());
    EXPECT_TRUE(json::parse(as_json.output).at("winner").is_null());
}

}  // namespace
}  // namespace underbody::test
