// Loads of several meshes as one case with its uncertainty.
#include <gmock/gmock.h>

#include <cmath>

#include "postproc/loads/loads_table.h"
#include "postproc/loads/mesh_study.h"
#include "tests/postproc/made_zones.h"

namespace underbody::postproc {
namespace {

using testing::HasSubstr;

TEST(LoadsTable, HasOneRowACaseWithItsConditions) {
    const auto result = loads(box(false, false));
    const core::Table table = loads_table({{"a.csv", {{"gap", 0.005}}, {{"variant", "ellipse"}}, result, {}, {}},
                                           {"b.csv", {{"gap", 0.01}, {"lift_force", 1.0}}, {}, result, {}, {}}},
                                          {{"gap", "mm"}});
    EXPECT_EQ(table.rows(), 2U);
    EXPECT_EQ(table.find("gap")->written_unit, "mm");
    EXPECT_EQ(table.numbers("gap")[1], 0.01);
    EXPECT_EQ(table.text("variant")[0], "ellipse");
    EXPECT_NEAR(table.numbers("lift_force")[0], -1, 1e-12);
    EXPECT_EQ(table.numbers("lift_force_stated")[1], 1.0);
    EXPECT_TRUE(std::isnan(table.numbers("lift_force_stated")[0]));
}

TEST(LoadsTable, MakesOneCaseOfItsMeshes) {
    const auto with_lift = [](double cells, double lift, double gap) {
        LoadsCase one;
        one.file = "cells-" + std::to_string(cells);
        one.numbers = {{"gap", gap}, {"cells", cells}, {"lift_force", lift}, {"lift_force_scatter", 0.003}};
        one.texts = {{"variant", "ellipse"}, {"mesh", "any"}};
        one.loads.named.lift_force = lift;
        return one;
    };
    core::Problems notes;
    const auto studies = mesh_studies({with_lift(57280, 0.274, 0.005), with_lift(374400, 0.242, 0.005),
                                       with_lift(138544, 0.270, 0.005), with_lift(138544, 0.4, 0.002)},
                                      "cells", notes);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, testing::HasSubstr("1 of 2 cases has one mesh alone"));
    notes.clear();
    ASSERT_EQ(studies.size(), 2U);
    EXPECT_EQ(studies[0].loads.named.lift_force, 0.242);
    EXPECT_EQ(studies[0].meshes[0].second.verdict, MeshVerdict::diverging);
    EXPECT_NEAR(studies[0].sigmas[0].second, std::hypot(0.032 / std::sqrt(3), 0.003), 1e-12);
    EXPECT_NEAR(studies[1].sigmas[0].second, 0.003, 1e-12);
    const core::Table table = loads_table(studies);
    EXPECT_NEAR(table.numbers("lift_force_sigma")[0], studies[0].sigmas[0].second, 1e-15);
    EXPECT_THROW(mesh_studies(studies, "clls", notes), core::InputError);
    const auto comparisons = compare_with_stated(studies, notes);
    ASSERT_EQ(comparisons.size(), 2U);
    EXPECT_EQ(comparisons[0].of_force, 0);
}

TEST(LoadsTable, SaysHowANumberOfCellsIsWritten) {
    LoadsCase one;
    one.file = "a.csv";
    one.texts = {{"cells", "8000"}};
    try {
        core::Problems notes;
        mesh_studies({one}, "cells", notes);
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.hint(), HasSubstr("'cells [1]'"));
    }
}

/// A case with a lift of 1 N + error, and conditions.
LoadsCase case_with(const std::string& file, double error, std::vector<std::pair<std::string, double>> numbers) {
    LoadsCase one;
    one.file = file;
    one.numbers = std::move(numbers);
    one.loads.named.lift_force = 1 + error;
    one.loads.total.force = {0, 0, 1 + error};
    return one;
}

TEST(LoadsTable, OfAScatterThatIsMissingKeepsTheUncertaintyOfTheMesh) {
    core::Problems notes;
    const auto fine = case_with("fine.csv", 0.01, {{"cells", 8000}, {"lift_force_scatter", NAN}});
    const auto coarse = case_with("coarse.csv", 0.04, {{"cells", 1000}, {"lift_force_scatter", 0.1}});
    const auto studies = mesh_studies({coarse, fine}, "cells", notes);
    ASSERT_EQ(studies.size(), 1U);
    ASSERT_EQ(studies[0].sigmas.size(), 1U);
    EXPECT_NEAR(studies[0].sigmas[0].second, 0.015, 1e-12);  // two meshes: 3 * 0.03 / 3 is the 95 % interval
    EXPECT_TRUE(with_iteration_sigmas({fine})[0].sigmas.empty());
    try {
        with_iteration_sigmas({case_with("negative.csv", 0, {{"lift_force_scatter", -0.1}})});
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("negative.csv: lift_force_scatter is -0.1 N"));
    }
}

