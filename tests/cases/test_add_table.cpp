// A [[table]] for a study: what is made of its cases, and what is said where that cannot be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/add_table.h"
#include "core/error.h"
#include "core/file.h"

namespace underbody::cases {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class AddedTables : public testing::Test {
protected:
    AddedTables() {
        for (const char* name : {"ellipse-h3-p0", "ellipse-h5-p0", "ellipse-h10-p0", "ellipse-h5-p1", "box-h3-p0"}) {
            core::write_file(folder() / "fields" / (std::string(name) + ".csv"), "x");
        }
        core::write_file(folder() / "study.toml",
                         "# mine\ntitle = \"t\"\n\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}-p{pitch:deg}.csv\"\n"
                         "conditions = { speed = \"0.5 m/s\" }\n");
    }
    [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }
    /// What is said of a table that cannot be made; nothing is written then.
    std::string refusal(const NewTable& table) {
        const std::string before = core::read_file(folder() / "study.toml");
        try {
            static_cast<void>(with_new_table(folder(), table));
        } catch (const core::Error& error) {
            EXPECT_EQ(core::read_file(folder() / "study.toml"), before);
            return error.message() + " | " + error.hint();
        }
        return "none";
    }

private:
    core::TemporaryFolder folder_;
};

TEST_F(AddedTables, AreMadeOfWhatVaries) {
    NewTable table = proposed_table(Study::open(folder()));
    EXPECT_EQ(text_of(table.where), "pitch=0 deg,variant=ellipse") << "the fullest curve over the gap";
    EXPECT_THAT(table.axes, ElementsAre("gap"));
    table.axes = {};
    table.where = conditions_from("variant=ellipse");
    const AddedTable both = with_new_table(folder(), table);
    EXPECT_EQ(both.planned.cases, 4u);
    EXPECT_THAT(both.study.tables.back().axes, ElementsAre("gap", "pitch"));
    EXPECT_EQ(both.study.tables.back().name, "lift");
    table.where = conditions_from("variant=ellipse,pitch=0deg");
    table.net_weight = "0.3 N";
    table.exports = {"c", "csv"};
    write_added(with_new_table(folder(), table));
    const Study study = Study::open(folder());
    ASSERT_EQ(study.tables.size(), 1u);
    EXPECT_THAT(study.tables[0].axes, ElementsAre("gap"));
    EXPECT_DOUBLE_EQ(study.tables[0].net_weight.value(), 0.3);
    EXPECT_EQ(study.tables[0].where.text("variant"), "ellipse");
    EXPECT_DOUBLE_EQ(study.tables[0].where.number("pitch").value(), 0);
    EXPECT_THAT(core::read_file(folder() / "study.toml"), HasSubstr("# mine\n"));
    EXPECT_EQ(with_new_table(folder(), table).study.tables.back().name, "lift over gap");
}

TEST_F(AddedTables, SayWhyTheyCannotBeMade) {
    EXPECT_THAT(refusal({}), HasSubstr("the cases of the table differ in variant (box, ellipse) | hold one"));
    EXPECT_THAT(refusal({.where = conditions_from("variant=elipse")}),
                HasSubstr("no case of the study has variant=elipse"));
    EXPECT_THAT(refusal({.axes = {"gap"}, .where = conditions_from("variant=ellipse")}),
                HasSubstr("differ in pitch (0 deg, 1 deg)"));
    EXPECT_THAT(refusal({.axes = {"gap", "speed"}, .where = conditions_from("variant=ellipse,pitch=0deg")}),
                HasSubstr("all 3 cases of the table have speed 0.5 m/s, so it is no axis"));
    EXPECT_THAT(refusal({.axes = {"gpa"}, .where = conditions_from("variant=ellipse")}),
                HasSubstr("did you mean 'gap'?"));
    EXPECT_THAT(refusal({.where = conditions_from("variant=box")}), HasSubstr("nothing varies among the 1 case"));
    EXPECT_THAT(refusal({.quantity = "lift_forc", .where = conditions_from("variant=ellipse")}),
                HasSubstr("did you mean 'lift_force'?"));
    EXPECT_THAT(refusal({.where = conditions_from("variant=ellipse"), .net_weight = "3mm"}),
                HasSubstr("another dimension than 'N'"));
    EXPECT_THAT(
        refusal(
            {.quantity = "pitch_moment", .where = conditions_from("variant=ellipse,pitch=0deg"), .net_weight = "0.3N"}),
        HasSubstr("a net weight is balanced by the lift, and this is a table of pitch_moment"));
    EXPECT_THAT(refusal({.where = conditions_from("variant=ellipse"), .exports = {"cvs"}}),
                HasSubstr("did you mean 'csv'?"));
}

}  // namespace
}  // namespace underbody::cases
