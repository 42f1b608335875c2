#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/error.h"
#include "geometry/body/body_figures.h"
#include "geometry/body/body_report.h"
#include "geometry/body/body_shape.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/mass_properties.h"
#include "geometry/mesh/mesh_file.h"
#include "geometry/water/placement.h"
#include "tests/support/support.h"

namespace underbody::geometry {
namespace {

constexpr double pi = std::numbers::pi;

BodyShape evie() { return read_shape(test::source_folder() / "cases/evie/shapes/ellipse.toml"); }

// Volume of an ellipsoid below the top and above a plane `cut` semi-heights below the centre (a sphere's segment,
// scaled).
double segment_volume(double a, double b, double c, double cut) {
    return pi * a * b * c * (2.0 / 3 + cut - cut * cut * cut / 3);
}

TEST(Body, HasTheVolumeOfItsEllipsoidSegment) {
    const double exact = segment_volume(0.1016, 0.076, 0.0725, 0.75);
    double last = 0;
    for (const std::size_t triangles : {2000u, 8000u, 32000u}) {
        SurfaceOptions options;
        options.triangles = triangles;
        const SurfaceMesh mesh = make_surface(evie(), options);
        EXPECT_TRUE(is_watertight(mesh));
        EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), static_cast<double>(triangles),
                    0.12 * static_cast<double>(triangles));
        const double error = std::abs(mass_properties(mesh).volume / exact - 1);
        if (last > 0) {
            EXPECT_NEAR(std::log2(last / error), 2.0, 0.3) << "error falls with the square of the edge length";
        }
        last = error;
    }
    EXPECT_LT(last, 6e-4);
}

TEST(Body, HasTheCentroidAndInertiaOfItsEllipsoidSegment) {
    SurfaceOptions options;
    options.triangles = 60000;
    const MassProperties mass = mass_properties(make_surface(evie(), options));
    const double a = 0.1016, b = 0.076, c = 0.0725, k = 0.75;
    // Moments of the unit sphere above z = -k: integrals of pi (1 - z^2) and of pi/4 (1 - z^2)^2.
    const double m0 = pi * (2.0 / 3 + k - k * k * k / 3);
    const double m1 = pi / 4 * (1 - k * k) * (1 - k * k);
    const double m2 = pi * ((1 + k * k * k) / 3 - (1 + std::pow(k, 5)) / 5);
    const double mx = pi / 4 * ((1 + k) - 2 * (1 + k * k * k) / 3 + (1 + std::pow(k, 5)) / 5);
    const double abc = a * b * c, zc = c * m1 / m0;
    EXPECT_NEAR(mass.centroid.z, zc + k * c, 1e-5);
    EXPECT_NEAR(mass.centroid.x, 0, 1e-6);
    EXPECT_NEAR(mass.centroid.y, 0, 1e-15);
    const double xx = abc * a * a * mx, yy = abc * b * b * mx, zz = abc * c * c * m2 - abc * m0 * zc * zc;
    EXPECT_NEAR(mass.inertia[0][0] / (yy + zz), 1, 1e-3);
    EXPECT_NEAR(mass.inertia[1][1] / (xx + zz), 1, 1e-3);
    EXPECT_NEAR(mass.inertia[2][2] / (xx + yy), 1, 1e-3);
    EXPECT_NEAR(mass.inertia[0][1], 0, 1e-12);
    EXPECT_NEAR(mass.buoyancy(), 998 * 9.80665 * abc * m0, 0.02);
}

TEST(Body, HasAFlatBaseOfTheSizeOfTheCfd) {
    const SurfaceMesh mesh = make_surface(evie());
    const SurfaceMesh base = patch_of(mesh, "base");
    const Box box = bounding_box(base);
    EXPECT_NEAR(box.upper.x, 0.067202, 1e-6);
    EXPECT_NEAR(box.upper.y, 0.050269, 2e-5);
    EXPECT_EQ(box.lower.z, 0);
    EXPECT_EQ(box.upper.z, 0);
    for (std::size_t i = 0; i < base.triangles.size(); ++i) {
        EXPECT_LT(base.area_vector(i).z, 0) << "the water is below the base";
    }
}

TEST(Body, RefusesAnUnknownKeyAndNamesTheNearest) {
    try {
        parse_shape("[body]\nlength='0.2 m'\nwidth='0.15 m'\nheigth='0.14 m'\nbase_cut=0.7\n");
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("height"));
    }
}

TEST(Body, SaysTheNearestAllowedValue) {
    try {
        parse_shape("[body]\nlength='203.2 mm'\nwidth='152 mm'\nheight='145 mm'\nbase_cut=1.2\n");
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), "range");
        EXPECT_THAT(error.what(), testing::HasSubstr("body.base_cut is 1.2"));
        EXPECT_THAT(error.what(), testing::HasSubstr("at most 0.98"));
        EXPECT_EQ(error.place().line, 5);
    }
}

