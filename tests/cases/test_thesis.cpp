// The study of the thesis: every figure is drawn, every claim has numbers and a verdict that the physics page stands
// behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/thesis/claims.h"

namespace underbody::thesis {
namespace {

TEST(ThesisStudy, DrawsItsFiguresAndJudgesItsClaims) {
    const Study study = separation();
    for (const char* number :
         {"7-7a",  "7-7b", "7-13",  "7-14",  "7-15",      "7-16",      "7-17a", "7-17b", "7-18a", "7-18b", "7-19a",
          "7-19b", "7-20", "7-21",  "7-22",  "7-peers-a", "7-peers-b", "8-2a",  "8-2b",  "8-2c",  "8-3a",  "8-3b",
          "8-3c",  "8-5",  "8-6",   "8-7a",  "8-7d",      "8-8",       "8-9a",  "8-9b",  "8-9c",  "8-10",  "8-11",
          "8-12",  "8-13", "8-14a", "8-14b", "8-14c",     "8-14d",     "8-14e", "8-14f", "8-14g", "8-14h"}) {
        const core::Figure* f = study.figure(number);
        ASSERT_NE(f, nullptr) << number;
        EXPECT_FALSE(f->title.empty());
        for (const auto& curve : f->curves) {
            EXPECT_EQ(curve.x.size(), curve.y.size());
            EXPECT_FALSE(curve.x.empty());
            for (std::size_t i = 0; i < curve.y.size();
                 ++i) {  // a value that is not finite only where a line is parted
                EXPECT_TRUE(std::isfinite(curve.y[i]) || std::isnan(curve.x[i])) << number << curve.name;
            }
        }
    }
    const auto verdict = [&](const std::string& id) {
        for (const Claim& c : study.claims) {
            if (c.id == id) {
                return c.verdict;
            }
        }
        return std::string("missing");
    };
    EXPECT_EQ(verdict("7-rank"), "reproduces");
    EXPECT_EQ(verdict("7-methods"), "does not reproduce");
    EXPECT_EQ(verdict("7.28"), "does not reproduce");
    EXPECT_EQ(verdict("8-observable"), "does not reproduce");
    EXPECT_EQ(verdict("8-14-hold"), "reproduces");
    EXPECT_EQ(verdict("8.55"), "does not reproduce");
    EXPECT_GE(study.claims.size(), 25U);
    for (const Claim& c : study.claims) {
        EXPECT_FALSE(c.computed.empty()) << c.id;
    }
}

TEST(ThesisStudy, JudgesItsStatementsOnTheBody) {
    const Study study = dynamics_of_the_body();
    for (const char* number : {"5-22", "3-13"}) {
        ASSERT_NE(study.figure(number), nullptr) << number;
    }
    const auto claim = [&](const std::string& id) {
        const auto found =
            std::find_if(study.claims.begin(), study.claims.end(), [&](const Claim& c) { return c.id == id; });
        return found == study.claims.end() ? Claim{} : *found;
    };
    EXPECT_EQ(claim("5-22-threshold").verdict, "reproduces");
    EXPECT_NE(claim("5-22-threshold").computed.find("without it escapes with no lightening at all"), std::string::npos);
    EXPECT_EQ(claim("3-13").verdict, "reproduces");
    EXPECT_EQ(claim("5-voltage").verdict, "in part");
}

}  // namespace
}  // namespace underbody::thesis
