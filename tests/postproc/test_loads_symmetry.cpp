// Loads of half models, plane and axisymmetric cases.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <cmath>

#include "postproc/loads/loads.h"
#include "tests/postproc/made_zones.h"

namespace underbody::postproc {
namespace {

using testing::HasSubstr;

TEST(Loads, OfAHalfModelAreThoseOfTheWhole) {
    const auto p = [](const Vector& x) { return 30 * x[0] - 200 * x[2] + 1000 * x[0] * x[2] + 40; };
    const auto whole = loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p)}), about({0.01, 0, -0.02}));
    for (const bool turned : {false, true}) {
        const auto half =
            loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, turned)}), about({0.01, 0, -0.02}, "y"));
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(half.total.force[k], whole.total.force[k], 1e-9);
            EXPECT_NEAR(half.total.moment[k], whole.total.moment[k], 1e-10);
        }
        EXPECT_NEAR(half.area, whole.area, 1e-9);
        EXPECT_LT(half.closure, 1e-9);
        // A reference beside the plane moves the moment by r x F.
        const auto beside =
            loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, turned)}), about({0.01, 0.5, -0.02}, "y"));
        EXPECT_NEAR(beside.total.moment[0], whole.total.moment[0] - 0.5 * whole.total.force[2], 1e-9);
    }
    const auto forgotten = loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, true)}), about({0.01, 0, -0.02}));
    EXPECT_NEAR(2 * forgotten.total.force[2], whole.total.force[2],
                1e-9);  // the sides are settled also without the plane
    ASSERT_FALSE(forgotten.problems.empty());
    EXPECT_THAT(forgotten.problems.back().message, HasSubstr("option 'symmetry y'"));
    EXPECT_GT(forgotten.closure, 0.1);
    EXPECT_THROW(loads(field_of({ellipsoid(20, {0.1, 0.1, 0.1}, p)}), about({}, "y")), core::InputError);
    // Nor is it half a body that is open elsewhere than at its plane.
    EXPECT_THROW(loads(field_of({ellipsoid(20, {0.1, 0.1, 0.1}, p, true)}), about({}, "y=-1")), core::InputError);
}

TEST(Loads, OfTheShearOnAHalfModelAreThoseOfTheWhole) {
    // What mirroring at y = 0 leaves as it is: along x and z even, along y odd.
    const auto shear = [](const Vector& x) {
        return Vector{3 + 20 * x[0] + x[1] * x[1], 40 * x[1], 5 - 30 * x[2] * x[0]};
    };
    const auto p = [](const Vector& x) { return 100 * x[2]; };
    const auto whole =
        loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, false, false, "hull", shear)}), about({0.01, 0, -0.02}));
    const auto half = loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, true, false, "hull", shear)}),
                            about({0.01, 0, -0.02}, "y"));
    ASSERT_GT(std::abs(whole.viscous.force[0]), 0.01);
    ASSERT_GT(std::abs(whole.viscous.moment[1]), 1e-4);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(half.viscous.force[k], whole.viscous.force[k], 1e-10);
        EXPECT_NEAR(half.viscous.moment[k], whole.viscous.moment[k], 1e-11);
    }
    // About another point: M' = M + (r - r') x F.
    const auto moved =
        loads(field_of({ellipsoid(30, {0.1, 0.08, 0.06}, p, false, false, "hull", shear)}), about({-0.3, 0.2, 0.5}));
    const Vector arm = {0.31, -0.2, -0.52};
    const Vector more = cross(arm, whole.total.force);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(moved.total.moment[k], whole.total.moment[k] + more[k], 1e-12);
    }
}

TEST(Loads, OfAWholeBodyAreNotDoubled) {
    LoadsOptions options = about({0, 0, 0}, "z");
    options.up = axis_from("+y");  // the plane lies along the vehicle
    try {
        (void)loads(box(false, false), options);
        ADD_FAILURE() << "a closed box passed for half of one";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(),
                    testing::AllOf(HasSubstr("closes without a mirror image"), HasSubstr("option 'symmetry z=0'")));
    }
    options.symmetry = "z=-1";
    EXPECT_NO_THROW((void)loads(box(false, false), options));
}

