// Names that hold numbers are ordered as people read them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "studio/desktop/case_points.h"
#include "studio/desktop/natural_order.h"

namespace underbody::studio {
namespace {

TEST(NaturalOrder, NumbersCountAsNumbersAndFractionsAsFractions) {
    const std::vector<QString> right = {"run7_h1mm_p0",   "run7_h1.25mm_p0", "run7_h1.5mm_p0", "run7_h2mm_p0",
                                        "run7_h10mm_p-1", "run7_h10mm_p0",   "run7_h100mm_p0", "run10_h1mm.csv"};
    std::vector<QString> mixed = right;
    std::shuffle(mixed.begin(), mixed.end(), std::mt19937(7));
    std::sort(mixed.begin(), mixed.end(), natural_less);
    EXPECT_EQ(mixed, right);
    const auto ranks = natural_ranks(right);
    EXPECT_TRUE(std::is_sorted(ranks.begin(), ranks.end()));
    EXPECT_TRUE(natural_less("ellipse-h1-p0", "ellipse-h1.5-p0"));
    EXPECT_TRUE(natural_less("a.csv", "b.csv"));
}

// Points of cases over the gap: in the order of what tells them apart, however the files are called.
TEST(NaturalOrder, TheLegendOfTheCasesIsInOrder) {
    cases::Study study;
    cases::StudyResults results;
    for (const double pitch : {0.0, -0.02, 0.01, 0.02, -0.01}) {
        cases::Case one;
        one.conditions.set("gap", 0.005);
        one.conditions.set("pitch", pitch);
        results.case_loads.emplace_back();
        results.case_loads.back().entry = study.cases.size();
        results.case_loads.back().values = {{"lift_force", "N", pitch}};
        study.cases.push_back(one);
    }
    std::vector<double> lifts;
    for (const auto& points : lift_of_cases(study, results).points) {
        lifts.push_back(points.y.at(0));
    }
    EXPECT_EQ(lifts, (std::vector<double>{-0.02, -0.01, 0, 0.01, 0.02}));
}

}  // namespace
}  // namespace underbody::studio
