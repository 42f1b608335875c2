// Block meshes of the family's bodies: closed forms, orders of convergence, OpenFOAM's own check.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <regex>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "geometry/blocks/block_mesh.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/cases/flow_domain.h"
#include "tests/support/support.h"

namespace underbody::geometry {
namespace {

constexpr double degree = std::numbers::pi / 180;

BodyShape evie(const char* name) {
    return read_shape(test::source_folder() / "cases/evie/shapes" / (std::string(name) + ".toml"));
}

BodyShape evie_with(const std::string& lines) {
    return parse_shape("[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n" +
                       lines);
}

BlockMeshOptions over(double gap, double pitch = 0, MeshDensity density = MeshDensity::coarse, double roll = 0) {
    BlockMeshOptions options;
    options.placement = {gap, pitch, roll};
    options.density = density;
    options.half = roll == 0;
    return options;
}

struct FaceSums {
    Vec3 area;                    // sum of area vectors
    double size = 0;              // sum of their lengths
    double flux_y = 0, flux = 0;  // of the vector fields (0, y, 0) and position / 3
};

FaceSums sums_over(const PolyMesh& mesh, const PolyMesh::Patch& patch) {
    FaceSums sums;
    for (std::size_t f = patch.first; f < patch.first + patch.count; ++f) {
        const auto p = [&](std::size_t c) { return mesh.points[static_cast<std::size_t>(mesh.faces[f][c])]; };
        const Vec3 middle = 0.25 * (p(0) + p(1) + p(2) + p(3));
        for (std::size_t c = 0; c < 4; ++c) {  // exact over the triangles about the middle, as the cells' volumes are
            const Vec3 a = p(c), b = p((c + 1) % 4), area = 0.5 * cross(b - a, middle - a);
            const Vec3 centre = (a + b + middle) / 3.0;
            sums.area += area;
            sums.size += norm(area);
            sums.flux_y += centre.y * area.y;
            sums.flux += dot(centre, area) / 3;
        }
    }
    return sums;
}

/// m^3, of the whole body, by the walls of a half: the plane y = 0 has no flux of (0, y, 0).
double body_volume(const BlockMesh& made) {
    double flux = 0;
    for (const std::string& wall : made.walls) {
        flux += sums_over(made.mesh, made.mesh.patch(wall)).flux_y;
    }
    return -2 * flux;
}

std::vector<std::pair<std::string, BodyShape>> family() {
    return {
        {"ellipse", evie("ellipse")},
        {"rectangle", evie("rectangle")},
        {"ellipse_front", evie("ellipse_front")},
        {"ellipse_front_bump2", evie("ellipse_front_bump2")},
        {"rectangle_bump1", evie("rectangle_bump1")},
        {"sharp protrusion", evie_with("[protrusion]\nheight = \"2 mm\"\nprofile = \"sharp\"\n")},
        {"sharp, blended, forward", evie_with("base = \"ellipse_front\"\n[protrusion]\nheight = \"2 mm\"\nprofile = "
                                              "\"sharp\"\nblend_radius = \"3 mm\"\nposition = 0.3\n")},
        {"nozzle", evie_with("[nozzle]\ndiameter = \"5 mm\"\n")},
        {"nozzle with a bore, protrusion",
         evie_with("base = \"rectangle\"\n[nozzle]\ndiameter = \"8 mm\"\ndepth = \"6 mm\"\nposition = "
                   "0.3\n[protrusion]\nheight = \"1 mm\"\n")},
        {"rounded edge", evie_with("edge_radius = \"5 mm\"\n")},
        {"rounded edges of a rectangle", evie_with("base = \"rectangle\"\nedge_radius = \"4 mm\"\n")},
        {"taper", evie_with("taper = 0.3\n")},
        {"taper of a rectangle", evie_with("base = \"rectangle\"\ntaper = 0.5\n")},
        {"pitched base", evie_with("base_pitch = \"2 deg\"\n")},
        {"base moved aft", evie_with("base_offset = \"-30 mm\"\n")},
        {"base moved forward, pitched, tapered",
         evie_with("base_offset = \"15 mm\"\nbase_pitch = \"-1 deg\"\ntaper = -0.3\n")},
        {"small base", evie_with("base = \"rectangle\"\nbase_length = \"60 mm\"\nbase_width = \"40 mm\"\n")},
        {"all of it", evie_with("base = \"ellipse_front\"\nbase_pitch = \"1 deg\"\nedge_radius = \"3 mm\"\ntaper = "
                                "0.2\n[nozzle]\ndiameter = \"5 mm\"\ndepth = \"3 mm\"\n[protrusion]\nheight = \"1.5 "
                                "mm\"\nposition = 0.85\nblend_radius = \"2 mm\"\n")}};
}

TEST(BlockMesh, HasTheCellsThatAreSaidInNoTime) {
    EXPECT_EQ(make_block_mesh(evie("ellipse"), over(0.005)).quality.cells, 57280u);
    EXPECT_EQ(make_block_mesh(evie("ellipse"), over(0.002, 0, MeshDensity::fine)).quality.cells, 374400u);
    const double start = test::processor_seconds();
    const BlockMesh medium = make_block_mesh(evie("ellipse"), over(0.001, 0, MeshDensity::medium));
    EXPECT_LT(test::processor_seconds() - start, 10);  // usually 0.4
    EXPECT_EQ(medium.quality.cells, 138544u);
    EXPECT_GE(medium.cells_in_gap, 25);
    EXPECT_NEAR(medium.smallest_clearance, 0.001, 1e-12);
    EXPECT_GT(medium.wall_units_mean, 0.5);
    EXPECT_LT(medium.wall_units_mean, 1.5);
}

TEST(BlockMesh, OfEveryBodyOfTheFamilyIsSound) {
    for (const auto& [name, shape] : family()) {
        SCOPED_TRACE(name);
        const auto surface = patches(make_surface(shape, {4000, 0.5}));
        for (const double pitch : {-2 * degree, 0.0, 2 * degree}) {
            const BlockMesh made = make_block_mesh(shape, over(0.006, pitch));
            EXPECT_EQ(fault_of(made.quality), "");
            EXPECT_GT(made.quality.smallest_volume, 0);
            EXPECT_LT(made.quality.largest_non_orthogonality, 82 * degree);
            ASSERT_EQ(made.walls.size(), surface.size());
            for (std::size_t p = 0; p < surface.size(); ++p) {
                EXPECT_EQ(made.walls[p], surface[p].name);
                const double area = 2 * sums_over(made.mesh, made.mesh.patch(surface[p].name)).size;
                EXPECT_NEAR(area, surface[p].area, 0.06 * surface[p].area) << surface[p].name << " at " << pitch;
            }
        }
        const BlockMesh rolled = make_block_mesh(shape, over(0.008, 1 * degree, MeshDensity::coarse, 3 * degree));
        EXPECT_EQ(fault_of(rolled.quality), "");
        EXPECT_LT(rolled.smallest_clearance, 0.008 - 0.03 * std::sin(3 * degree));
    }
}

TEST(BlockMesh, WallsLieOnTheExactBody) {
    for (const auto& [name, shape] : family()) {
        SCOPED_TRACE(name);
        const ExactBody body(shape);
        const BlockMesh made = make_block_mesh(shape, over(0.005));
        const auto& hull = made.mesh.patch("hull");
        double farthest = 0;
        for (std::size_t f = hull.first; f < hull.first + hull.count; ++f) {
            for (const std::int32_t i : made.mesh.faces[f]) {
                Vec3 p = made.mesh.points[static_cast<std::size_t>(i)];
                p.x += body.base_centre();
                p.z -= 0.005;
                double outside = body.distance_to_ellipsoid(p);
                for (const Side side : {Side::front, Side::back, Side::port}) {
                    outside = body.cut(side) && body.unbent(p).z < body.depth()
                                  ? std::max(outside, body.distance_to_side(p, side))
                                  : outside;
                }
                farthest = std::max(farthest, std::abs(outside));
            }
        }
        EXPECT_LT(farthest, 1e-8);
        const auto& base = made.mesh.patch("base");
        for (std::size_t f = base.first; f < base.first + base.count; f += 7) {
            Vec3 p = made.mesh.points[static_cast<std::size_t>(made.mesh.faces[f][0])];
            p.x += body.base_centre();
            p.z -= 0.005;
            EXPECT_NEAR(body.distance_to_base(p), 0, 1e-9);
        }
    }
}

TEST(BlockMesh, BodyAndDomainConvergeToTheExactVolumesInSecondOrder) {
    for (const char* name : {"ellipse", "rectangle", "ellipse_front_bump2"}) {
        SCOPED_TRACE(name);
        const BodyShape shape = evie(name);
        const double exact = ExactBody(shape).volume();
        std::vector<double> of_body, of_domain;
        for (const MeshDensity density : {MeshDensity::coarse, MeshDensity::medium, MeshDensity::fine}) {
            const BlockMesh made = make_block_mesh(shape, over(0.004, 1 * degree, density));
            of_body.push_back(std::abs(body_volume(made) / exact - 1));
            of_domain.push_back(std::abs(made.quality.volume / (made.far_volume - exact / 2) - 1));
            // Cells fill what lies between the boundaries, and nothing else.
            double flux = 0;
            for (const auto& patch : made.mesh.patches) {
                flux += sums_over(made.mesh, patch).flux;
            }
            EXPECT_NEAR(flux, made.quality.volume, 1e-9 * flux);
        }
        // Twice as many cells each way from coarse to fine: a quarter of the error; 1.4 times to medium: a half.
        EXPECT_LT(of_body[0], 0.02);
        EXPECT_LT(of_body[2], 0.33 * of_body[0]);
        EXPECT_LT(of_body[1], 0.65 * of_body[0]);
        EXPECT_LT(of_domain[2], 0.33 * of_domain[0]);
        EXPECT_LT(of_domain[2], 2e-3);
    }
}

TEST(BlockMesh, BoundariesFaceOutward) {
    const BlockMesh made = make_block_mesh(evie("ellipse_front_bump1"), over(0.005));
    const FaceSums ground = sums_over(made.mesh, made.mesh.patch("ground"));
    EXPECT_NEAR(ground.area.z, -ground.size, 1e-12);
    const FaceSums symmetry = sums_over(made.mesh, made.mesh.patch("symmetry"));
    EXPECT_NEAR(symmetry.area.y, -symmetry.size, 1e-12);
    const FaceSums base = sums_over(made.mesh, made.mesh.patch("base"));
    EXPECT_NEAR(base.area.z, base.size, 1e-4 * base.size);  // into the body; the ridge's ends cross cells
    for (const auto& patch : made.mesh.patches) {
        for (std::size_t f = patch.first; f < patch.first + patch.count; ++f) {
            ASSERT_LT(static_cast<std::size_t>(made.mesh.owner[f]), made.mesh.cells);
        }
    }
    for (std::size_t f = 0; f < made.mesh.inner_faces(); ++f) {
        ASSERT_LT(made.mesh.owner[f], made.mesh.neighbour[f]);
        if (f > 0 && made.mesh.owner[f] == made.mesh.owner[f - 1]) {
            ASSERT_GT(made.mesh.neighbour[f], made.mesh.neighbour[f - 1]);  // upper triangular
        }
    }
}

TEST(BlockMesh, NoseUpLiftsTheNoseAndRollLowersStarboard) {
    const auto lowest = [](const BlockMesh& made) {
        Vec3 low{0, 0, 1};
        const auto& base = made.mesh.patch("base");
        for (std::size_t f = base.first; f < base.first + base.count; ++f) {
            for (const std::int32_t i : made.mesh.faces[f]) {
                const Vec3 p = made.mesh.points[static_cast<std::size_t>(i)];
                low = p.z < low.z ? p : low;
            }
        }
        return low;
    };
    const BodyShape shape = evie("ellipse");
    EXPECT_LT(lowest(make_block_mesh(shape, over(0.005, 2 * degree))).x, -0.06);
    EXPECT_GT(lowest(make_block_mesh(shape, over(0.005, -2 * degree))).x, 0.06);
    const BlockMesh rolled = make_block_mesh(shape, over(0.005, 0, MeshDensity::coarse, 2 * degree));
    EXPECT_LT(lowest(rolled).y, -0.04);
    EXPECT_NEAR(rolled.smallest_clearance, 0.005 - 0.0503 * std::sin(2 * degree), 2e-5);
}

TEST(BlockMesh, WholeIsTwiceTheHalf) {
    BlockMeshOptions options = over(0.005, 1 * degree);
    const BlockMesh half = make_block_mesh(evie("rectangle_bump1"), options);
    options.half = false;
    const BlockMesh whole = make_block_mesh(evie("rectangle_bump1"), options);
    EXPECT_EQ(whole.quality.cells, 2 * half.quality.cells);
    EXPECT_NEAR(whole.quality.volume, 2 * half.quality.volume, 1e-12);
    EXPECT_NEAR(whole.quality.largest_skewness, half.quality.largest_skewness, 1e-6);
    for (const auto& patch : whole.mesh.patches) {
        EXPECT_NE(patch.name, "symmetry");
    }
}

/// A plate of the tail, per test: two sides in the plane of the ellipsoid's middle, which turns with the body.
TEST(BlockMesh, ATailPlateHasTwoSidesAndTurnsWithTheBody) {
    for (const auto& [chord, angle, inner] : {std::tuple{20, 90, 0}, {50, 60, 0}, {80, 30, 0}, {90, 90, 40}}) {
        for (const char* more : {"", "base_offset = \"-15 mm\"\nbase_pitch = \"-1 deg\"\n"}) {
            const BodyShape shape = evie_with(more + std::string("[tail_plate]\nchord = \"") + std::to_string(chord) +
                                              " mm\"\nhalf_angle = \"" + std::to_string(angle) +
                                              " deg\"\ninner_angle = \"" + std::to_string(inner) + " deg\"\n");
            for (const double pitch : {-2 * degree, 0.0, 2 * degree}) {
                SCOPED_TRACE(std::to_string(chord) + " mm, " + std::to_string(angle) + " deg, " + more +
                             std::to_string(pitch));
                const BlockMesh made = make_block_mesh(shape, over(0.006, pitch, MeshDensity::draft));
                EXPECT_EQ(fault_of(made.quality), "");
                EXPECT_THAT(made.walls, testing::Contains("tail_plate"));
                const auto& patch = made.mesh.patch("tail_plate");
                const FaceSums sums = sums_over(made.mesh, patch);
                EXPECT_NEAR(norm(sums.area), 0, 1e-12);
                EXPECT_NEAR(sums.size, made.tail_plate_area, 1e-6 * sums.size);  // half of it, twice
                EXPECT_NEAR(made.tail_plate_area / tail_plate_area(shape), 1, 0.12);
                const double depth = shape.base_depth();
                const auto place = [&](double x, double y) { return placed({x, y, depth}, {0.006, pitch, 0}); };
                const Vec3 normal = unit(cross(place(1, 0) - place(0, 0), place(0, 1) - place(0, 0)));
                double last = 0;
                for (std::size_t at = patch.first; at < patch.first + patch.count; ++at) {
                    for (const auto p : made.mesh.faces[at]) {
                        const Vec3 q = made.mesh.points[static_cast<std::size_t>(p)] - place(-base_centre(shape), 0);
                        EXPECT_NEAR(dot(q, normal), 0, 1e-6);
                        last = std::max(last, norm(q));
                    }
                }
                EXPECT_NEAR(last, inner > 0 ? last : 0.1016 + 1e-3 * chord, 1e-6);
            }
        }
    }
    // The water is the same as without it, and the body's surface too.
    const auto with = make_block_mesh(evie_with("[tail_plate]\nchord = \"50 mm\"\n"), over(0.005));
    const auto without = make_block_mesh(evie_with("[tail_plate]\nchord = \"0 mm\"\n"), over(0.005));
    EXPECT_EQ(without.quality.cells, make_block_mesh(evie("ellipse"), over(0.005)).quality.cells);
    EXPECT_NEAR(body_volume(with), body_volume(without), 2e-3 * body_volume(without));
    EXPECT_GT(with.wall_units_mean, 0.3);
    EXPECT_LT(with.wall_units_mean, 1.5);
    // Another mesher has none, and says so; so does a body whose base lies near its middle.
    const core::TemporaryFolder folder;
    FlowOptions snappy;
    snappy.placement.gap = 0.005;
    snappy.mesher = CaseMesher::snappy;
    EXPECT_THROW(write_openfoam_case(evie_with("[tail_plate]\nchord = \"50 mm\"\n"), snappy, folder.path() / "case"),
                 core::InputError);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "case"));
    EXPECT_THROW(make_block_mesh(parse_shape("[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 "
                                             "mm\"\nbase_cut = 0.2\n[tail_plate]\nchord = \"50 mm\"\n"),
                                 over(0.005)),
                 core::InputError);
}