TEST(LoadsTable, KeepsCasesApartThatDifferInAConditionOfAnyName) {
    core::Problems notes;
    const auto blunt = case_with("blunt.csv", 0.2, {{"gap", 0.005}, {"nose_radius", 0.002}, {"cells", 120000}});
    const auto sharp = case_with("sharp.csv", 0.1, {{"gap", 0.005}, {"nose_radius", 0.001}, {"cells", 100000}});
    EXPECT_EQ(mesh_studies({sharp, blunt}, "cells", notes).size(), 2U);
    ASSERT_EQ(notes.size(), 2U);
    EXPECT_THAT(notes[0].message,
                HasSubstr("'sharp.csv' and 'blunt.csv' differ in 'nose_radius': taken for two cases"));
    EXPECT_THAT(
        notes[1].message,
        HasSubstr("no mesh study by 'cells': no case is there on two meshes; they differ in 'nose_radius' too"));
    // What an earlier table says of its results, and the other counts of the mesh, tells nothing apart.
    notes.clear();
    auto fine = case_with(
        "fine.csv", 0.1,
        {{"cells", 8000}, {"faces", 400}, {"lift_force_stated", 1}, {"lift_coefficient", 2}, {"closure", 0.1}});
    auto coarse = case_with(
        "coarse.csv", 0.2,
        {{"cells", 1000}, {"faces", 100}, {"lift_force_stated", 2}, {"lift_coefficient", 3}, {"closure", 0.2}});
    fine.texts = {{"values_from", "faces"}};
    coarse.texts = {{"values_from", "nodes"}};
    EXPECT_EQ(mesh_studies({fine, coarse}, "cells", notes).size(), 1U);
    EXPECT_TRUE(notes.empty());
}

TEST(LoadsTable, SaysThatThereIsNoMeshStudy) {
    core::Problems notes;
    auto one = case_with("ms_a.csv", 0.1, {{"cells", 8000}});
    auto other = case_with("ms_b.csv", 0.2, {{"cells", 1000}});
    one.texts = {{"name", "a"}};
    other.texts = {{"name", "b"}};
    EXPECT_EQ(mesh_studies({one, other}, "cells", notes).size(), 2U);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message,
                HasSubstr("they differ in 'name' too (a text that names the mesh alone is called 'mesh')"));
}

TEST(LoadsTable, KnowsThatAPlaneMeshHasTwoDimensions) {
    // Twice the cells along each side: 4 times the cells, twice the lines of the body. First order: 0.1 is the error.
    const auto plane = [](double cells, std::size_t lines, double error) {
        auto one = case_with("lines-" + std::to_string(lines), error, {{"cells", cells}});
        one.loads.dimension = 2;
        one.loads.zones.resize(1);
        one.loads.zones[0].faces = lines;
        return one;
    };
    for (const char* column : {"cells", "faces"}) {
        core::Problems notes;
        const auto studies =
            mesh_studies({plane(16000, 400, 0.1), plane(4000, 200, 0.2), plane(1000, 100, 0.4)}, column, notes);
        ASSERT_EQ(studies.size(), 1U);
        EXPECT_NEAR(studies[0].meshes[0].second.observed_order, 1, 1e-9) << column;
        EXPECT_NEAR(studies[0].meshes[0].second.expanded_uncertainty, 0.125, 1e-9);
    }
    // Of a body in space 8 times the cells, and 4 times the faces.
    core::Problems notes;
    auto fine = plane(8000, 400, 0.1), coarse = plane(1000, 100, 0.4);
    fine.loads.dimension = coarse.loads.dimension = 3;
    for (const char* column : {"cells", "faces"}) {
        EXPECT_NEAR(mesh_studies({fine, coarse}, column, notes)[0].meshes[0].second.extrapolated, 1, 1e-9) << column;
    }
}

TEST(LoadsTable, SaysWhatThePlaneForcesArePerAndHoldsNoOthers) {
    auto plane = case_with("strip.cas", 0.1, {});
    plane.loads.depth = "per metre depth";
    EXPECT_EQ(loads_table({plane}).text("depth")[0], "per metre depth");
    EXPECT_EQ(loads_table({case_with("body.cas", 0.1, {})}).find("depth"), nullptr);
    try {
        (void)loads_table({plane, case_with("body.cas", 0.1, {})});
        ADD_FAILURE() << "forces per metre and forces in one column";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(),
                    testing::AllOf(HasSubstr("'strip.cas' per metre depth"), HasSubstr("'body.cas' of a body")));
    }
}

TEST(LoadsTable, IsAManifestAgain) {
    LoadsCase one = case_with("a.csv", 0.1,
                              {{"gap", 0.005}, {"lift_force", 1}, {"lift_force_stated", 2}, {"lift_coefficient", 0.5}});
    one.texts = {{"values_from", "nodes"}};
    one.loads.coefficients = LoadsCoefficients{};
    one.loads.coefficients->lift = 0.6;
    const core::Table table = loads_table({one});
    EXPECT_EQ(table.numbers("lift_coefficient")[0], 0.6);
    EXPECT_EQ(table.numbers("lift_coefficient_stated")[0], 0.5);
    EXPECT_EQ(table.numbers("lift_force")[0], 1.1);
    EXPECT_EQ(table.numbers("lift_force_stated")[0], 1);
    EXPECT_EQ(table.numbers("lift_force_stated_stated")[0], 2);
    EXPECT_EQ(table.text("values_from_stated")[0], "nodes");
}

TEST(LoadsTable, ComparesNothingWithAMissingValue) {
    core::Problems notes;
    const auto comparisons = compare_with_stated({case_with("a.csv", 0.1, {{"lift_force", 1}, {"drag_force", NAN}}),
                                                  case_with("b.csv", 0.1, {{"lift_force", NAN}})},
                                                 notes);
    ASSERT_EQ(comparisons.size(), 1U);
    EXPECT_NEAR(comparisons[0].of_force, 0.1 / 1.1, 1e-12);  // over our own force
    ASSERT_EQ(notes.size(), 2U);
    EXPECT_EQ(notes[1].place.file, "b.csv");
    EXPECT_THAT(notes[1].message, HasSubstr("'lift_force' is not stated of this case"));
}

}  // namespace
}  // namespace underbody::postproc
