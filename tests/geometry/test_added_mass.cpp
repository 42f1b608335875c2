// Added mass against Lamb's closed forms, the wall series, the thin film, and itself.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/certificate.h"
#include "geometry/body/mass_properties.h"
#include "geometry/water/added_mass.h"
#include "geometry/water/ellipsoid_added_mass.h"
#include "geometry/water/panel_mesh.h"
#include "geometry/water/source_panels.h"
#include "tests/geometry/ellipsoid_surface.h"

namespace underbody::geometry {
namespace {

constexpr double pi = std::numbers::pi;

TEST(EllipsoidAddedMass, AgreesWithTheOracles) {
    const EllipsoidAddedMass sphere = ellipsoid_added_mass(1, 1, 1);
    EXPECT_NEAR(sphere.translation[0] / sphere.volume, 0.5, 1e-12);
    EXPECT_EQ(sphere.rotation[0], 0);
    const EllipsoidAddedMass prolate = ellipsoid_added_mass(2, 1, 1);
    EXPECT_NEAR(prolate.translation[0] / prolate.volume, 0.21001505, 1e-8);
    EXPECT_NEAR(prolate.translation[1] / prolate.volume, 0.70421043, 1e-8);
    EXPECT_NEAR(prolate.rotation[1] / prolate.volume, 0.23942389, 1e-8);
    const EllipsoidAddedMass evie = ellipsoid_added_mass(0.1016, 0.076, 0.0725);
    EXPECT_NEAR(evie.integral[0], 0.50811235, 1e-8);
    EXPECT_NEAR(evie.integral[1], 0.72558138, 1e-8);
    EXPECT_NEAR(evie.integral[2], 0.76630627, 1e-8);
    EXPECT_NEAR(evie.integral[0] + evie.integral[1] + evie.integral[2], 2, 1e-14);
    EXPECT_NEAR(1000 * evie.translation[0], 0.79865194, 1e-8);
    EXPECT_NEAR(1000 * evie.translation[1], 1.335082, 1e-6);
    EXPECT_NEAR(1000 * evie.translation[2], 1.4565619, 1e-7);
    EXPECT_NEAR(1000 * evie.rotation[0], 8.7418652e-6, 1e-12);
    EXPECT_NEAR(1000 * evie.rotation[1], 5.086667e-4, 1e-10);
    EXPECT_NEAR(1000 * evie.rotation[2], 3.7700395e-4, 1e-11);
    const EllipsoidAddedMass cylinder = ellipsoid_added_mass(1000, 2, 1);
    EXPECT_NEAR(cylinder.translation[1] / cylinder.volume, 0.5, 2e-4);
    EXPECT_NEAR(cylinder.translation[2] / cylinder.volume, 2.0, 2e-4);
    EXPECT_THROW(ellipsoid_added_mass(1, -1, 1), core::InputError);
}

TEST(SourcePanel, HasThePotentialAndGradientOfItsTriangle) {
    const Vec3 a{0, 0, 0}, b{1, 0.1, 0}, c{0.3, 0.8, 0.2};
    const SourcePanel panel(a, b, c);
    const auto by_quadrature = [&](const Vec3& x) {
        const int n = 400;
        double sum = 0;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; i + j < n; ++j) {
                const auto at = [&](double u, double v) { return a + u * (b - a) + v * (c - a); };
                sum += 0.5 / distance(x, at((i + 1.0 / 3) / n, (j + 1.0 / 3) / n));
                if (i + j + 1 < n) {
                    sum += 0.5 / distance(x, at((i + 2.0 / 3) / n, (j + 2.0 / 3) / n));
                }
            }
        }
        return sum * 2 * panel.area() / (n * n);
    };
    for (const Vec3& x :
         {Vec3{0.4, 0.3, 0.5}, Vec3{-0.5, 0.2, -0.1}, Vec3{1.5, 1, 0.3}, Vec3{4, -3, 5}, Vec3{0.4, 0.3, -0.2}}) {
        EXPECT_NEAR(panel.potential(x) / by_quadrature(x), 1, 2e-4);
        const double h = 1e-5;
        const Vec3 g = panel.gradient(x);
        const Vec3 difference{(panel.potential(x + Vec3{h, 0, 0}) - panel.potential(x - Vec3{h, 0, 0})) / (2 * h),
                              (panel.potential(x + Vec3{0, h, 0}) - panel.potential(x - Vec3{0, h, 0})) / (2 * h),
                              (panel.potential(x + Vec3{0, 0, h}) - panel.potential(x - Vec3{0, 0, h})) / (2 * h)};
        EXPECT_LT(distance(g, difference), 1e-6 * norm(g) + 1e-8);
    }
    EXPECT_NEAR(dot(panel.gradient(panel.centre() + 1e-9 * panel.normal()), panel.normal()), -2 * pi, 1e-6);
}

