// Designs that a search chose: in the plan with what is said of them, and that beside what their runs say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cases/design_proof.h"
#include "core/file.h"
#include "tests/cases/design_files.h"

namespace {

using namespace underbody;
using namespace underbody::cases;
using namespace underbody::cases::design_search;

using DesignProofs = DesignFiles;

/// The best by the surrogates goes to the finest mesh with what was said of it, and that stays beside the result.
TEST_F(DesignProofs, TheBestIsProvedOnTheFinestMesh) {
    Design design = open();
    design.make_plan();
    compute(design);
    design = open();
    EXPECT_TRUE(proofs(design).empty());
    const auto search = design.search(design.surrogates());
    const auto best = search.optimum(1, 1);
    ASSERT_TRUE(best);
    const auto names = design.add_for_proof({*best});
    ASSERT_EQ(names, std::vector<std::string>{"design-017"});
    EXPECT_EQ(design.add_for_proof({*best}), names);  // it stands there
    ASSERT_EQ(design.plan().size(), 17U);
    EXPECT_EQ(design.plan().back().fidelity, "medium");
    EXPECT_THAT(design.plan().back().why, testing::HasSubstr("to be proved on medium"));

    design = open();  // as plan.csv has it
    ASSERT_EQ(proofs(design).size(), 1U);
    EXPECT_EQ(proofs(design)[0].note, "not computed yet");
    const auto& said = design.plan().back().predicted;
    ASSERT_EQ(said.size(), 2U);
    EXPECT_NEAR(said.at("lift").value, best->objectives[0].value, 1e-9);
    EXPECT_NEAR(said.at("stiffness").sigma, best->objectives[1].sigma, 1e-9);
    EXPECT_TRUE(design.plan().front().predicted.empty());

    compute(design);
    design = open();
    const auto all = proofs(design);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].note, "");
    ASSERT_EQ(all[0].responses.size(), 2U);
    const auto& at = design.plan().back().at;
    const auto &level = all[0].responses[0], &stiffness = all[0].responses[1];
    ASSERT_TRUE(level.computed && stiffness.computed);
    EXPECT_NEAR(level.computed->value, lift(at[0], at[1], 5e-3, 0), 2e-6);  // six decimals in the file
    EXPECT_NEAR(level.computed->sigma, 0.0005 / std::sqrt(2), 1e-9);        // mean of two runs
    const double one = M_PI / 180;
    EXPECT_NEAR(stiffness.computed->value,
                (moment(at[0], at[1], 5e-3, one) - moment(at[0], at[1], 5e-3, -one)) / (2 * one), 1e-4);
    EXPECT_EQ(stiffness.unit, "N m/rad");
    EXPECT_LT(std::abs(level.difference_in_sigmas()), 4);
    EXPECT_LT(std::abs(stiffness.difference_in_sigmas()), 4);
    EXPECT_EQ(proof_figures(all).size(), 2U);  // N and N m/rad

    // Of other objectives it is no prediction.
    std::string text = design_toml;
    text.replace(text.find("at = { gap = \"5 mm\""), 19, "at = { gap = \"3 mm\"");
    core::write_file(folder_.path() / "study.toml", text);
    const auto other = proofs(open());
    ASSERT_EQ(other.size(), 1U);
    EXPECT_THAT(other[0].note, testing::HasSubstr("for other conditions, objectives or limits"));
    EXPECT_TRUE(other[0].responses.empty());
}

/// The best may be a design that stands there already, but for rounding: it keeps its name and its numbers, so that the
/// plan can be read again.
TEST_F(DesignProofs, ABestThatIsPlannedKeepsItsNumbers) {
    core::write_file(folder_.path() / "design" / "plan.csv",
                     "design,protrusion.height [mm],body.base_cut [1],fidelity\nmine,1,0.7,coarse\n");
    Design design = open();
    tables::Candidate candidate;
    candidate.at = {1e-3 * (1 + 1e-12), 0.7 * (1 - 1e-15)};
    EXPECT_EQ(design.add_for_proof({candidate}), std::vector<std::string>{"mine"});
    const Design again = open();
    ASSERT_EQ(again.plan().size(), 2U);
    EXPECT_EQ(again.plan()[1].fidelity, "medium");
    EXPECT_EQ(again.plan()[1].at, again.plan()[0].at);
}

/// A body that touches the ground at a gap and pitch that [design] computes is no candidate, and that needs no run.
TEST_F(DesignProofs, WhatTouchesTheGroundIsNoCandidate) {
    const Design design = open();
    const auto base = geometry::read_shape(design.spec().shape);
    EXPECT_LT(broken_by(design.spec(), base, std::vector<double>{1e-3, 0.7}), 0);
    EXPECT_GT(broken_by(design.spec(), base, std::vector<double>{2.9e-3, 0.7}), 0);  // at 3 mm and one degree
    DesignSpec higher = design.spec();
    higher.gaps = {6e-3};
    EXPECT_LT(broken_by(higher, base, std::vector<double>{2.9e-3, 0.7}), 0);
}

/// What the runs of a design do not reach is not made up.
TEST_F(DesignProofs, AResponseBeyondItsRunsIsNotComputed) {
    Design design = open();
    design.make_plan();
    compute(design);
    design = open();
    tables::Response response{"lift at 4 mm", "lift_force", {{"gap", 4e-3}, {"pitch", 0}}, "", 0};
    const std::string name = design.plan()[2].name;
    const auto& at = design.plan()[2].at;
    const auto between = computed_response(design, name, "coarse", response);
    ASSERT_TRUE(between);
    EXPECT_NEAR(between->value, 0.5 * (lift(at[0], at[1], 3e-3, 0) + lift(at[0], at[1], 5e-3, 0)), 2e-6);
    EXPECT_FALSE(computed_response(design, name, "medium", response));
    EXPECT_FALSE(computed_response(design, "design-099", "coarse", response));
    response.conditions[0].value = 2e-3;
    EXPECT_FALSE(computed_response(design, name, "coarse", response));
    response.conditions[0].value = 3e-3;
    response.slope_along = "pitch";
    response.half_width = 2 * M_PI / 180;
    EXPECT_FALSE(computed_response(design, name, "coarse", response));
}

/// A name that a person typed is not given again: two designs of one name could not be read.
TEST_F(DesignProofs, NewNamesLeaveTypedOnesAlone) {
    core::write_file(folder_.path() / "design" / "plan.csv",
                     "design,protrusion.height [mm],body.base_cut [1]\ndesign-003,1,0.7\nmine,2,0.7\n");
    Design design = open();
    tables::Candidate candidate;
    candidate.at = {1.5e-3, 0.8};
    EXPECT_EQ(design.add({candidate}, "typed"), std::vector<std::string>{"design-004"});
    EXPECT_EQ(open().plan().size(), 3U);
}

}  // namespace
