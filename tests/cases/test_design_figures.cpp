// Pictures of a design search, as the values that they are drawn from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "cases/design_figures.h"
#include "core/error.h"
#include "core/file.h"
#include "surrogates/tables/search/sampling.h"

namespace {

using namespace underbody;
using namespace underbody::cases;

class FiguresOfASearch : public testing::Test {
protected:
    FiguresOfASearch() {
        core::write_file(folder_.path() / "evie.toml",
                         "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n");
        core::write_file(folder_.path() / "study.toml", R"(
title = "search"
[frame]
symmetry = "y"
[design]
shape = "evie.toml"
gap = ["3 mm", "6 mm"]
quantities = ["lift_force", "drag_force"]
[[design.vary]]
key = "body.base_cut"
from = 0.6
to = 0.85
[[design.vary]]
key = "body.taper"
from = -0.4
to = 0.2
[[design.objective]]
quantity = "lift_force"
sense = "maximise"
at = { gap = "5 mm" }
[[design.objective]]
quantity = "drag_force"
sense = "minimise"
at = { gap = "5 mm" }
)");
        std::string plan = "design,body.base_cut [1],body.taper [1],fidelity,why,state\n",
                    results =
                        "design,body.base_cut [1],body.taper [1],gap [mm],fidelity,lift_force [N],drag_force "
                        "[N],state\n";
        std::size_t n = 0;
        for (const auto& u : tables::sobol_plan(12, 2, 1)) {
            const std::string name = "d" + std::to_string(++n);
            const double cut = 0.6 + 0.25 * u[0], taper = -0.4 + 0.6 * u[1];
            const std::string at = std::to_string(cut) + "," + std::to_string(taper);
            plan += name + "," + at + ",medium," +
                    (n < 10   ? "plan"
                     : n < 12 ? "typed"
                              : "expected improvement") +
                    ",planned\n";
            for (const double gap : {3.0, 6.0}) {  // what lifts drags: a front along the cut
                const double lift = cut * (2 - taper * taper) / gap,
                             drag = 0.5 + cut * cut - 0.1 * std::abs(taper + 0.1);
                results += name + "," + at + "," + std::to_string(gap) + ",medium," + std::to_string(lift) + "," +
                           std::to_string(drag) + ",solved\n";
            }
        }
        core::write_file(folder_.path() / "design" / "plan.csv", plan);
        core::write_file(folder_.path() / "design" / "results.csv", results);
    }

    [[nodiscard]] Design open() const { return Design::open(Study::open(folder_.path())); }

    core::TemporaryFolder folder_;
};

TEST_F(FiguresOfASearch, CoverageTellsThePlanFromWhatWasTypedAndWhatWasChosen) {
    const core::Figure figure = coverage_figure(open(), 0, 1);
    ASSERT_EQ(figure.points.size(), 3u);
    EXPECT_EQ(figure.points[0].x.size(), 9u);
    EXPECT_EQ(figure.points[1].name, "typed");
    EXPECT_EQ(figure.points[1].x.size(), 2u);
    EXPECT_EQ(figure.points[2].x.size(), 1u);
    EXPECT_LT(figure.x.lower, 0.6);  // markers at the ends of a range are whole
    EXPECT_GT(figure.x.upper, 0.85);
}

TEST_F(FiguresOfASearch, TheFrontHasEachDesignOnceAndBodiesAtItsPoints) {
    const Design design = open();
    const tables::DesignSearch search = design.search(design.surrogates());
    const auto front = search.pareto_front(10, 1, 1);
    ASSERT_GT(front.size(), 3u);
    for (std::size_t i = 0; i < front.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_GT(std::hypot(front[i].at[0] - front[j].at[0], front[i].at[1] - front[j].at[1]), 1e-4);
            const auto &a = front[i].objectives, &b = front[j].objectives;  // more lift costs drag
            EXPECT_GE((a[0].value - b[0].value) * (a[1].value - b[1].value), -1e-12);
        }
    }
    auto& none = core::Progress::none();
    const core::Figure figure = front_figure(design, search, front, {}, none);
    ASSERT_GT(figure.curves.size(), 1u);
    for (const core::FigureCurve& outline : figure.curves) {
        EXPECT_EQ(outline.x.front(), outline.x.back());  // a section is closed
        const auto [left, right] = std::minmax_element(outline.x.begin(), outline.x.end());
        EXPECT_NEAR(*right - *left, (figure.x.upper - figure.x.lower) / 12, 1e-3 * (*right - *left));
        // Its middle is a point of the front.
        const bool at_a_point = std::any_of(front.begin(), front.end(), [&](const tables::Candidate& c) {
            return std::abs(c.objectives[0].value - 0.5 * (*left + *right)) < 1e-3 * (*right - *left);
        });
        EXPECT_TRUE(at_a_point);
    }
    EXPECT_FALSE(bodies_figure(design, front, none).curves.empty());
}

TEST_F(FiguresOfASearch, ParallelCoordinatesHaveALineADesignAndAnAxisANumber) {
    const Design design = open();
    const tables::DesignSearch search = design.search(design.surrogates());
    std::vector<tables::Candidate> known;
    for (const PlannedDesign& d : design.plan()) {
        known.push_back(search.describe(d.at));
    }
    const core::Figure figure = parallel_figure(search, known, {});
    ASSERT_EQ(figure.curves.size(), 12u);
    ASSERT_EQ(figure.bars.front().labels.size(), 4u);  // two numbers, two objectives
    double most = 0;
    for (std::size_t i = 0; i < 12; ++i) {
        const auto& line = figure.curves[i];
        ASSERT_EQ(line.y.size(), 4u);
        EXPECT_NEAR(line.y[0], (design.plan()[i].at[0] - 0.6) / 0.25, 1e-9);
        most = std::max(most, line.y[2]);
    }
    EXPECT_NEAR(most, 1, 1e-12);
}

TEST_F(FiguresOfASearch, OneNumberAtATimeFollowsTheSurrogate) {
    const auto surrogates = open().surrogates();
    const tables::Surrogate& lift = surrogates.at("lift_force");
    const auto middle = middle_of(lift.variables());
    const auto points = along(lift, middle, 0, 5);
    ASSERT_EQ(points.size(), 5u);
    EXPECT_DOUBLE_EQ(points.front().at, 0.6);
    EXPECT_DOUBLE_EQ(points.back().at, 0.85);
    EXPECT_DOUBLE_EQ(points[2].value, lift.at(middle).value);
    EXPECT_EQ(one_at_a_time_figure(lift, middle).curves.size(), 3u);  // two numbers and the gap
}

TEST_F(FiguresOfASearch, WithoutRunsNothingIsLearnedAndThatIsSaid) {
    std::filesystem::remove(folder_.path() / "design" / "results.csv");
    try {
        (void)open().surrogates();
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("nothing has been computed yet"));
        EXPECT_THAT(error.what(), testing::HasSubstr("results.csv"));
    }
}

}  // namespace