TEST(Loads, OfAHalfModelAcrossTheUpOrForwardAxisAreRefused) {
    const auto p = [](const Vector& x) { return 100 + 10 * x[2]; };
    const Field half = field_of({ellipsoid(12, {0.1, 0.08, 0.06}, p, true, false, "hull")});
    const auto refused = [&](const char* forward, const char* up) {
        LoadsOptions options = about({0, 0, 0}, "y");
        options.forward = axis_from(forward);
        options.up = axis_from(up);
        try {
            (void)loads(half, options);
        } catch (const core::UsageError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refused("+x", "-z"), "");
    EXPECT_THAT(refused("+x", "+y"),
                testing::AllOf(HasSubstr("every lift would be zero"), HasSubstr("option 'symmetry z'")));
    EXPECT_THAT(refused("-y", "+z"),
                testing::AllOf(HasSubstr("every drag would be zero"), HasSubstr("option 'symmetry x'")));
}

// It was advised to name a plane that is refused.
TEST(Loads, AdviseNoPlaneThatWouldBeRefused) {
    const auto p = [](const Vector& x) { return 100 + 10 * x[2]; };
    const Field half = field_of({ellipsoid(12, {0.1, 0.08, 0.06}, p, true, false, "hull")});
    LoadsOptions options = about({0, 0, 0}, "");
    options.forward = axis_from("+x");
    options.up = axis_from("-z");
    EXPECT_EQ(loads(half, options).cut_across, "y");
    options.up = axis_from("+y");
    EXPECT_EQ(loads(half, options).cut_across, "");
}

TEST(Loads, OfAPlaneCaseArePerMetreDepth) {
    // A circle of lines, p = -rho g y: buoyancy per metre is rho g times the polygon's area.
    constexpr int count = 90;
    for (const bool known : {true, false}) {
        Zone zone;
        zone.name = "cylinder";
        zone.kind = ZoneKind::wall;
        zone.normals_into_fluid = known;
        zone.surface = vtkSmartPointer<vtkPolyData>::New();
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        vtkNew<vtkCellArray> lines;
        vtkNew<vtkDoubleArray> pressure;
        pressure->SetName("pressure");
        for (int i = 0; i < count; ++i) {
            const double at = 2 * M_PI * i / count;
            const double next = 2 * M_PI * (i + 1) / count;
            points->InsertNextPoint(0.1 * std::cos(at), 0.1 * std::sin(at), 0);
            // z x t looks out of the circle when it is run through clockwise.
            lines->InsertNextCell({static_cast<vtkIdType>((i + 1) % count), static_cast<vtkIdType>(i)});
            pressure->InsertNextValue(-rho * g * 0.05 * (std::sin(at) + std::sin(next)));
        }
        zone.surface->SetPoints(points);
        zone.surface->SetLines(lines);
        zone.surface->GetCellData()->AddArray(pressure);
        zone.arrays = {{"pressure", "Pa", "SV_P", "", Location::faces, 1}};
        Field field = field_of({zone});
        field.dimension = 2;
        const auto result = loads(field, about({}));
        LoadsOptions aside = about({});
        aside.forward = {0, 1, 0};  // the default up leaves the plane: +x is what is left
        EXPECT_NEAR(loads(field, aside).named.drag_force, -result.named.lift_force, 1e-12);
        aside.forward = {0, 0, -1};
        EXPECT_THROW((void)loads(field, aside), core::UsageError);
        const double area = 0.5 * count * 0.01 * std::sin(2 * M_PI / count);
        EXPECT_NEAR(result.total.force[1], rho * g * area, 1e-9);
        EXPECT_NEAR(result.named.lift_force, rho * g * area, 1e-9);
        EXPECT_LT(result.closure, 1e-12);
        EXPECT_EQ(result.dimension, 2);
        EXPECT_EQ(result.values_from, "faces");
    }
}

/// A profile y(x) of lines from the tail to the nose, z x t looks out of it; node values.
Field profile(const std::vector<std::array<double, 2>>& places, const PointFunction& pressure, const Vector& shear,
              bool known) {
    Zone zone;
    zone.name = "body";
    zone.kind = ZoneKind::wall;
    zone.normals_into_fluid = known;
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkDoubleArray> values;
    values->SetName("pressure");
    vtkNew<vtkDoubleArray> tractions;
    tractions->SetName("wall_shear");
    tractions->SetNumberOfComponents(3);
    for (std::size_t i = 0; i < places.size(); ++i) {
        points->InsertNextPoint(places[i][0], places[i][1], 0);
        values->InsertNextValue(pressure({places[i][0], places[i][1], 0}));
        tractions->InsertNextTuple(shear.data());
        if (i > 0) {
            const auto n = static_cast<vtkIdType>(i);
            lines->InsertNextCell({known ? n - 1 : n, known ? n : n - 1});
        }
    }
    zone.surface->SetPoints(points);
    zone.surface->SetLines(lines);
    zone.surface->GetPointData()->AddArray(values);
    zone.surface->GetPointData()->AddArray(tractions);
    zone.arrays = {{"pressure", "Pa", "p", "", Location::nodes, 1}, {"wall_shear", "Pa", "t", "", Location::nodes, 3}};
    Field field = field_of({zone});
    field.dimension = 2;
    return field;
}

TEST(Loads, OfAnAxisymmetricCaseAreThoseOfTheBodyOfRevolution) {
    std::vector<std::array<double, 2>> sphere;
    constexpr int count = 40;
    for (int i = 0; i <= count; ++i) {
        const double at = M_PI * (1 - static_cast<double>(i) / count);
        sphere.push_back({0.3 + 0.1 * std::cos(at), i == 0 || i == count ? 0 : 0.1 * std::sin(at)});
    }
    double volume = 0, area = 0, swirl = 0;  // of the cones between two places
    for (std::size_t i = 1; i < sphere.size(); ++i) {
        const double r0 = sphere[i - 1][1], r1 = sphere[i][1];
        const double height = sphere[i][0] - sphere[i - 1][0];
        const double slant = std::hypot(height, r1 - r0);
        volume += M_PI / 3 * height * (r0 * r0 + r0 * r1 + r1 * r1);
        area += M_PI * (r0 + r1) * slant;
        swirl += 2 * M_PI / 3 * slant * (r0 * r0 + r0 * r1 + r1 * r1);
    }
    const auto p = [](const Vector& x) { return 700 - 2000 * x[0]; };
    for (const bool known : {true, false}) {
        Field field = profile(sphere, p, {3, 5, 7}, known);
        LoadsOptions options = about({0.05, 0.02, 0});
        options.references = {1000, 1.0, {}, {}, {}};
        options.stations = 4;
        EXPECT_EQ(loads(field, options).depth, "per metre depth");  // until somebody says what it is
        field.metadata = {{"axisymmetric", "true"}};
        const auto result = loads(field, options);
        EXPECT_EQ(result.depth, "of the whole body of revolution");
        EXPECT_NEAR(result.pressure.force[0], 2000 * volume, 1e-12);
        EXPECT_NEAR(result.viscous.force[0], 3 * area, 1e-12);
        EXPECT_EQ(result.total.force[1], 0);  // round the axis it cancels
        EXPECT_EQ(result.total.force[2], 0);
        EXPECT_NEAR(result.area, area, 1e-12);
        EXPECT_NEAR(result.total.moment[0], 7 * swirl, 1e-12);
        EXPECT_NEAR(result.total.moment[2], 0.02 * result.total.force[0],
                    1e-12);  // the axis passes the reference 0.02 m below it
        EXPECT_LT(result.closure, 1e-12);
        EXPECT_NEAR(result.named.drag_force, -result.total.force[0], 1e-12);
        ASSERT_TRUE(result.coefficients);
        EXPECT_NEAR(result.coefficients->width, 0.2, 1e-12);
        EXPECT_NEAR(result.coefficients->drag, result.named.drag_force / (500 * M_PI * 0.01), 1e-9);
        EXPECT_NEAR(result.stations.back().behind.drag_force, result.named.drag_force, 1e-12);
        field.metadata.clear();
        options.axisymmetric = true;
        EXPECT_EQ(loads(field, options).total.force, result.total.force);
        // Forces on faces that may be per radian are no traction: left out, aloud.
        field.zones[0].arrays[1].original_unit = "N";
        const auto without = loads(field, options);
        EXPECT_EQ(without.viscous.force, Vector{});
        EXPECT_THAT(without.problems.back().message, HasSubstr("per radian"));
        options.symmetry = "y";
        EXPECT_THROW(loads(field, options), core::UsageError);
    }
    Field below = profile({{0, -0.1}, {1, 0.2}}, p, {}, true);
    LoadsOptions options;
    options.axisymmetric = true;
    EXPECT_THROW(loads(below, options), core::InputError);
}

TEST(Loads, OfHalfAPlaneCaseAreThoseOfTheWhole) {
    // The upper half of a cylinder, p = c - b x: 2 b times the half's area along x, per metre.
    std::vector<std::array<double, 2>> places;
    constexpr int count = 60;
    for (int i = 0; i <= count; ++i) {
        const double at = M_PI * (1 - static_cast<double>(i) / count);
        places.push_back({0.1 * std::cos(at), i == 0 || i == count ? 0 : 0.1 * std::sin(at)});
    }
    const double area = 0.5 * count * 0.01 * std::sin(M_PI / count);
    for (const bool known : {true, false}) {
        const auto half = loads(profile(
                                    places, [](const Vector& x) { return 50 - 2000 * x[0]; }, {4, 0, 0}, known),
                                about({}, "y"));
        EXPECT_NEAR(half.pressure.force[0], 2 * 2000 * area, 1e-9);
        EXPECT_NEAR(half.viscous.force[0], 2 * 4 * count * 0.2 * std::sin(M_PI / count / 2), 1e-9);
        EXPECT_EQ(half.total.force[1], 0);
        EXPECT_LT(half.closure, 1e-12);
        EXPECT_EQ(half.depth, "per metre depth");
    }
}

}  // namespace
}  // namespace underbody::postproc
