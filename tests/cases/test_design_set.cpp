// The shipped search's own CFD: how well surrogates over its shapes do on shapes that they have not seen.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "cases/design.h"
#include "cases/design_proof.h"
#include "tests/support/support.h"

namespace {

using namespace underbody;
using namespace underbody::cases;

/// Computed by `underbody design run` on draft meshes (cases/evie-pitch/README.md).
Design shipped() { return Design::open(Study::open(test::source_folder() / "cases/evie-pitch")); }

TEST(ShippedSearch, RunsAreOfPlannedShapesAndSettled) {
    const Design design = shipped();
    std::set<std::string> planned, run;
    for (const PlannedDesign& p : design.plan()) {
        EXPECT_EQ(p.state, "planned") << p.name;
        planned.insert(p.name);
    }
    for (const DesignRun& r : design.runs()) {
        EXPECT_TRUE(planned.contains(r.design)) << r.design;
        run.insert(r.usable() ? r.design : "");
        for (const auto& [quantity, sigma] : r.sigmas) {
            EXPECT_GE(sigma, 0) << r.design << " " << quantity;
        }
    }
    run.erase("");
    EXPECT_GE(run.size(), 28u);
}

TEST(ShippedSearch, SurrogatesHoldOnShapesLeftOut) {
    for (const auto& [quantity, surrogate] : shipped().surrogates()) {
        SCOPED_TRACE(quantity);
        const tables::LeftOutCheck& check = surrogate.check();
        EXPECT_GE(check.shapes, 28u);
        EXPECT_GE(check.inside_95, 0.90);
        EXPECT_GE(check.inside_upper, 0.95);  // counted by shape
        EXPECT_LE(check.root_mean_square, 0.5 * check.nearest_shape);
    }
}

TEST(ShippedSearch, WhatWasPredictedOfItsBestIsComparedWithItsRuns) {
    const auto all = proofs(shipped());
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all.front().note, "");
    EXPECT_EQ(all.front().responses.size(), 6u);
    for (const ProofOfResponse& one : all.front().responses) {
        EXPECT_LT(std::abs(one.difference_in_sigmas()), 2) << one.name;
    }
}

}  // namespace
