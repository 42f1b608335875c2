// Workbench's table of design points. The files are our own, written as its export is: no original lies here.
#include <gmock/gmock.h>

#include <numbers>

#include "cases/design_points.h"
#include "core/file.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class DesignPointTable : public testing::Test {
protected:
    core::TemporaryFolder folder;
    DesignPoints read(const std::string& text, const std::map<std::string, std::string>& mapping = {}) {
        core::write_file(folder.path() / "points.csv", text);
        return read_design_points(folder.path() / "points.csv", mapping);
    }
    core::InputError refused(const std::string& text, const std::map<std::string, std::string>& mapping = {}) {
        try {
            (void)read(text, mapping);
        } catch (const core::InputError& error) {
            return error;
        }
        ADD_FAILURE() << "accepted: " << text;
        return {"", ""};
    }
};

constexpr const char* exported =
    "# \r\n# 11/22/2026 10:15:32\r\n# The parameters defined in the project are:\r\n"
    "# ,P1 - ride height [mm],P2 - pitch [degree],P3 - inlet velocity [m s^-1],P4 - lift-op [N],P5 - water temperature "
    "[C]\r\n# \r\n"
    "# The following header line defines the name of the columns by reference to the parameters.\r\n"
    "Name,P1,P2,P3,P4,P5\r\nDP 0,5,0,0.5,-0.412,20\r\nDP 1 (Current),10,-2,0.5,,20\r\nDP 12,2.5,1,0.75,\"-1,2\",15\r\n";

TEST_F(DesignPointTable, NamesAndUnitsOfTheCommentsBecomeConditions) {
    const DesignPoints table = read(exported);
    ASSERT_EQ(table.points.size(), 3U);
    EXPECT_EQ(table.points[1].number, 1);
    const DesignPoint* last = table.find(12);
    ASSERT_NE(last, nullptr);
    EXPECT_DOUBLE_EQ(last->conditions.number("gap").value(), 0.0025);
    EXPECT_NEAR(last->conditions.number("pitch").value(), std::numbers::pi / 180, 1e-12);
    EXPECT_DOUBLE_EQ(last->conditions.number("speed").value(), 0.75);
    EXPECT_NEAR(last->conditions.number("temperature").value(), 288.15, 1e-9);
    EXPECT_FALSE(last->conditions.number("lift_force"));
    ASSERT_EQ(table.notes.size(), 1U);
    EXPECT_THAT(table.notes[0].message, HasSubstr("'P4 - lift-op'"));
}

TEST_F(DesignPointTable, OtherFormsOfTheHeaderSayTheSame) {
    const auto same = [&](const std::string& text) {
        const DesignPoints table = read(text);
        ASSERT_EQ(table.points.size(), 2U) << text;
        EXPECT_DOUBLE_EQ(table.points[1].conditions.number("gap").value(), 0.01) << text;
        EXPECT_DOUBLE_EQ(table.points[1].conditions.number("speed").value(), 0.5) << text;
    };
    same("Name,P1 - gap [mm],P2 - speed [m s^-1]\nDP 0,5,0.5\nDP 1,10,0.5\n");
    same("Name,P1 - gap,P2 - speed\nUnits,mm,m s^-1\nDP 0,5,0.5\nDP 1,10,0.5\n");
    same("\xEF\xBB\xBFName;gap [mm];speed [m/s]\nDP 0;5,0;0,5\nDP 1;10,0;0,5\n");
}

TEST_F(DesignPointTable, AWordOfTheUsersOwnKeepsItsUnit) {
    const DesignPoints table =
        read("Name,P1 - overhang [mm],P2 - density [g cm^-3]\nDP 0,5,1.025\nDP 1,10,1.025\n", {{"P1", "overhang"}});
    const Conditions& last = table.points.at(1).conditions;
    EXPECT_DOUBLE_EQ(last.number("overhang").value(), 0.01);
    EXPECT_EQ(last.unit("overhang"), "m");
    EXPECT_EQ(last.shown_unit("overhang"), "mm");
    EXPECT_THAT(last.label(), HasSubstr("overhang 10 mm"));
}

TEST_F(DesignPointTable, AnUnknownParameterThatVariesHasToBeNamed) {
    const std::string text = "Name,P1 - h0 [mm],P2 - mesh_level,P3 - nu [m^2 s^-1]\nDP 0,5,1,1e-6\nDP 1,10,2,1e-6\n";
    const auto error = refused(text);
    EXPECT_THAT(error.message(), HasSubstr("'P1 - h0', 'P2 - mesh_level'"));
    EXPECT_THAT(error.hint(), HasSubstr("parameters"));
    const DesignPoints table = read(text, {{"P1", "gap"}, {"P2", "level"}});
    EXPECT_DOUBLE_EQ(table.points[1].conditions.number("gap").value(), 0.01);
    EXPECT_DOUBLE_EQ(table.points[1].conditions.number("level").value(), 2);
    EXPECT_EQ(read(text, {{"h0", "gap"}, {"P2", ""}}).points[0].conditions.numbers.size(), 1U);
    EXPECT_THAT(refused(text, {{"P7", "gap"}}).message(), HasSubstr("no parameter 'P7'"));
    EXPECT_THAT(refused(text, {{"P1", "gap"}, {"P2", "gap"}}).message(), HasSubstr("both gap"));
}

TEST_F(DesignPointTable, BadTablesAreRefusedWithTheirLine) {
    EXPECT_THAT(refused("# nothing\n").message(), HasSubstr("no table of design points"));
    EXPECT_EQ(refused("Name,P1 - gap [mm]\nDP 0,5\nDP 1,5,6\n").place().line.value_or(0), 3);
    EXPECT_THAT(refused("Name,P1 - gap [mm]\nDP 0,5\nDP 0,6\n").message(), HasSubstr("stands twice"));
    EXPECT_THAT(refused("Name,P1 - gap [mm]\nDP 0,five\n").message(), HasSubstr("'five' is no number"));
    EXPECT_THAT(refused("Name,P1 - gap [mm]\nDP 0,\n").message(), HasSubstr("is missing"));
    EXPECT_THAT(refused("Name,P1 - gap\nDP 0,5\n").message(), HasSubstr("has no unit"));
    EXPECT_DOUBLE_EQ(read("Name,P1 - gap\nDP 0,5\n", {{"P1", "gap [mm]"}}).points[0].conditions.number("gap").value(),
                     0.005);
    EXPECT_EQ(refused("Name,P1 - gap [s]\nDP 0,5\n").place().line.value_or(0), 2);
    EXPECT_THAT(refused("Name,P1 - gap [mm],P1 - pitch [degree]\nDP 0,5,0\n").message(),
                HasSubstr("twice in the header"));
}

}  // namespace
}  // namespace underbody::cases