TEST(BlockMesh, SaysWhyThereIsNone) {
    const auto kind_of = [](const BodyShape& shape, const BlockMeshOptions& options) -> std::string {
        try {
            make_block_mesh(shape, options);
        } catch (const core::InputError& error) {
            return error.kind();
        }
        return "none";
    };
    const BodyShape shape = evie("ellipse");
    EXPECT_EQ(kind_of(shape, over(0.005, 6 * degree)), "contact");
    EXPECT_EQ(kind_of(shape, over(0)), "range");
    BlockMeshOptions rolled = over(0.005, 0, MeshDensity::coarse, 1 * degree);
    rolled.half = true;
    EXPECT_EQ(kind_of(shape, rolled), "symmetry");
    EXPECT_EQ(kind_of(evie_with("[nozzle]\ndiameter = \"5 mm\"\nposition = 0.95\n"), over(0.005)), "mesh");
    BlockMeshOptions still = over(0.005);
    still.speed = 0;
    EXPECT_EQ(kind_of(shape, still), "range");
    core::Progress stopped;
    stopped.cancel();
    EXPECT_THROW(make_block_mesh(shape, over(0.005), stopped), core::Cancelled);
}

TEST(BlockMesh, ACaseNamesEveryPatchInEveryField) {
    const core::TemporaryFolder folder;
    FlowOptions options;
    options.placement = {0.004, 0, 1 * degree};
    options.half = false;
    options.mesh_density = MeshDensity::coarse;
    options.speed = 1;
    const BlockCase made = write_block_case(evie("rectangle_bump1"), options, folder.path() / "case");
    for (const char* field : {"U", "p", "k", "omega", "nut"}) {
        const std::string text = core::read_file(folder.path() / "case/0" / field);
        for (const auto& patch : made.mesh.mesh.patches) {
            EXPECT_THAT(text, testing::HasSubstr("    " + patch.name + " {")) << field;
        }
    }
    EXPECT_THAT(core::read_file(folder.path() / "case/0/U"), testing::HasSubstr("uniform (-1 0 0)"));
    EXPECT_THAT(core::read_file(folder.path() / "case/system/controlDict"),
                testing::HasSubstr("patches (base hull protrusion)"));
    EXPECT_THROW(write_block_case(evie("rectangle_bump1"), options, folder.path() / "case"), core::InputError);
    // Twice as fast: the first cells are about half as thick.
    const BlockMesh slow = make_block_mesh(evie("rectangle_bump1"), over(0.004));
    EXPECT_NEAR(made.mesh.quality.wall_distance_mean / slow.quality.wall_distance_mean, std::pow(0.5, 0.9), 0.05);
}

