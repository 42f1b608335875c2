#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "core/table.h"
#include "core/text.h"

namespace underbody::core {
namespace {

using testing::HasSubstr;

struct BadTable {
    const char* text;
    const char* kind;
    std::int64_t line;
    std::int64_t column;  // 0: none expected
    const char* says;
};

class BadTables : public testing::TestWithParam<BadTable> {};

TEST_P(BadTables, AreRefusedWithFileLineAndColumn) {
    const BadTable& bad = GetParam();
    try {
        read_csv(bad.text, "bad.csv");
        FAIL() << bad.text;
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind(), bad.kind) << error.what();
        EXPECT_EQ(error.place().file, "bad.csv");
        if (bad.line > 0) {
            EXPECT_EQ(error.place().line.value_or(0), bad.line) << error.what();
        }
        if (bad.column > 0) {
            EXPECT_EQ(error.place().column.value_or(0), bad.column) << error.what();
        }
        EXPECT_THAT(error.what(), HasSubstr(bad.says));
    }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadTables,
    testing::Values(BadTable{"", "empty", 0, 0, "no header"},
                    BadTable{"# only a comment\n", "empty", 0, 0, "no header"},
                    BadTable{"gap [m], lift_force [N]\n", "empty", 0, 0, "no rows"},
                    BadTable{"gap, lift_force [N]\n1, 2\n", "unit", 1, 1, "has no unit"},
                    BadTable{"gap [m], lift_force [Nn]\n1, 2\n", "unit", 1, 2, "unknown unit 'Nn'"},
                    BadTable{"gap [s], lift_force [N]\n1, 2\n", "unit", 1, 1, "another dimension"},
                    BadTable{"gap [m], lift_force_sigma [m]\n1, 2\n", "unit", 1, 2, "another dimension"},
                    BadTable{"gap [m], gap [mm]\n1, 2\n", "duplicate", 1, 2, "occurs twice"},
                    BadTable{"gap [mm];lift_force [N]\n1;0,6\n", "parse", 1, 0, "separated by ';'"},
                    BadTable{"gap [mm]\tlift_force [N]\n1\t0.6\n", "parse", 1, 0, "separated by tabulators"},
                    BadTable{"gap [m, lift_force [N]\n1, 2\n", "parse", 1, 1, "name [unit]"},
                    BadTable{"gap [m], lift_force [N]\n1, 2\n1\n", "ragged", 3, 0, "1 fields"},
                    BadTable{"gap [m], lift_force [N]\n1, 2, 3\n", "ragged", 2, 3, "3 fields"},
                    BadTable{"gap [m], lift_force [N]\n1, \"0,25\"\n", "parse", 2, 0,
                             "\"0,25\" is a number with a decimal comma"},
                    BadTable{"gap [m], lift_force [N]\n\n# x\n1, two\n", "parse", 4, 2, "'two'"},
                    BadTable{"gap [m], lift_force [N]\n1, nan\n", "range", 2, 2, "not finite"},
                    BadTable{"gap [m], lift_force [N]\ninf, 2\n", "range", 2, 1, "not finite"},
                    BadTable{"gap [m], lift_force []\n1, 2\n", "unit", 1, 2, "empty unit"}));

TEST(Table, ConvertsToSiAndKeepsUnknownColumns) {
    const Table table = read_csv(
        "\xEF\xBB\xBF# made by hand\r\ngap [mm], pitch [deg], lift_force [mN], lift_force_sigma [mN], note, colour "
        "index [1]\r\n"
        "5, 2, -412, 4, first, 3\r\n, 0, 1, 1, , 4\r\n",
        "text");
    EXPECT_EQ(table.rows(), 2U);
    EXPECT_DOUBLE_EQ(table.numbers("gap")[0], 0.005);
    EXPECT_TRUE(std::isnan(table.numbers("gap")[1]));
    EXPECT_DOUBLE_EQ(table.numbers("lift_force")[0], -0.412);
    EXPECT_DOUBLE_EQ(table.numbers("lift_force_sigma")[0], 0.004);
    EXPECT_EQ(table.text("note")[0], "first");
    EXPECT_DOUBLE_EQ(table.numbers("colour index")[1], 4);
    EXPECT_EQ(table.line_of_row(1), 4);
    EXPECT_EQ(table.comments.at(0), "made by hand");
}

TEST(Table, TakesUnitsOfKnownQuantitiesInParentheses) {
    const Table table =
        read_csv("time (s), gap (mm), lift_force_sigma ( mN ), area (m2), gap (note)\n1,5,20,3,4\n", "p.csv");
    EXPECT_DOUBLE_EQ(table.numbers("gap")[0], 5e-3);
    EXPECT_EQ(table.find("gap")->unit, "m");
    EXPECT_DOUBLE_EQ(table.numbers("lift_force_sigma")[0], 0.02);
    EXPECT_DOUBLE_EQ(table.numbers("time")[0], 1);
    // what is no known quantity, or no unit, is a name as it stands
    EXPECT_EQ(table.text("area (m2)")[0], "3");
    EXPECT_EQ(table.text("gap (note)")[0], "4");
    EXPECT_THROW(read_csv("gap (N)\n1\n", "p.csv"), InputError);
}

TEST(Table, ASigmaOfATemperatureIsADifference) {
    const Table table = read_csv("temperature [degC], temperature_sigma [degC]\n20, 0.5\n", "text");
    EXPECT_NEAR(table.numbers("temperature")[0], 293.15, 1e-9);
    EXPECT_DOUBLE_EQ(table.numbers("temperature_sigma")[0], 0.5);
    EXPECT_THAT(write_csv(table), HasSubstr(", 0.5\n"));
}

TEST(Table, NamesTheNearestColumn) {
    const Table table = read_csv("gap [mm], lift_force [N]\n1, 2\n", "t.csv");
    try {
        (void)table.numbers("lift_forc");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.hint(), HasSubstr("'lift_force'"));
    }
}