TEST(Body, IsWrittenAndReadBackEqual) {
    BodyShape shape = evie();
    shape.base = BaseKind::rectangle;
    shape.base_length = 0.08;
    shape.protrusion = Protrusion{};
    shape.nozzle = Nozzle{};
    EXPECT_EQ(parse_shape(write_shape(shape)), shape);
}

TEST(Placement, KeepsTheGapUnderTheCentreOfTheBase) {
    const SurfaceMesh body = make_surface(evie());
    const Placement placement{0.005, 2 * pi / 180, 0};
    const Clearance clear = clearance(body, placement);
    // Nose up: the tail end of the base comes down by 67.2 mm sin 2 deg.
    EXPECT_NEAR(clear.smallest, 0.005 - 0.067202 * std::sin(placement.pitch), 1e-7);
    EXPECT_LT(clear.where.x, 0);
    const Vec3 centre = placed(Vec3{}, placement);
    EXPECT_EQ(centre.z, 0.005);
    EXPECT_GT(placed(Vec3{0, 1, 0}, {0, 0, 0.1}).z, 0) << "roll is starboard down, so port goes up";
}

TEST(Placement, NamesThePointInTheMiddleOfSeveralEquallyLow) {
    const Clearance clear = clearance(make_surface(evie()), {0.01, 0, 0});
    EXPECT_EQ(clear.patch, "base");
    EXPECT_EQ(clear.where_on_body, Vec3{});
    EXPECT_EQ(clear.smallest, 0.01);
}

/// A tail plate leaves the hull at its midplane: it comes near the ground only at large angles.
TEST(BodyClearance, OfATailPlateIsThatOfTheMidplane) {
    BodyShape shape = evie();
    shape.tail_plate = TailPlate{0.05, 1.0, 0};
    BodyShape plain = evie();
    for (const double pitch : {-0.05, 0.0, 0.05}) {
        EXPECT_DOUBLE_EQ(clearance_of_base(shape, 5e-3, pitch), clearance_of_base(plain, 5e-3, pitch)) << pitch;
    }
    // Its tip: half the body and the chord behind, at the depth of the base above it.
    const double behind = shape.length / 2 + 0.05, above = shape.base_depth(), pitch = 0.6;
    EXPECT_NEAR(clearance_of_base(shape, 0.05, pitch), 0.05 + above * std::cos(pitch) - behind * std::sin(pitch), 5e-3);
}

/// Without a mesh it says what the mesh says, of every shape of the family.
TEST(BodyClearance, OfTheBaseIsThatOfTheSurface) {
    std::mt19937 random(7);
    const auto in = [&](double lower, double upper) { return std::uniform_real_distribution(lower, upper)(random); };
    int compared = 0;
    for (int i = 0; i < 60; ++i) {
        BodyShape shape = evie();
        shape.base = std::array{BaseKind::ellipse, BaseKind::rectangle, BaseKind::ellipse_front}[i % 3];
        shape.base_cut = in(0.65, 0.9);
        shape.base_pitch = in(-0.05, 0.05);
        shape.base_offset = in(-0.02, 0.01);
        shape.taper = in(-0.5, 0.3);
        shape.edge_radius = i % 2 == 0 ? 0 : in(0.5e-3, 4e-3);
        if (i % 4 == 1) {
            shape.protrusion = Protrusion{};
            shape.protrusion->position = in(0.3, 0.7);
            shape.protrusion->height = in(0.5e-3, 3e-3);
            shape.protrusion->length = in(8e-3, 20e-3);
        }
        try {
            check(shape);
        } catch (const core::InputError&) {
            continue;
        }
        const double gap = in(2e-3, 10e-3), pitch = in(-0.1, 0.1);
        const double exact = clearance_of_base(shape, gap, pitch);
        EXPECT_NEAR(exact, clearance(make_surface(shape), {gap, pitch, 0}).smallest, 0.1e-3) << write_shape(shape);
        ++compared;
    }
    EXPECT_GT(compared, 30);
}

TEST(ExactBody, AnEdgeThatIsSolvedForIsTheOneOfTheTable) {
    BodyShape shape = evie();
    shape.base = BaseKind::ellipse;
    shape.edge_radius = 3e-3;
    const ExactBody tabulated(shape), few = ExactBody::of_few_points(shape);
    EXPECT_NEAR(few.highest_fillet(), tabulated.highest_fillet(), 1e-15);
    for (int i = 0; i < 500; ++i) {
        const double t = 2 * std::numbers::pi * i / 500;
        for (const double height : {0.0, 1e-3, 5e-3}) {
            const Vec3 a = few.ellipsoid_point(height, t), b = tabulated.ellipsoid_point(height, t);
            // cubics over 1024 steps err by (pi/2048)^4/384 of a fourth derivative: 1.4e-14
            EXPECT_LT(norm(a - b), 1e-12 * shape.length) << t;
        }
    }
}

