// Volume, centroid and inertia of the exact body: against closed forms, and against meshes that converge to it.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/file.h"
#include "geometry/body/body_report.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/mesh/mesh_file.h"
#include "geometry/mesh/mesh_reader.h"
#include "tests/support/support.h"

namespace underbody::geometry {
namespace {

constexpr double pi = std::numbers::pi, degree = pi / 180;

BodyShape shipped(const std::string& name) {
    return read_shape(test::source_folder() / "cases/evie/shapes" / (name + ".toml"));
}

SurfaceMesh made(const BodyShape& shape, std::size_t triangles) {
    SurfaceOptions options;
    options.triangles = triangles;
    return make_surface(shape, options);
}

// Of the ellipsoid with semi-axes a, b, c above the plane `cut` semi-heights below its centre; z from that plane.
VolumeMoments segment(double a, double b, double c, double cut) {
    // Of the unit sphere above z = -cut: integrals of pi (1 - z^2) and of pi/4 (1 - z^2)^2.
    const double k = cut, m0 = pi * (2.0 / 3 + k - k * k * k / 3), m1 = pi / 4 * std::pow(1 - k * k, 2);
    const double m2 = pi * ((1 + k * k * k) / 3 - (1 + std::pow(k, 5)) / 5);
    const double mx = pi / 4 * ((1 + k) - 2 * (1 + k * k * k) / 3 + (1 + std::pow(k, 5)) / 5);
    const double abc = a * b * c, d = k * c;
    VolumeMoments m;
    m.one = abc * m0;
    m.z = abc * (c * m1 + d * m0);
    m.zz = abc * (c * c * m2 + 2 * d * c * m1 + d * d * m0);
    m.xx = abc * a * a * mx;
    m.yy = abc * b * b * mx;
    return m;
}

void expect_equal(const VolumeMoments& m, const VolumeMoments& e, double tolerance) {
    const double length = 0.1;
    EXPECT_NEAR(m.one / e.one, 1, tolerance);
    EXPECT_NEAR(m.x, e.x, tolerance * e.one * length);
    EXPECT_NEAR(m.z, e.z, tolerance * e.one * length);
    EXPECT_NEAR(m.xx / e.xx, 1, tolerance);
    EXPECT_NEAR(m.yy / e.yy, 1, tolerance);
    EXPECT_NEAR(m.zz / e.zz, 1, tolerance);
    EXPECT_NEAR(m.zx, e.zx, tolerance * e.one * length * length);
}

TEST(ExactMass, OfAnEllipsoidSegmentIsItsClosedForm) {
    for (const double cut : {0.1, 0.75, 0.97}) {
        BodyShape shape;
        shape.base_cut = cut;
        expect_equal(ExactBody(shape).moments(), segment(shape.length / 2, shape.width / 2, shape.height / 2, cut),
                     1e-9);
    }
}

TEST(ExactMass, OfAPitchedBaseIsItsClosedForm) {
    BodyShape shape;
    shape.base_pitch = 2 * degree;
    const double a = shape.length / 2, b = shape.width / 2, k = shape.base_cut, slope = std::tan(shape.base_pitch);
    const VolumeMoments level = segment(a, b, shape.height / 2, k), m = ExactBody(shape).moments();
    // The bend lifts a point of depth v (1 at the base, 0 at the midplane) by slope x v^2: it moves volume aft,
    // integral of x^2 d(slope v^2)/dz over the sections, whose x^2 is pi a^3 b/4 (1 - k^2 v^2)^2.
    const double moved = -2 * slope * pi * a * a * a * b / 4 * (1 - std::pow(1 - k * k, 3)) / (6 * k * k);
    EXPECT_NEAR(m.one / level.one, 1, 1e-9);
    EXPECT_NEAR(m.x / moved, 1, 1e-8);
    EXPECT_NEAR(m.xx / level.xx, 1, 1e-9);
}

TEST(ExactMass, OfABaseThatWasMovedIsItsClosedForm) {
    BodyShape shape;
    const VolumeMoments plain = ExactBody(shape).moments();
    shape.base_offset = -0.03;
    const double a = shape.length / 2, b = shape.width / 2, c = shape.height / 2, k = shape.base_cut;
    const VolumeMoments m = ExactBody(shape).moments();
    // Sections slide as they are, by the square of their depth v; x counts from the base, which goes all the way:
    // integral of (v^2 - 1) over the sections pi a b (1 - k^2 v^2) below the midplane, and the upper half.
    const double left_behind = pi * a * b * c * (k * (-2.0 / 3 + 2 * k * k / 15) - 2.0 / 3) * shape.base_offset;
    EXPECT_NEAR(m.one / plain.one, 1, 1e-12);
    EXPECT_NEAR(m.z / plain.z, 1, 1e-12);
    EXPECT_NEAR(m.x / left_behind, 1, 1e-9);
    EXPECT_NEAR(m.yy / plain.yy, 1, 1e-12);
}

TEST(ExactMass, OfRidgeAndBoreIsTheirClosedForm) {
    BodyShape shape;
    const VolumeMoments plain = ExactBody(shape).moments();
    shape.protrusion = Protrusion{0.5, 0.003, 0.012, ProtrusionProfile::sharp, 0, 0.05};
    shape.nozzle = Nozzle{0.006, 0.2, 0.01};
    const VolumeMoments m = ExactBody(shape).moments();
    // A roof with half a cone at either end, below the base; a cylinder out of the body.
    const double h = 0.003, half = 0.006, straight = 0.05 - 2 * half, r = 0.003, bore = pi * r * r * 0.01;
    const double roof = half * h * straight, cone = pi * half * half * h / 3;
    const double x = shape.base_x(0.2);
    EXPECT_NEAR(m.one - plain.one, roof + cone - bore, 1e-9 * plain.one);
    EXPECT_NEAR(m.z - plain.z, -roof * h / 3 - cone * h / 4 - bore * 0.005, 1e-9 * plain.one * 0.1);
    EXPECT_NEAR(m.x - plain.x, -bore * x, 1e-9 * plain.one * 0.1);
    EXPECT_NEAR(m.zx - plain.zx, -bore * x * 0.005, 1e-9 * plain.one * 0.01);
}

TEST(ExactMass, IsWhereTheMeshesOfEveryKindOfBodyConverge) {
    BodyShape all = shipped("ellipse_front_bump2");
    all.edge_radius = 0.004;
    all.protrusion->blend_radius = 0.003;
    all.nozzle = Nozzle{0.005, 0.5, 0.01};
    all.taper = 0.1;
    all.base_pitch = 1.5 * degree;
    BodyShape moved = shipped("ellipse");
    moved.base_offset = -0.03;
    moved.base_pitch = -2 * degree;
    moved.taper = -0.2;
    for (const BodyShape& shape : {shipped("rectangle"), all, moved}) {
        const SurfaceMesh coarse_mesh = made(shape, 15000), fine_mesh = made(shape, 60000);
        const MassProperties exact = mass_properties(ExactBody(shape), coarse_mesh);
        const MassProperties coarse = mass_properties(coarse_mesh), fine = mass_properties(fine_mesh);
        const auto expect_limit = [&](double c, double f, double e, double size) {
            // What is left falls to a quarter: the exact value lies where the two point to, within a third of the step.
            EXPECT_NEAR(f + (f - c) / 3, e, 0.35 * std::abs(f - c) + 1e-6 * size) << shape.name;
        };
        expect_limit(coarse.volume, fine.volume, exact.volume, exact.volume);
        expect_limit(coarse.centroid.x, fine.centroid.x, exact.centroid.x, 0.1);
        expect_limit(coarse.centroid.z, fine.centroid.z, exact.centroid.z, 0.1);
        for (std::size_t i = 0; i < 3; ++i) {
            expect_limit(coarse.inertia[i][i], fine.inertia[i][i], exact.inertia[i][i], exact.inertia[i][i]);
        }
        expect_limit(coarse.inertia[0][2], fine.inertia[0][2], exact.inertia[0][2], exact.inertia[0][0]);
    }
}

TEST(ExactMass, BuoyancyOfABodyDoesNotDependOnItsTriangles) {
    BodyOptions options;
    options.panels = 0;
    const auto file = test::source_folder() / "cases/evie/shapes/ellipse.toml";
    options.triangles = 2000;
    const Body coarse = read_body(file, options);
    options.triangles = 20000;
    const Body fine = read_body(file, options);
    const double exact = core::default_water_density * standard_gravity * segment(0.1016, 0.076, 0.0725, 0.75).one;
    EXPECT_NEAR(coarse.mass.buoyancy(), exact, 1e-9 * exact);  // was 157 mN low
    EXPECT_NEAR(fine.mass.buoyancy(), exact, 1e-9 * exact);    // was 17 mN low
    EXPECT_NEAR(coarse.outer_size().x, 0.2032, 1e-12);
    EXPECT_NEAR(coarse.outer_size().y, 0.152, 1e-12);
    EXPECT_NEAR(coarse.outer_size().z, 0.0725 * 1.75, 1e-12) << "of the cut body, not of the ellipsoid";
}

TEST(ExactMass, SaysHowMuchTheFacetsOfASurfaceFileLeaveOut) {
    const core::TemporaryFolder folder;
    for (const char* name : {"ellipse", "rectangle_bump2"}) {
        const BodyShape shape = shipped(name);
        const double exact = ExactBody(shape).volume();
        for (const std::size_t triangles : {3000u, 12000u}) {
            const auto file = folder.path() / "body.stl";
            write_mesh(made(shape, triangles), file);
            BodyOptions options;
            options.panels = 0;
            options.unit = "m";
            const Body body = read_body(file, options);
            const double missing = exact - body.mass.volume;
            EXPECT_GT(missing, 0);
            EXPECT_NEAR(body.volume_left_out / missing, 1, 0.12) << name << " " << triangles;
        }
    }
    // Plane faces leave nothing out.
    SurfaceMesh box;
    for (int i = 0; i < 8; ++i) {
        box.points.push_back({i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 1.0 : 0.0});
    }
    box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    box.patch.assign(12, 0);
    box.patch_names = {"box"};
    EXPECT_NEAR(mass_properties(box).volume, 1, 1e-15);
    EXPECT_NEAR(volume_left_out(box), 0, 1e-15);
}

}  // namespace
}  // namespace underbody::geometry
