// What a model's numbers rest on that nobody says: the reference of a scale, the water of a table, warnings in its
// head, how logs are read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/own_files.h"
#include "surrogates/dynamics/model/force_tables.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/tables/exports/export.h"

namespace {

using namespace underbody;
using namespace underbody::dynamics;
using testing::Contains;
using testing::HasSubstr;

class UnsaidConditions : public testing::Test {
protected:
    UnsaidConditions() {
        core::write_file(path("lift.csv"),
                         "gap [mm], lift_force [N], density [kg/m^3]\n2, 0.5, 1025\n5, 0.3, 1025\n10, 0.2, 1025\n");
        core::write_file(
            path("more.csv"),
            "gap [mm], speed [m/s], lift_force [N]\n2, 0.1, 0\n2, 0.5, -0.05\n2, 0.9, -0.1\n10, 0.1, 0\n10, "
            "0.5, -0.04\n10, 0.9, -0.08\n");
    }
    [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
    [[nodiscard]] Model model(const std::string& more = "") const {
        const core::ReplacingAllowed again;
        core::write_file(path("model.toml"),
                         "[vehicle]\nmass = \"2 kg\"\nadded_mass_heave = \"1 kg\"\nnet_weight = \"0.25 N\"\n"
                         "[environment]\ndensity = \"998 kg/m^3\"\n"
                         "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\naxes = [\"gap\"]\n"
                         "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n" +
                             more);
        return read_model(path("model.toml"));
    }
    core::TemporaryFolder folder_;
};

const std::string correction = "[[effect]]\nname = \"unknown\"\nquantity = \"lift_force\"\ntable = \"more.csv\"\n";

/// Where nobody says the speed, a table is at the reference of its scale, and so is a correction that depends on it.
TEST_F(UnsaidConditions, ACorrectionIsAtTheReferenceOfTheScales) {
    const Model corrected = model(correction);
    Conditions said;
    said[Channel::speed] = 0.5;
    const HeavePlant unsaid(corrected, {}), at_reference(corrected, said);
    const HeavePlant without(model(), said);
    for (const double gap : {2e-3, 4e-3, 7e-3, 10e-3}) {
        EXPECT_DOUBLE_EQ(unsaid.static_force(gap), at_reference.static_force(gap)) << gap;
        EXPECT_LT(unsaid.static_force(gap), without.static_force(gap) - 0.03) << gap;  // it is there
        Conditions point;
        point[Channel::gap] = gap;
        EXPECT_NEAR(static_value(corrected, "lift_force", point), unsaid.static_force(gap) + 0.25, 1e-12) << gap;
    }
    said[Channel::speed] = 0.9;
    EXPECT_NE(HeavePlant(corrected, said).static_force(4e-3), unsaid.static_force(4e-3));
}

/// Two scales that do not agree say no one reference.
TEST_F(UnsaidConditions, SeveralReferencesAreNone) {
    EXPECT_EQ(references_of(model())[Channel::speed], 0.5);
    const Model two = model(
        "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\naxes = [\"gap\"]\n"
        "scale.speed = { reference = \"0.6 m/s\", exponent = 2 }\n");
    EXPECT_FALSE(references_of(two).has(Channel::speed));
    // What leaves the program is the force that moves: each table at its own reference.
    const ForceTables exported = force_tables(two);
    const HeavePlant moves(two, {});
    for (const double gap : {2e-3, 4e-3, 9e-3}) {
        EXPECT_NEAR(exported.tables.at(0).value(&gap), moves.static_force(gap) + 0.25, 1e-9) << gap;
    }
    EXPECT_TRUE(std::any_of(exported.remarks.begin(), exported.remarks.end(), [](const core::Problem& remark) {
        return remark.message.find("speed is not held") != std::string::npos;
    }));
}

TEST_F(UnsaidConditions, ATableOfAnotherWaterSaysSoWhereverItIsRead) {
    std::vector<std::string> said;
    for (const auto& remark : model().remarks) {
        said.push_back(remark.message);
    }
    EXPECT_THAT(said, Contains(HasSubstr("lift_force table is of water of 1025 kg/m^3, the model's is of 998 kg/m^3")));
}

/// A warning in the head of a table goes with it, through an export and back.
TEST_F(UnsaidConditions, AWarningInTheHeadOfATableStaysWithIt) {
    const core::ReplacingAllowed again;
    core::write_file(
        path("lift.csv"),
        "# warning: its mesh study is diverging\n# made in a hurry\ngap [mm], lift_force [N], lift_force_sigma "
        "[N]\n2, 0.5, 0.01\n5, 0.3, 0.01\n10, 0.2, 0.01\n");
    const auto warnings = [](const tables::ForceTable& table) {
        std::vector<std::string> said;
        for (const auto& remark : table.remarks()) {
            if (remark.severity == core::Problem::Severity::warning) {
                said.push_back(remark.message);
            }
        }
        return said;
    };
    const auto table = tables::ForceTable::read(path("lift.csv"), "lift_force");
    EXPECT_THAT(warnings(table), testing::ElementsAre("its mesh study is diverging"));
    (void)tables::export_table(table, "csv", path("out.csv"), {});
    EXPECT_THAT(warnings(tables::ForceTable::read(path("out.csv"), "lift_force")),
                Contains("its mesh study is diverging"));
    (void)tables::export_table(table, "c", path("out.h"), {});
    EXPECT_THAT(core::read_file(path("out.h")), HasSubstr("its mesh study is diverging"));
}

/// An exported table may stand in a model in either form.
TEST_F(UnsaidConditions, AnExportedTableStandsInAModelAsCsvAndAsJson) {
    const core::ReplacingAllowed again;
    const auto table = tables::ForceTable::read(path("lift.csv"), "lift_force");
    Conditions said;
    said[Channel::speed] = 0.5;
    const double before = HeavePlant(model(), said).static_force(4e-3);
    for (const char* file : {"out.csv", "out.json"}) {
        (void)tables::export_table(table, std::string(file).substr(4), path(file), {});
        core::write_file(path("other.toml"),
                         "[vehicle]\nmass = \"2 kg\"\nadded_mass_heave = \"1 kg\"\nnet_weight = \"0.25 N\"\n[[force]]\n"
                         "quantity = \"lift_force\"\ntable = \"" +
                             std::string(file) + "\"\n");
        EXPECT_NEAR(HeavePlant(read_model(path("other.toml")), said).static_force(4e-3), before, 1e-9) << file;
    }
}

TEST(ReadingOnTheRig, IsSaidWhereLogsAreNotReadAsTheyStand) {
    RecordReading records;
    EXPECT_EQ(reading_on_the_rig(records), "");
    records.input_between = RecordReading::Between::linear;
    EXPECT_EQ(reading_on_the_rig(records), "");
    records.input_factor = -1;
    EXPECT_THAT(reading_on_the_rig(records), HasSubstr("input_force times -1"));
}

}  // namespace