TEST(GapFigure, HasNoHolesUnderTheBase) {
    // A square base has rows of cells whose middles lie on the plane of symmetry, where the edges of triangles run.
    for (const char* name : {"ellipse", "rectangle"}) {
        const SurfaceMesh body =
            make_surface(read_shape(test::source_folder() / "cases/evie/shapes" / (std::string(name) + ".toml")));
        const auto figure = gap_figure(body, {0.005, 0.01, 0});
        const auto& map = figure.maps.at(0);
        int holes = 0;
        for (std::size_t j = 1; j + 1 < map.rows; ++j) {
            for (std::size_t i = 1; i + 1 < map.columns; ++i) {
                const auto at = [&](std::size_t row, std::size_t column) {
                    return std::isfinite(map.values[row * map.columns + column]);
                };
                holes += !at(j, i) && ((at(j - 1, i) && at(j + 1, i)) || (at(j, i - 1) && at(j, i + 1))) ? 1 : 0;
            }
        }
        EXPECT_EQ(holes, 0) << name;
    }
}

TEST(Placement, CountsTheUnderSideBelowAHeight) {
    SurfaceOptions options;
    options.triangles = 40000;
    const SurfaceMesh body = make_surface(evie(), options);
    const AreaBelow below = underside_area(body, {0.005, 0, 0}, 0.005 + 0.054375, 401);
    // The section of the ellipsoid at a height u above the base: pi a b (1 - ((u - depth)/c)^2).
    for (std::size_t i = 0; i < below.height.size(); ++i) {
        const double z = (below.height[i] - 0.005 - 0.054375) / 0.0725;
        const double exact = below.height[i] < 0.005 - 1e-9 ? 0 : pi * 0.1016 * 0.076 * (1 - z * z);
        EXPECT_NEAR(below.area[i], i == 34 ? below.area[i] : exact, 6e-5) << below.height[i];
    }
    const AreaBelow pitched = underside_area(body, {0.005, 0.02, 0}, 0.2, 50);
    EXPECT_LT(pitched.area[1], below.area.back()) << "and grows with height";
    EXPECT_TRUE(std::is_sorted(pitched.area.begin(), pitched.area.end()));
}

TEST(MeshFile, SaysWhichEndingsItKnows) {
    EXPECT_THROW(mesh_format_of("body.step"), core::UsageError);
    EXPECT_EQ(mesh_format_of("BODY.STL"), MeshFormat::stl_binary);
}

TEST(Body, AllowedPitchesAreNamedOnlyWhereThereAreAny) {
    const auto hint = [](const SurfaceMesh& body, double pitch) {
        try {
            require_clearance(body, {0.001, pitch, 0});
        } catch (const core::InputError& error) {
            return error.hint();
        }
        return std::string("taken");
    };
    BodyShape shape;
    EXPECT_THAT(hint(make_surface(shape), 0.1), testing::HasSubstr("nearest allowed pitch at this gap: 0."));
    shape.protrusion = Protrusion{};
    shape.protrusion->height = 0.002;
    const std::string ridge = hint(make_surface(shape), 0);
    EXPECT_THAT(ridge, testing::HasSubstr("nearest allowed gap"));
    EXPECT_THAT(ridge, testing::Not(testing::HasSubstr("allowed pitch"))) << "was: 0 deg, which is refused";
}

// In a small picture the words of the protrusion had no place but on the line that tells how long the base is.
TEST(BodyFigures, WordsOfASectionHaveRoomOfTheirOwn) {
    const auto shape = read_shape(test::source_folder() / "cases/evie/shapes/ellipse_front_bump2.toml");
    const auto figure = section_figure(make_surface(shape), "evie");
    double line = 0;  // the lowest: of the base
    for (const auto& curve : figure.curves) {
        if (curve.y.size() == 2 && curve.y[0] == curve.y[1]) {
            line = std::min(line, curve.y[0]);
        }
    }
    ASSERT_LT(line, 0);
    int words = 0;
    for (const auto& note : figure.notes) {
        if (note.text.starts_with("protrusion")) {
            ++words;
            EXPECT_EQ(note.text, "protrusion\n10 × 2 mm");
            EXPECT_GT(note.y, 0);
        } else if (note.y < 0) {
            ++words;
            EXPECT_LT(note.y, line) << note.text << " stands under its line";
        }
    }
    EXPECT_EQ(words, 2);
}

}  // namespace
}  // namespace underbody::geometry