double error_of_ellipsoid(std::size_t panels, Matrix6* matrix = nullptr) {
    const EllipsoidAddedMass exact = ellipsoid_added_mass(0.1016, 0.076, 0.0725);
    AddedMassOptions options;
    options.reference = Vec3{};
    const AddedMass mass = added_mass(ellipsoid_surface(0.1016, 0.076, 0.0725, panels), options);
    double error = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        error = std::max(error, std::abs(mass.matrix[k][k] / (core::default_water_density * exact.translation[k]) - 1));
    }
    if (matrix != nullptr) {
        *matrix = mass.matrix;
    }
    return error;
}

TEST(AddedMass, ConvergesToLambAtSecondOrder) {
    Matrix6 matrix{};
    const double coarse = error_of_ellipsoid(500), fine = error_of_ellipsoid(2000, &matrix);
    EXPECT_LT(fine, 0.005) << "0.5 % at 2000 panels";
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.25) << "observed order in the edge length";
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_NEAR(matrix[i][j], 0, 1e-4 * std::sqrt(matrix[i][i] * matrix[j][j]))
                << "an ellipsoid couples nothing";
        }
    }
}

TEST(AddedMass, HasTheLeadingTermsOfASphereNearAWall) {
    const double radius = 0.1, half = 500 * 4.0 / 3 * pi * radius * radius * radius;
    for (const double ratio : {2.0, 3.0, 5.0}) {
        AddedMassOptions options;
        options.reference = Vec3{};
        options.placement = Placement{ratio * radius, 0, 0};
        const AddedMass mass = added_mass(ellipsoid_surface(radius, radius, radius, 2400), options);
        const double cube = 1 / (ratio * ratio * ratio);
        EXPECT_NEAR(mass.matrix[2][2] / half / (1 + 3.0 / 8 * cube), 1, 0.01) << "H/R = " << ratio;
        EXPECT_NEAR(mass.matrix[0][0] / half / (1 + 3.0 / 16 * cube), 1, 0.01) << "H/R = " << ratio;
        EXPECT_NEAR(mass.matrix[1][1], mass.matrix[0][0], 1e-3 * half);
    }
}

TEST(AddedMass, GrowsLikeTheThinFilmTowardTheGround) {
    // Between two small gaps the difference is that of rho G / h (Stefan's film without viscosity) to within its edge
    // effects.
    const BodyShape evie;
    const BodyShape::BaseExtent extent = evie.base_extent();
    const double a = extent.nose, b = extent.half_width, film = pi * std::pow(a * b, 3) / (4 * (a * a + b * b));
    const auto heave = [&](double gap) {
        AddedMassOptions options;
        options.placement = Placement{gap, 0, 0};
        return added_mass(evie, 1200, options, false).matrix[2][2];
    };
    const double difference = heave(0.001) - heave(0.002);
    EXPECT_NEAR(difference / (core::default_water_density * film * (1 / 0.001 - 1 / 0.002)), 1, 0.25);
}

TEST(AddedMass, ExtrapolationTakesOutMostOfTheError) {
    const BodyShape evie;
    const AddedMass reference = added_mass(evie, 3600), plain = added_mass(evie, 1200, {}, false),
                    better = added_mass(evie, 1200);
    const double plain_error = std::abs(plain.matrix[2][2] / reference.matrix[2][2] - 1);
    const double better_error = std::abs(better.matrix[2][2] / reference.matrix[2][2] - 1);
    EXPECT_LT(better_error, 0.3 * plain_error);
    EXPECT_LT(better_error, 2e-3);
}

TEST(AddedMass, DoesNotDependOnTheSymmetryItUses) {
    const BodyShape evie;
    SurfaceOptions surface;
    surface.triangles = 700;
    SurfaceMesh mesh = make_surface(evie, surface);
    AddedMassOptions options;
    options.placement = Placement{0.02, 0.05, 0};
    const AddedMass halves = added_mass(mesh, options);
    std::swap(mesh.triangles.front(), mesh.triangles.back());  // same surface, but no longer seen to be symmetric
    std::swap(mesh.patch.front(), mesh.patch.back());
    const AddedMass whole = added_mass(mesh, options);
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
            EXPECT_NEAR(halves.matrix[i][j], whole.matrix[i][j],
                        2e-4 * std::sqrt(whole.matrix[i][i] * whole.matrix[j][j]));
        }
    }
    EXPECT_GT(std::abs(halves.matrix[0][2]), 1e-3) << "pitched over the ground, surge and heave are coupled";
}