TEST(BlockMesh, AJetComesOutOfTheNozzleAndOfNoBodyWithoutOne) {
    const core::TemporaryFolder folder;
    FlowOptions options;
    options.placement = {0.005, 0, 0};
    options.mesh_density = MeshDensity::coarse;
    options.jet_flow = 50e-6;
    write_block_case(evie_with("[nozzle]\ndiameter = \"5 mm\"\ndepth = \"5 mm\"\n"), options, folder.path() / "case");
    EXPECT_THAT(core::read_file(folder.path() / "case/0/U"),
                testing::HasSubstr("nozzle { type flowRateInletVelocity; volumetricFlowRate 2.5e-05;"));  // of the half
    EXPECT_THAT(core::read_file(folder.path() / "case/constant/polyMesh/boundary"),
                testing::HasSubstr("nozzle\n    {\n        type patch;"));
    EXPECT_THROW(write_block_case(evie("ellipse"), options, folder.path() / "none"), core::InputError);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "none"));
}

/// What checkMesh says of a mesh: a foreign reader and a second computation.
TEST(BlockMesh, OpenFoamFindsWhatWeFind) {
    if (!std::filesystem::exists("/usr/bin/checkMesh")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not installed (Debian: apt install openfoam)";
    }
    const auto number = [](const std::string& text, const std::string& pattern) {
        std::smatch found;
        return std::regex_search(text, found, std::regex(pattern)) ? core::parse_number(found[1].str()).value_or(-1)
                                                                   : -1;
    };
    auto bodies = family();
    bodies.emplace_back("tail plate", evie_with("[tail_plate]\nchord = \"50 mm\"\n"));
    for (const auto& [name, shape] : bodies) {
        SCOPED_TRACE(name);
        const bool whole = name == "all of it";
        const core::TemporaryFolder folder;
        FlowOptions options;
        options.placement = {0.006, 1 * degree, whole ? 1 * degree : 0};
        options.half = !whole;
        options.mesh_density = MeshDensity::coarse;
        const BlockMesh made = write_block_case(shape, options, folder.path() / "case").mesh;
        const auto run = test::run_program("/usr/bin/checkMesh", {}, folder.path() / "case",
                                           {{"WM_PROJECT_DIR", "/usr/share/openfoam"}});
        const std::string& text = run.output;
        EXPECT_THAT(text, testing::HasSubstr("Mesh OK."));
        EXPECT_THAT(text, testing::HasSubstr("Upper triangular ordering OK."));
        EXPECT_EQ(number(text, "cells: +([0-9]+)"), static_cast<double>(made.quality.cells));
        EXPECT_EQ(number(text, "hexahedra: +([0-9]+)"), static_cast<double>(made.quality.cells));
        EXPECT_NEAR(number(text, "non-orthogonality Max: ([0-9.e+-]+)"),
                    made.quality.largest_non_orthogonality / degree, 1e-3);
        EXPECT_NEAR(number(text, "non-orthogonality Max: [0-9.e+-]+ average: ([0-9.e+-]+)"),
                    made.quality.mean_non_orthogonality / degree, 1e-3);
        EXPECT_NEAR(number(text, "skewness = ([0-9.e+-]+)"), made.quality.largest_skewness, 1e-4);
        EXPECT_NEAR(number(text, "Total volume = ([0-9.e+-]+[0-9])"), made.quality.volume, 1e-5);
        EXPECT_NEAR(number(text, "Min volume = ([0-9.e+-]+[0-9])") / made.quality.smallest_volume, 1, 1e-4);
    }
}

}  // namespace
}  // namespace underbody::geometry
