// A jet as an axis of [sweep] and [design]: by its flow, or by the voltage of its pump.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/design.h"
#include "cases/jet_axis.h"
#include "cases/study.h"
#include "cases/sweep.h"
#include "cases/sweep_parts.h"
#include "core/error.h"
#include "core/file.h"

namespace {

using namespace underbody;
using namespace underbody::cases;
using testing::HasSubstr;

constexpr const char* shape_toml =
    "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n";

class JetOfAStudy : public testing::Test {
protected:
    JetOfAStudy() { core::write_file(folder_.path() / "evie.toml", std::string(shape_toml) + "[nozzle]\n"); }

    [[nodiscard]] Study sweep(const std::string& jet) const {
        core::write_file(folder_.path() / "study.toml",
                         "title = \"jet\"\n[frame]\nsymmetry = \"y\"\n[[body]]\nname = \"evie\"\nshape = "
                         "\"evie.toml\"\n[sweep]\ngap = \"2 mm\"\nspeed = \"0.1 m/s\"\n" +
                             jet);
        return Study::open(folder_.path());
    }

    [[nodiscard]] Design design(const std::string& jet) const {
        core::write_file(folder_.path() / "study.toml",
                         "title = \"jet\"\n[frame]\nsymmetry = \"y\"\n[design]\nshape = \"evie.toml\"\n" + jet +
                             "\n[[design.vary]]\nkey = \"body.base_cut\"\nfrom = 0.7\nto = 0.8\n"
                             "[[design.objective]]\nquantity = \"lift_force\"\nsense = \"maximise\"\nat = { "
                             "jet_voltage = \"6 V\" }\n");
        return Design::open(Study::open(folder_.path()));
    }

    [[nodiscard]] std::string refused(const std::string& jet) const {
        try {
            (void)sweep(jet);
        } catch (const core::InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("study.toml"));
            return error.what();
        }
        return "taken";
    }

    core::TemporaryFolder folder_;
};

TEST_F(JetOfAStudy, AVoltageGivesTheFlowThatItsLawSays) {
    const Study study = sweep(
        "jet_voltage = [\"12 V\", \"1 V\", \"3 V\"]\njet_flow_per_volt = \"2.5 mL/s/V\"\n"
        "jet_dead_band = \"1.5 V\"\n");
    const auto cases = sweep_cases(study);
    ASSERT_EQ(cases.size(), 3u);
    EXPECT_EQ(cases[0].name, "evie-h2-p0-u0.1-v1");
    EXPECT_EQ(cases[2].name, "evie-h2-p0-u0.1-v12");
    EXPECT_EQ(cases[2].conditions.number("jet_voltage"), 12.0);
    EXPECT_EQ(flow_of(study, cases[0].conditions).jet_flow, 0);  // below the dead band
    const double low = flow_of(study, cases[1].conditions).jet_flow,
                 high = flow_of(study, cases[2].conditions).jet_flow;
    EXPECT_NEAR(low, 1.5 * 2.5e-6, 1e-15);
    EXPECT_NEAR(high, 10.5 * 2.5e-6, 1e-15);
}

TEST_F(JetOfAStudy, AFlowIsTakenAsItIs) {
    const Study study = sweep("jet_flow = [\"0 mL/s\", \"50 mL/s\"]\n");
    const auto cases = sweep_cases(study);
    ASSERT_EQ(cases.size(), 2u);
    EXPECT_EQ(cases[1].name, "evie-h2-p0-u0.1-q50");
    EXPECT_NEAR(flow_of(study, cases[1].conditions).jet_flow, 50e-6, 1e-15);
    EXPECT_FALSE(cases[1].conditions.number("jet_voltage").has_value());
}

TEST_F(JetOfAStudy, ASearchComputesItsDesignsAtEachVoltage) {
    const std::string law = "jet_flow_per_volt = \"2.2 mL/s/V\"\n";
    const Design open = design("jet_voltage = [\"0 V\", \"12 V\"]\n" + law);
    const auto variables = open.spec().all_variables();
    ASSERT_EQ(variables.size(), 2u);
    EXPECT_EQ(variables[1].name, "jet_voltage");
    EXPECT_EQ(variables[1].unit, "V");
    EXPECT_EQ(variables[1].upper, 12);
    EXPECT_FALSE(variables[1].of_shape);
    // What is taken beyond what is computed is refused, and so is a body without an opening.
    EXPECT_THROW((void)design("jet_voltage = [\"8 V\", \"12 V\"]\n" + law), core::InputError);
    core::write_file(folder_.path() / "evie.toml", shape_toml);
    EXPECT_THROW((void)design("jet_voltage = [\"0 V\", \"12 V\"]\n" + law), core::InputError);
}

TEST_F(JetOfAStudy, WhatIsNoJetIsRefusedWithItsPlace) {
    EXPECT_THAT(refused("jet_flow = \"1 mL/s\"\njet_voltage = \"2 V\"\njet_flow_per_volt = \"1 mL/s/V\"\n"),
                HasSubstr("two words for one jet"));
    EXPECT_THAT(refused("jet_voltage = \"2 V\"\n"), HasSubstr("jet_flow_per_volt"));
    EXPECT_THAT(refused("jet_voltage = \"2 V\"\njet_flow_per_volt = \"0 mL/s/V\"\n"), HasSubstr("above zero"));
    EXPECT_THAT(refused("jet_flow = \"-1 mL/s\"\n"), HasSubstr("below zero"));
    EXPECT_THAT(refused("jet_flow = []\n"), HasSubstr("is empty"));
    EXPECT_THAT(refused("jet_flow = [\"1 mL/s\", \"1 mL/s\"]\n"), HasSubstr("twice"));
    EXPECT_THAT(refused("jet_flow = \"1 mL/s\"\njet_dead_band = \"1 V\"\n"), HasSubstr("there is none"));
    EXPECT_THAT(refused("jet_flow = \"1 mL/s\"\nmesher = \"snappy\"\n"), HasSubstr("mesh of blocks"));
    EXPECT_THAT(refused("jet_voltage = \"2 V\"\njet_flow_per_volt = \"1 mL/s/V\"\njet_dead_band = \"-1 V\"\n"),
                HasSubstr("jet_dead_band is below zero"));
}

}  // namespace