TEST(AddedMass, MovesToAnotherReferencePointAsRigidBodiesDo) {
    SurfaceOptions surface;
    surface.triangles = 600;
    const SurfaceMesh mesh = make_surface(BodyShape{}, surface);
    AddedMassOptions options;
    options.reference = Vec3{0, 0, 0.05};
    const AddedMass here = added_mass(mesh, options);
    options.reference = Vec3{0.03, 0.01, -0.02};
    const AddedMass there = added_mass(mesh, options), by_formula = moved(here, *options.reference);
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
            EXPECT_NEAR(there.matrix[i][j], by_formula.matrix[i][j],
                        2e-3 * std::sqrt(there.matrix[i][i] * there.matrix[j][j]) + 1e-12);
        }
    }
}

TEST(PanelMesh, LiesOnTheSurfaceAndKeepsItsSharpEdges) {
    SurfaceOptions surface;
    surface.triangles = 12000;
    BodyShape shape;
    shape.base = BaseKind::rectangle;
    shape.protrusion = Protrusion{};
    const SurfaceMesh mesh = make_surface(shape, surface);
    PanelOptions options;
    options.panels = 2500;
    const PanelMesh panels = panel_mesh(mesh, options);
    const Certificate certificate = certify(panels.mesh);
    EXPECT_TRUE(certificate.passed());
    EXPECT_GT(certificate.smallest_angle, 4 * pi / 180);
    EXPECT_NEAR(static_cast<double>(panels.mesh.triangles.size()), 2500, 500);
    EXPECT_EQ(panels.mesh.patch_names, mesh.patch_names);
    for (const char* patch : {"base", "hull"}) {
        EXPECT_NEAR(area(patch_of(panels.mesh, patch)) / area(patch_of(mesh, patch)), 1, 0.02) << patch;
    }
    EXPECT_NEAR(area(patch_of(panels.mesh, "protrusion")) / area(patch_of(mesh, "protrusion")), 1, 0.15)
        << "a bump of two panels' length";
    EXPECT_LT(panels.distance_rms, 5e-4);
    EXPECT_LT(panels.distance_largest, 2e-3);
    EXPECT_LT(std::abs(panels.volume_error), 0.01);
    EXPECT_NEAR(mass_properties(panels.mesh).volume / mass_properties(mesh).volume - 1, panels.volume_error, 1e-12);
}

TEST(PanelMesh, SplitsASurfaceOfTooFewTrianglesAndLeavesItsShape) {
    SurfaceMesh box;  // 2 x 1 x 0.5 m
    for (int i = 0; i < 8; ++i) {
        box.points.push_back({i & 1 ? 2.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 0.5 : 0.0});
    }
    box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    box.patch.assign(12, 0);
    box.patch_names = {"hull"};
    PanelOptions options;
    options.panels = 800;
    const PanelMesh panels = panel_mesh(box, options);
    EXPECT_NEAR(static_cast<double>(panels.mesh.triangles.size()), 800, 160);
    EXPECT_LT(panels.distance_largest, 1e-12) << "its faces are flat and its edges straight";
    EXPECT_NEAR(panels.volume_error, 0, 1e-12);
    EXPECT_GT(certify(panels.mesh).smallest_angle, 15 * pi / 180);
}

TEST(AddedMass, OfASurfaceOfManyTrianglesIsThatOfItsShape) {
    const SurfaceMesh many = ellipsoid_surface(0.1016, 0.076, 0.0725, 20000);
    AddedMassOptions options;
    options.reference = Vec3{};
    const EllipsoidAddedMass exact = ellipsoid_added_mass(0.1016, 0.076, 0.0725);
    const AddedMass free = added_mass(many, 1200, options);
    ASSERT_TRUE(free.fit);
    EXPECT_EQ(free.fit->triangles, many.triangles.size());
    EXPECT_LT(free.fit->distance_rms, 1e-3);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(free.matrix[k][k] / (core::default_water_density * exact.translation[k]), 1, 0.005)
            << "Lamb within 0.5 %";
    }
    const BodyShape evie;
    options.reference.reset();
    options.placement = Placement{0.005, 0, 0};
    const double by_shape = added_mass(evie, 1200, options).matrix[2][2];
    EXPECT_NEAR(added_mass(make_surface(evie), 1200, options).matrix[2][2] / by_shape, 1, 0.01);
}

TEST(AddedMass, RefusesABodyInTheGround) {
    AddedMassOptions options;
    options.placement = Placement{0.001, 0.1, 0};
    try {
        added_mass(BodyShape{}, 600, options);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), "contact");
        EXPECT_THAT(error.hint(), testing::HasSubstr("nearest allowed gap"));
    }
}

}  // namespace
}  // namespace underbody::geometry
