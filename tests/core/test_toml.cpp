#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/toml.h"

namespace underbody::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Toml, ReadsQuantitiesWithUnitsAndBareNumbersAsSi) {
    const auto root = read_toml_text("[vehicle]\nmass = \"2200 g\"\nlength = 0.2\ncount = 3\n", "m.toml");
    const auto vehicle = root.table("vehicle");
    EXPECT_DOUBLE_EQ(vehicle.quantity("mass", "kg"), 2.2);
    EXPECT_DOUBLE_EQ(vehicle.quantity("length", "m"), 0.2);
    EXPECT_DOUBLE_EQ(vehicle.quantity("count", "1"), 3);
    EXPECT_DOUBLE_EQ(vehicle.quantity_or("width", "m", 0.1), 0.1);
    EXPECT_NO_THROW(root.finish());
}

TEST(Toml, AnUnknownKeyIsAnErrorThatNamesTheNearestKnownOne) {
    const auto root = read_toml_text("[vehicle]\nmass = 2.2\nnet_wieght = 0.03\n", "m.toml");
    const auto vehicle = root.table("vehicle");
    (void)vehicle.quantity("mass", "kg");
    (void)vehicle.quantity_or("net_weight", "N", 0);
    try {
        root.finish();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind(), "key");
        EXPECT_EQ(error.place().line.value_or(0), 3);
        EXPECT_THAT(error.message(), HasSubstr("vehicle.net_wieght"));
        EXPECT_THAT(error.hint(), HasSubstr("'net_weight'"));
    }
}

TEST(Toml, AWholeTableThatNobodyAskedForIsUnknownToo) {
    const auto root = read_toml_text("[vehicle]\nmass = 2.2\n[enviroment]\ndensity = 998\n", "m.toml");
    (void)root.table("vehicle").quantity("mass", "kg");
    (void)root.table_or_empty("environment").quantity_or("density", "kg/m^3", 1000);
    try {
        root.finish();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.hint(), HasSubstr("'environment'"));
    }
}

TEST(Toml, ErrorsNameTheLineAndTheKey) {
    const auto root = read_toml_text("a = 1\n\nmass = \"2 m\"\nname = 5\nlist = [1, \"2 mm\"]\n", "m.toml");
    try {
        (void)root.quantity("mass", "kg");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.place().line.value_or(0), 3);
        EXPECT_THAT(error.message(), HasSubstr("mass"));
    }
    EXPECT_THROW((void)root.string("name"), InputError);
    EXPECT_THROW((void)root.quantity("missing", "kg"), InputError);
    EXPECT_THAT(root.quantities("list", "m"), ElementsAre(1, 0.002));
    EXPECT_THROW((void)root.tables("a"), InputError);
    EXPECT_THROW((void)read_toml_text("a = \n", "m.toml"), InputError);
    EXPECT_THROW((void)read_toml_text("a = 1\na = 2\n", "m.toml"), InputError);
    EXPECT_THROW((void)read_toml("/no/such/file.toml"), InputError);
}

TEST(Toml, ListsOfTablesKnowTheirKeys) {
    const auto root = read_toml_text(
        "[[force]]\nquantity = \"lift_force\"\n[[force]]\nquantity = \"drag_force\"\ntabel = \"x\"\n", "m.toml");
    for (const auto& force : root.tables("force")) {
        (void)force.choice("quantity", {"lift_force", "drag_force"});
        (void)force.string_or("table", "");
    }
    try {
        root.finish();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("force[1].tabel"));
        EXPECT_THAT(error.hint(), HasSubstr("'table'"));
    }
}

TEST(Toml, StringsSurviveQuoting) {
    const std::string odd = "a \"b\" \\ c\n\t";
    EXPECT_EQ(read_toml_text("x = " + toml_string(odd) + "\n", "m").string("x"), odd);
}

}  // namespace
}  // namespace underbody::core