TEST(Table, RandomTablesComeBackAsTheyWere) {
    Random random(11);
    for (int round = 0; round < 50; ++round) {
        Table table;
        const std::size_t rows = 1 + random.below(40);
        std::vector<double> gaps(rows);
        std::vector<double> lifts(rows);
        std::vector<std::string> notes(rows);
        for (std::size_t i = 0; i < rows; ++i) {
            gaps[i] = random.uniform(0, 0.1);
            lifts[i] = random.uniform() < 0.1 ? std::nan("") : random.normal();
            notes[i] = "note" + std::to_string(i);
        }
        table.add_numbers("gap", "m", gaps, "mm");
        table.add_numbers("lift_force", "N", lifts);
        table.add_text("note", notes);
        const Table again = read_csv(write_csv(table), "again");
        ASSERT_EQ(again.rows(), rows);
        for (std::size_t i = 0; i < rows; ++i) {
            ASSERT_NEAR(again.numbers("gap")[i], gaps[i], 1e-15);
            ASSERT_TRUE(again.numbers("lift_force")[i] == lifts[i] || std::isnan(lifts[i]));
            ASSERT_EQ(again.text("note")[i], notes[i]);
        }
    }
}

/// 3 degrees are 3.0000000000000004 degrees by way of radians and back; the file says 3, and reads back to the same.
TEST(Table, NumbersInOtherUnitsAreWrittenAsTheyWereTyped) {
    for (const char* unit : {"deg", "mm", "km/h", "bar"}) {
        for (int tenths = -200; tenths <= 200; ++tenths) {
            const std::string typed = format_number(tenths / 10.0), name = "x [" + std::string(unit) + "]\n";
            const Table table = read_csv(name + typed + "\n", "typed");
            const std::string written = write_csv(table);
            EXPECT_EQ(written, name + typed + "\n");
            EXPECT_EQ(read_csv(written, "written").numbers("x")[0], table.numbers("x")[0]);
        }
    }
    Table table;
    table.add_numbers("pitch", "rad", {3 * std::numbers::pi / 180, 0.1}, "deg");
    EXPECT_TRUE(write_csv(table).starts_with("pitch [deg]\n3\n5.7295779513082")) << write_csv(table);
    const Table again = read_csv(write_csv(table), "again");
    for (std::size_t i = 0; i < 2; ++i) {  // computed, not typed: not each number of radians is reached from degrees
        EXPECT_DOUBLE_EQ(again.numbers("pitch")[i], table.numbers("pitch")[i]);
    }
}

TEST(Table, RandomBytesNeverCrashTheReader) {
    Random random(5);
    const std::string alphabet = "gap [mm],lift_force N\n\r#.0123456789eE+-\t\"\xEF\xBB\xBF";
    for (int round = 0; round < 3000; ++round) {
        std::string text;
        for (std::size_t i = random.below(120); i > 0; --i) {
            text += alphabet[random.below(alphabet.size())];
        }
        try {
            (void)read_csv(text, "random");
        } catch (const InputError&) {
        }
    }
}

}  // namespace
}  // namespace underbody::core
