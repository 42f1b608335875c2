// Loads of several meshes as one case with its uncertainty.
#include "postproc/loads_table.h"

#include <gmock/gmock.h>

#include <cmath>

namespace underbody::postproc {
namespace {

using testing::HasSubstr;

TEST(LoadsTable, MakesOneCaseOfItsMeshes) {
    const auto with_lift = [](double cells, double lift, double gap) {
        LoadsCase one;
        one.file = "cells-" + std::to_string(cells);
        one.numbers = {{"gap", gap}, {"cells", cells}, {"lift_force", lift}, {"lift_force_scatter", 0.003}};
        one.texts = {{"variant", "ellipse"}, {"mesh", "any"}};
        one.loads.named.lift_force = lift;
        return one;
    };
    const auto studies = mesh_studies({with_lift(57280, 0.274, 0.005), with_lift(374400, 0.242, 0.005), with_lift(138544, 0.270, 0.005), with_lift(138544, 0.4, 0.002)});
    ASSERT_EQ(studies.size(), 2U);
    EXPECT_EQ(studies[0].loads.named.lift_force, 0.242);
    EXPECT_EQ(studies[0].meshes[0].second.verdict, MeshVerdict::diverging);
    EXPECT_NEAR(studies[0].sigmas[0].second, std::hypot(0.032 / std::sqrt(3), 0.003), 1e-12);
    EXPECT_NEAR(studies[1].sigmas[0].second, 0.003, 1e-12);
    const core::Table table = loads_table(studies);
    EXPECT_NEAR(table.numbers("lift_force_sigma")[0], studies[0].sigmas[0].second, 1e-15);
    EXPECT_THROW(mesh_studies(studies, "clls"), core::InputError);
    const auto comparisons = compare_with_stated(studies);
    ASSERT_EQ(comparisons.size(), 2U);
    EXPECT_EQ(comparisons[0].of_force, 0);
}

TEST(LoadsTable, SaysHowANumberOfCellsIsWritten) {
    LoadsCase one;
    one.file = "a.csv";
    one.texts = {{"cells", "8000"}};
    try {
        mesh_studies({one}, "cells");
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.hint(), HasSubstr("'cells [1]'"));
    }
}

}  // namespace
}  // namespace underbody::postproc
