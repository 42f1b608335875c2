#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/file.h"
#include "core/mistyped.h"
#include "core/random.h"
#include "core/table.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "tests/support/support.h"

namespace underbody::core {
namespace {

using testing::HasSubstr;

TEST(Units, ADecimalCommaIsNamed) {
    for (const auto& [text, right] : {std::pair("0,3", "0.3"), std::pair("-0,28 N", "-0.28 N")}) {
        try {
            (void)parse_in(text, "N");
            ADD_FAILURE() << text << " was taken";
        } catch (const InputError& error) {
            EXPECT_EQ(error.message(), "'" + std::string(text) + "' is a number with a decimal comma");
            EXPECT_EQ(error.hint(), "write it with '.' as decimal point: " + std::string(right));
        }
    }
}

TEST(Units, SayWhatAUnitOfAnotherDimensionWasProbablyMeantFor) {
    const auto said = [](const char* text, const char* unit) {
        try {
            (void)parse_in(text, unit);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(said("2 degr", "rad").find("did you mean 'deg'?"), std::string::npos) << said("2 degr", "rad");
    EXPECT_NE(said("-70 mm", "1").find("a plain number is wanted"), std::string::npos) << said("-70 mm", "1");
    EXPECT_EQ(mistyped_quantity("sped"), "speed");
    EXPECT_EQ(mistyped_quantity("speed"), "");
    EXPECT_EQ(mistyped_quantity("rpm"), "");
}

TEST(Units, AWeightInKilogramsIsToldWhatItWeighs) {
    const auto hint = [](const char* text, const char* unit, const Place& place) {
        try {
            (void)parse_in(text, unit, place);
        } catch (const InputError& error) {
            EXPECT_NE(error.message().find("another dimension than '" + std::string(unit) + "'"), std::string::npos);
            return error.hint();
        }
        return std::string();
    };
    for (const Place& place : {Place{}, Place{"study.toml", 3, {}, {}}}) {
        EXPECT_EQ(hint("0.3kg", "N", place),
                  "a weight is a force: 0.3 kg weigh 2.942 N in air, and less by what the water carries");
        EXPECT_EQ(hint("300 g", "N", place).substr(0, 40), "a weight is a force: 300 g weigh 2.942 N");
        EXPECT_EQ(hint("0.3 N", "kg", place).find("weight"), std::string::npos);
    }
}

TEST(Mistyped, StandardDeviationsAreKnownByTheirEnding) {
    const auto column = [](const std::string& name, const std::string& unit) {
        Column one;
        one.name = name;
        one.unit = one.written_unit = unit;
        one.numbers = {1, 2};
        return one;
    };
    EXPECT_EQ(meant_name(column("lift_force_sgima", "N")), "lift_force_sigma");
    EXPECT_EQ(meant_name(column("lift_force_std", "N")), "lift_force_sigma");
    EXPECT_EQ(meant_name(column("lift_froce_sigma", "N")), "lift_force_sigma");
    EXPECT_EQ(meant_name(column("drag_froce", "N")), "drag_force");
    EXPECT_EQ(meant_name(column("lift_force_sigma", "N")), "");
    EXPECT_EQ(meant_name(column("lift_force_sgima", "m")), "");  // of another dimension
    EXPECT_EQ(meant_name(column("lift_force_gradient", "N")), "");
    EXPECT_EQ(meant_name(column("lift_pressure", "N")), "");
    EXPECT_EQ(heading_for(column("lift_force_sgima", "N"), "lift_force_sigma"), "'lift_force_sigma [N]'");
    EXPECT_EQ(no_quantity("sped"), "there is no quantity 'sped'");
    EXPECT_EQ(quantity_hint("sped"), "did you mean 'speed'?");
}

TEST(Units, ConvertsWhatPeopleWrite) {
    EXPECT_DOUBLE_EQ(convert(5, "mm", "m"), 0.005);
    EXPECT_DOUBLE_EQ(convert(36, "km/h", "m/s"), 10);
    EXPECT_NEAR(convert(20, "degC", "K"), 293.15, 1e-12);
    EXPECT_NEAR(convert(180, "deg", "rad"), std::numbers::pi, 1e-15);
    EXPECT_DOUBLE_EQ(convert(1, "atm", "Pa"), 101325);
    EXPECT_NEAR(convert(50, "gf", "N"), 0.4903325, 1e-12);  // physics-oracles O47
    EXPECT_DOUBLE_EQ(convert(1, "kg m^-1 s^-1", "Pa s"), 1);
    EXPECT_DOUBLE_EQ(convert(3, "N s^2/m^2", "kg/m"), 3);
    EXPECT_NEAR(convert(1, "inch", "mm"), 25.4, 1e-12);
}

TEST(Units, RefusesUnknownUnitsWithTheNearestOne) {
    try {
        convert(1, "mmm", "m");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind(), "unit");
        EXPECT_THAT(error.hint(), HasSubstr("'mm'"));
    }
}

TEST(Units, RefusesAnotherDimensionAndReciprocals) {
    EXPECT_THROW(convert(1, "mm", "s"), InputError);
    EXPECT_THROW(convert(1, "s", "Hz"), InputError);
    EXPECT_FALSE(same_dimension("kg", "N"));
    EXPECT_TRUE(same_dimension("bar", "Pa"));
}

TEST(Units, NamesTheCoherentSiUnit) {
    EXPECT_EQ(si_unit("mm"), "m");
    EXPECT_EQ(si_unit("bar"), "Pa");
    EXPECT_EQ(si_unit("mL/s"), "m^3/s");
    EXPECT_EQ(si_unit("degC"), "K");
    EXPECT_EQ(si_unit("1"), "1");
    EXPECT_EQ(si_unit("deg"), "rad");
    EXPECT_EQ(si_unit("deg/s"), "rad/s");
    EXPECT_EQ(si_unit("kHz"), "Hz");
    EXPECT_TRUE(same_dimension(si_unit("mol/m^3"), "mol/m^3"));
}

TEST(Units, EverySiUnitConvertsWithFactorOne) {
    for (const char* unit : {"mm", "kPa", "deg", "gf", "km/h", "mN m", "g/cm^3", "cSt", "L/min", "mol/L", "degF"}) {
        const std::string si = si_unit(unit);
        EXPECT_NEAR(convert(1, si, si_unit(si)), 1, 1e-15) << unit << " -> " << si;
    }
}

TEST(Units, ReadsQuantitiesWithAndWithoutUnits) {
    EXPECT_DOUBLE_EQ(parse_in("5 mm", "m"), 0.005);
    EXPECT_DOUBLE_EQ(parse_in("5mm", "m"), 0.005);
    EXPECT_DOUBLE_EQ(parse_in("0.005", "m"), 0.005);
    EXPECT_DOUBLE_EQ(parse_in("1.0e-6 m^2/s", "m^2/s"), 1e-6);
    EXPECT_DOUBLE_EQ(parse_in("-2.5e+1 N", "N"), -25);
    EXPECT_THROW(parse_in("five mm", "m"), InputError);
    EXPECT_THROW(parse_in("", "m"), InputError);
    EXPECT_THROW(parse_in("5 mm 3", "m"), InputError);
    EXPECT_THROW(parse_in("1e999", "m"), InputError);
}

TEST(Units, ReadsListsOfTheCommandLine) {
    const auto values = parse_assignments("gap=5mm, speed=0.5 m/s");
    ASSERT_EQ(values.size(), 2U);
    EXPECT_EQ(values[0].name, "gap");
    EXPECT_DOUBLE_EQ(values[0].value, 0.005);
    EXPECT_DOUBLE_EQ(values[1].value, 0.5);
    const auto ranges = parse_ranges("gap=0:1,heave_velocity=-0.1:0.1");
    EXPECT_DOUBLE_EQ(ranges[1].lower, -0.1);
    EXPECT_THROW(parse_ranges("gap=1:0"), UsageError);
    EXPECT_THROW(parse_ranges("gap=1"), UsageError);
    EXPECT_THROW(parse_ranges("gap=0:1,gap=0:2"), UsageError);
    EXPECT_THROW(parse_assignments("gap=5mm, gap=6mm"), UsageError);
    try {
        parse_assignments("gapp=5mm");
        FAIL();
    } catch (const UsageError& error) {
        EXPECT_THAT(error.hint(), HasSubstr("'gap'"));
    }
}

TEST(Units, EveryQuantityNameHasAKnownSiUnit) {
    for (const auto& quantity : quantity_names()) {
        EXPECT_TRUE(is_unit(quantity.unit)) << quantity.name;
        EXPECT_NEAR(convert(1, quantity.unit, si_unit(quantity.unit)), 1, 1e-15) << quantity.name;
    }
}

TEST(Text, NumbersReadBackToTheSameBits) {
    Random random(7);
    for (int i = 0; i < 20000; ++i) {
        const double value = random.normal() * std::pow(10.0, random.uniform(-300, 300));
        const auto read = parse_number(format_number(value));
        ASSERT_TRUE(read.has_value());
        ASSERT_EQ(*read, value);
    }
}

TEST(Text, RefusesWhatIsNotWhollyANumber) {
    for (const char* text : {"", " ", "1,5", "1.5x", "+-1", "0x10", "1e", "--1", "1 2"}) {
        EXPECT_FALSE(parse_number(text).has_value()) << "'" << text << "'";
    }
    EXPECT_EQ(parse_number(" +1.5e-3 ").value(), 0.0015);
    EXPECT_EQ(parse_number("-5.13577717E-003").value(), -5.13577717e-3);  // as CFX writes it
}

TEST(Text, Base64MatchesRfc4648) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Locale, NumbersAreReadAndWrittenAlikeUnderAGermanLocale) {
    const TemporaryFolder folder;
    const test::ProgramRun made =
        test::run_program("localedef", {"-i", "de_DE", "-f", "UTF-8", (folder.path() / "de_DE.UTF-8").string()});
    if (made.exit_code == 127) {
        GTEST_SKIP() << "skipped: localedef is not installed";
    }
    ::setenv("LOCPATH", folder.path().c_str(), 1);
    ASSERT_NE(std::setlocale(LC_ALL, "de_DE.UTF-8"), nullptr) << made.errors;
    char decimal[16];
    std::snprintf(decimal, sizeof decimal, "%.1f", 1.5);
    ASSERT_STREQ(decimal, "1,5") << "the locale is not in force, so this test would prove nothing";

    EXPECT_EQ(parse_number("1.5").value(), 1.5);
    EXPECT_FALSE(parse_number("1,5").has_value());
    EXPECT_EQ(format_number(1.5), "1.5");
    EXPECT_EQ(format_number(1.2345, 3), "1.23");
    EXPECT_DOUBLE_EQ(parse_in("2.5 mm", "m"), 0.0025);
    EXPECT_NEAR(convert(1, "ft", "m"), 0.3048, 1e-15) << "the database of units is read under this locale";
    const Table table = read_csv("gap [mm], lift_force [N]\n1.5, 0.25\n", "text");
    EXPECT_DOUBLE_EQ(table.numbers("gap")[0], 0.0015);
    EXPECT_EQ(write_csv(table), "gap [mm], lift_force [N]\n1.5, 0.25\n");
    std::setlocale(LC_ALL, "C");
}

TEST(Quantities, StandOnThePageOfConventions) {
    const std::string page = read_file(test::source_folder() / "docs" / "conventions.md");
    for (const auto& quantity : quantity_names()) {
        EXPECT_NE(page.find('`' + quantity.name + '`'), std::string::npos) << quantity.name;
    }
}

TEST(Told, LengthsInMillimetresAnglesInDegreesAllElseAsItIs) {
    EXPECT_EQ(told(0.005, "m"), "5 mm");
    EXPECT_EQ(told(-std::numbers::pi / 90, "rad"), "-2 deg");
    EXPECT_EQ(told(0.4, "m/s"), "0.4 m/s");
    EXPECT_EQ(told(3, "1"), "3");
    EXPECT_EQ(told_range(0.001, 0.1, "m"), "1 to 100 mm");
    EXPECT_EQ(told_range(1, 2, ""), "1 to 2");
    EXPECT_EQ(told_condition("gap", 0.0123456, 4), "gap 12.35 mm");
    EXPECT_EQ(told_condition("depth", 3), "depth 3 m");
    EXPECT_EQ(told_condition("wheels", 3), "wheels 3");
    EXPECT_EQ(told_unit_of("depth", "m"), "m");
    EXPECT_EQ(told_unit_of("roll", "rad"), "deg");
    EXPECT_EQ(told(180 / std::numbers::pi, "N m/rad"), "1 N m/deg");
    EXPECT_EQ(told(0.00525, 0.0001, "m", 4), "5.25 +- 0.1 mm");
    EXPECT_EQ(told(2, 0.5, "1", 4), "2 +- 0.5");
}

}  // namespace
}  // namespace underbody::core
