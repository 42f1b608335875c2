// Cases that OpenFOAM itself meshes and solves, small ones.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// A real case, coarse: 20 iterations, killed on the way and gone on with.
TEST(RealOpenFoam, ACaseIsMeshedSolvedAndReadAsItsOwnForcesSay) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    ASSERT_EQ(
        test::run_underbody(
            {"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap", "30mm",
             "--out", "case", "--iterations", "20", "--cell", "0.5", "--surface-level", "1", "--layers", "0"},
            folder.path())
            .exit_code,
        0);
    const auto solved = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    const json result = json::parse(solved.output);
    EXPECT_EQ(result["iterations"], 20);
    const auto loads = test::run_underbody(
        {"loads", "case", "--symmetry", "y", "--zones", "hull,base", "--json", "--check", "1 %"}, folder.path());
    EXPECT_EQ(loads.exit_code, 0) << loads.errors;
    // A checkpoint: what was written last is lost, the one before is whole.
    fs::remove_all(folder.path() / "case" / "20");
    const auto again = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    const json rest = json::parse(again.output);
    EXPECT_GT(rest["went_on_from"].get<double>(), 0);
    EXPECT_EQ(rest["iterations"], 20);
    for (std::size_t k = 0; k < 3; ++k) {
        const double before = result["forces"][0]["force"][k];
        EXPECT_NEAR(rest["forces"][0]["force"][k].get<double>(), before, 1e-4 * std::abs(before) + 1e-9) << k;
    }
}

/// Blocks: the start in first order, then second order; cut on the way and gone on with.
TEST(RealOpenFoam, ACaseOfBlocksIsSolvedAndReadAsItsOwnForcesSay) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    const auto made = test::run_underbody(
        {"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse_front_bump1.toml").string(), "--gap",
         "5mm", "--out", "case", "--iterations", "12", "--mesh-density", "coarse", "--json"},
        folder.path());
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    EXPECT_EQ(json::parse(made.output)["mesher"], "blocks");
    EXPECT_EQ(json::parse(made.output)["cells_in_gap"], 20);
    const auto solved = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    EXPECT_EQ(json::parse(solved.output)["iterations"], 12);
    EXPECT_TRUE(json::parse(solved.output)["settled"].is_null());  // too few to say
    const auto loads = test::run_underbody(
        {"loads", "case", "--symmetry", "y", "--zones", "hull,base,protrusion", "--json", "--check", "1 %"},
        folder.path());
    EXPECT_EQ(loads.exit_code, 0) << loads.errors;
    EXPECT_THAT(core::read_file(folder.path() / "case" / "log.checkMesh"), HasSubstr("Mesh OK."));
    fs::remove_all(folder.path() / "case" / "12");
    const auto again = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_GE(json::parse(again.output)["went_on_from"].get<double>(), 4);
}

/// The file that ends a run is gone when OpenFOAM has ended: the case counts as solved all the same.
TEST(RealOpenFoam, ARunThatIsEndedByItsFileIsSolved) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    ASSERT_EQ(
        test::run_underbody({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(),
                             "--gap", "5mm", "--out", "case", "--iterations", "800", "--mesh-density", "draft"},
                            folder.path())
            .exit_code,
        0);
    const std::string script = "cd " + (folder.path() / "case").string() +
                               " && (until [ -e postProcessing/forces ]; do sleep 0.05; done; touch settled) & cd " +
                               (folder.path() / "case").string() + " && ./Allrun > out 2>&1; wait";
    ASSERT_EQ(std::system(script.c_str()), 0);
    EXPECT_FALSE(fs::exists(folder.path() / "case" / "settled"));
    const auto solved = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    EXPECT_EQ(json::parse(solved.output)["solved_before"], true);
    EXPECT_LT(json::parse(solved.output)["iterations"], 400);
}

/// [design]: planned shapes at their conditions on meshes of blocks; what cannot be placed is kept with its reason.
TEST(RealOpenFoam, ADesignIsRunOnBlocks) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "evie.toml",
                     "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n");
    core::write_file(
        folder.path() / "study.toml",
        "title = \"search\"\n[frame]\nsymmetry = \"y\"\n[design]\nshape = \"evie.toml\"\npoints = 1\ngap = \"3 mm\"\n"
        "pitch = [\"-5 deg\", \"1 deg\"]\n"
        "quantities = [\"lift_force\", \"drag_force\", \"pitch_moment\", \"pitch_moment_at_buoyancy\"]\n"
        "[[design.vary]]\nkey = \"body.base_cut\"\nfrom = 0.74\nto = 0.76\n"
        "[[design.fidelity]]\nname = \"draft\"\niterations = 12\n");
    const auto ran = test::run_underbody({"design", "run", ".", "--json"}, folder.path());
    ASSERT_EQ(ran.exit_code, 0) << ran.errors;
    EXPECT_EQ(json::parse(ran.output)["runs"], 2);
    const fs::path results = folder.path() / "design" / "results.csv";
    const core::Table table = core::read_csv(results);
    ASSERT_EQ(table.rows(), 2u);
    const std::size_t made = table.numbers("pitch")[0] > 0 ? 0 : 1;
    EXPECT_THAT(table.text("state")[1 - made], HasSubstr("below the ground"));
    EXPECT_TRUE(std::isnan(table.numbers("lift_force")[1 - made]));
    // Twelve iterations settle nothing.
    EXPECT_EQ(table.text("state")[made], "not settled");
    const json mesh =
        json::parse(core::read_file(folder.path() / "design/runs/draft/design-001-h3-p1-u0.5/constant/mesh.json"));
    EXPECT_GE(mesh["cells_in_gap"], 15);
    // About the centre of buoyancy of that body, by the centroid of its surface.
    const json mass = json::parse(
        test::run_underbody({"body", "design/shapes/design-001.toml", "--json", "--panels", "0"}, folder.path())
            .output);
    const double x = mass["centroid"][0], z = mass["centroid"][2], a = M_PI / 180;
    EXPECT_NEAR(table.numbers("pitch_moment_at_buoyancy")[made],
                table.numbers("pitch_moment")[made] -
                    (x * std::cos(a) - z * std::sin(a)) * table.numbers("lift_force")[made] -
                    (x * std::sin(a) + z * std::cos(a)) * table.numbers("drag_force")[made],
                1e-5);
    // What the run's own criterion says of it counts, not the trend that the loads have at its end.
    const fs::path marker = folder.path() / "design/runs/draft/design-001-h3-p1-u0.5/case.foam";
    json said = json::parse(core::read_file(marker));
    said["settled"] = true;
    core::write_file(marker, said.dump(2));
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_csv(results).text("state")[made], "solved");
    said["settled"] = false;
    core::write_file(marker, said.dump(2));
    fs::remove(results);
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_csv(results).text("state")[0], "not settled");
    // What is there is not made again; what lost its fields keeps its row.
    const std::string before = core::read_file(results);
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_file(results), before);
    std::string trusted = before;
    trusted.replace(trusted.find("not settled"), 11, "solved");
    core::write_file(results, trusted);
    fs::remove_all(folder.path() / "design" / "runs");
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_file(results), trusted);
    EXPECT_FALSE(fs::exists(folder.path() / "design/runs/draft/design-001-h3-p1-u0.5"));
}

}  // namespace
}  // namespace underbody
