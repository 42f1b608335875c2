// Cases for solvers.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "core/error.h"
#include "core/file.h"
#include "geometry/body/body_surface.h"
#include "geometry/cases/flow_domain.h"
#include "geometry/mesh/mesh_reader.h"
#include "tests/support/support.h"

namespace underbody::geometry {
namespace {

SurfaceMesh body(const char* name) {
    SurfaceOptions options;
    options.triangles = 6000;
    return make_surface(read_shape(test::source_folder() / "cases/evie/shapes" / (std::string(name) + ".toml")),
                        options);
}

FlowOptions coarse(double gap) {
    FlowOptions options;
    options.placement = {gap, 0, 0};
    options.cell = 0.25;
    options.surface_level = 2;
    options.iterations = 15;
    return options;
}

TEST(FlowDomain, HoldsTheBodyAndNamesItsBoundaries) {
    const SurfaceMesh mesh = body("ellipse_front_bump2");
    const FlowDomain domain = flow_domain(mesh, coarse(0.01));
    EXPECT_EQ(domain.box.lower.z, 0);
    EXPECT_EQ(domain.box.lower.y, 0);
    EXPECT_LT(domain.box.lower.x, -1.2);
    EXPECT_THAT(domain.boundaries, testing::ElementsAre("inlet", "outlet", "ground", "top", "side", "symmetry"));
    EXPECT_THAT(domain.walls, testing::ElementsAre("base", "hull", "protrusion"));
    EXPECT_NEAR(domain.clearance.smallest, 0.008, 1e-6);
    EXPECT_GT(domain.cells_in_gap, 3);
}

TEST(FlowDomain, RefusesABodyInTheGroundAndHalvesOfARolledOne) {
    const SurfaceMesh mesh = body("ellipse");
    FlowOptions options = coarse(0.005);
    options.placement.pitch = 0.2;
    EXPECT_THROW(flow_domain(mesh, options), core::InputError);
    options.placement.pitch = 0;
    options.placement.roll = 0.01;
    EXPECT_THROW(flow_domain(mesh, options), core::InputError);
    options.half = false;
    EXPECT_NO_THROW(flow_domain(mesh, options));
    options.speed = 0;
    EXPECT_THROW(flow_domain(mesh, options), core::InputError);
}

TEST(FlowDomain, ForAnsysIsAClosedRoomAroundTheHalfBody) {
    const core::TemporaryFolder folder;
    const SurfaceMesh mesh = body("rectangle");
    const auto files = write_ansys_case(mesh, coarse(0.005), folder.path() / "case");
    // All surfaces together must be closed: the sum of their area vectors vanishes, and so do moments of it.
    Vec3 sum;
    double volume = 0;
    for (const char* name : {"inlet", "outlet", "ground", "top", "side", "symmetry", "base", "hull"}) {
        MeshReadOptions options;
        options.unit = "m";
        const SurfaceMesh part = read_mesh(folder.path() / "case/surfaces" / (std::string(name) + ".stl"), options);
        const bool wall = std::string(name) == "base" || std::string(name) == "hull";
        for (std::size_t i = 0; i < part.triangles.size(); ++i) {
            const Vec3 vector = (wall ? -1.0 : 1.0) * part.area_vector(i);  // the body's normals point into the water
            sum += vector;
            volume += dot(vector, part.centre(i)) / 3;
        }
    }
    EXPECT_LT(norm(sum), 1e-9);
    const FlowDomain domain = flow_domain(mesh, coarse(0.005));
    const Vec3 size = domain.box.upper - domain.box.lower;
    EXPECT_NEAR(size.x * size.y * size.z - volume, 0.0022264 / 2, 4e-6) << "the box less half the body";
    const std::string journal = core::read_file(folder.path() / "case/fluent.jou"),
                      ccl = core::read_file(folder.path() / "case/cfx.ccl");
    EXPECT_THAT(journal, testing::HasSubstr("motion-bc-moving relative? no vmag no -0.5 quit"));
    EXPECT_THAT(journal, testing::HasSubstr("turb-intensity 1 turb-viscosity-ratio 5")) << "per cent";
    EXPECT_THAT(ccl, testing::HasSubstr("Wall U = -0.5 [m s^-1]"));
    EXPECT_THROW(write_ansys_case(mesh, coarse(0.005), folder.path() / "case"), core::InputError)
        << "never over another";
    EXPECT_EQ(files.size(), 8u * 2 + 3);
}

TEST(FlowDomain, WritesAnOpenFoamCaseThatNamesEveryPatchInEveryField) {
    const core::TemporaryFolder folder;
    write_openfoam_case(body("rectangle_bump1"), coarse(0.02), folder.path() / "case");
    for (const char* field : {"U", "p", "k", "omega", "nut"}) {
        const std::string text = core::read_file(folder.path() / "case/0" / field);
        for (const char* patch :
             {"inlet", "outlet", "ground", "top", "side", "symmetry", "base", "hull", "protrusion"}) {
            EXPECT_THAT(text, testing::HasSubstr(std::string("    ") + patch + " {")) << field;
        }
    }
    EXPECT_EQ(::access((folder.path() / "case/Allrun").c_str(), X_OK), 0);
}

// Long run: meshes and runs a few iterations. UNDERBODY_LONG_RUN=1, with Debian's package openfoam.
TEST(FlowDomain, LongRunOfTheOpenFoamCaseAsWritten) {
    const char* wanted = std::getenv("UNDERBODY_LONG_RUN");
    if (wanted == nullptr || std::string(wanted) == "0") {
        GTEST_SKIP() << "skipped: a long run; set UNDERBODY_LONG_RUN=1";
    }
    if (!std::filesystem::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not installed (Debian: apt install openfoam)";
    }
    const core::TemporaryFolder folder;
    write_openfoam_case(body("ellipse_front_bump2"), coarse(0.02), folder.path() / "case");
    const auto run = test::run_program((folder.path() / "case/Allrun").string(), {});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(core::read_file(folder.path() / "case/log.checkMesh"), testing::HasSubstr("Mesh OK."));
    EXPECT_THAT(core::read_file(folder.path() / "case/log.simpleFoam"), testing::HasSubstr("Time = 15"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "case/15/wallShearStress"));
}

}  // namespace
}  // namespace underbody::geometry
