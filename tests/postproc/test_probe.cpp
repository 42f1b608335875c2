// Probing of a block of cells with linear values: everything has a closed form.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <array>
#include <cmath>
#include <functional>

#include "postproc/field/field.h"
#include "postproc/probe/probe.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

using Vector = std::array<double, 3>;

/// A gap of 1 m x 0.4 m x 0.1 m under a flat base: velocity -(1 + 20 z) along x, p = 5 x + z.
/// `in_cells`: the values at the middle of the cells, as a finite-volume solver has them. `beside`: all moved along y.
Field gap_block(
    bool in_cells = false,
    const std::function<Vector(const Vector&)>& stream =
        [](const Vector& p) {
            return Vector{-(1 + 20 * p[2]), 0, 0};
        },
    double beside = 0) {
    constexpr std::array<int, 3> n = {10, 8, 6};
    constexpr std::array<double, 3> size = {1, 0.4, 0.1};
    Zone volume;
    volume.name = "water";
    volume.kind = ZoneKind::fluid;
    volume.volume = vtkSmartPointer<vtkUnstructuredGrid>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkDoubleArray> velocity;
    velocity->SetName("velocity");
    velocity->SetNumberOfComponents(3);
    vtkNew<vtkDoubleArray> pressure;
    pressure->SetName("pressure");
    const auto id = [&](int i, int j, int k) { return static_cast<vtkIdType>((k * (n[1] + 1) + j) * (n[0] + 1) + i); };
    for (int k = 0; k <= n[2]; ++k) {
        for (int j = 0; j <= n[1]; ++j) {
            for (int i = 0; i <= n[0]; ++i) {
                const double x = size[0] * (static_cast<double>(i) / n[0] - 0.5);
                const double y = beside + size[1] * (static_cast<double>(j) / n[1] - 0.5);
                const double z = size[2] * k / n[2];
                points->InsertNextPoint(x, y, z);
                if (!in_cells) {
                    velocity->InsertNextTuple(stream({x, y, z}).data());
                    pressure->InsertNextValue(5 * x + z);
                }
            }
        }
    }
    volume.volume->SetPoints(points);
    volume.volume->Allocate(n[0] * n[1] * n[2]);
    for (int k = 0; k < n[2]; ++k) {
        for (int j = 0; j < n[1]; ++j) {
            for (int i = 0; i < n[0]; ++i) {
                const vtkIdType ids[8] = {
                    id(i, j, k),     id(i + 1, j, k),     id(i + 1, j + 1, k),     id(i, j + 1, k),
                    id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)};
                volume.volume->InsertNextCell(VTK_HEXAHEDRON, 8, ids);
                if (in_cells) {
                    const Vector middle = {size[0] * ((i + 0.5) / n[0] - 0.5), size[1] * ((j + 0.5) / n[1] - 0.5),
                                           size[2] * (k + 0.5) / n[2]};
                    velocity->InsertNextTuple(stream(middle).data());
                    pressure->InsertNextValue(5 * middle[0] + middle[2]);
                }
            }
        }
    }
    vtkDataSetAttributes* data = volume.volume->GetPointData();
    if (in_cells) {
        data = volume.volume->GetCellData();
    }
    data->AddArray(velocity);
    data->AddArray(pressure);
    const Location on = in_cells ? Location::cells : Location::nodes;
    volume.arrays = {{"velocity", "m/s", "U", "", on, 3}, {"pressure", "Pa", "p", "", on, 1}};
    Zone base;
    base.name = "base";
    base.kind = ZoneKind::wall;
    base.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> corners;  // narrower than the water: 0.8 m x 0.2 m
    for (const auto& [x, y] : {std::pair{-0.4, -0.1}, {0.4, -0.1}, {0.4, 0.1}, {-0.4, 0.1}}) {
        corners->InsertNextPoint(x, beside + y, 0.1);
    }
    vtkNew<vtkCellArray> face;
    face->InsertNextCell({0, 3, 2, 1});
    base.surface->SetPoints(corners);
    base.surface->SetPolys(face);
    Field field;
    field.files = {"made"};
    field.density = 1000;
    field.zones = {volume, base};
    return field;
}

TEST(Probe, InterpolatesLinearlyAndSaysWhatLiesOutside) {
    const core::Table line = probe_line(gap_block(), {-0.3, 0.05, 0.01}, {0.9, 0.05, 0.07}, 13);
    for (std::size_t i = 0; i < line.rows(); ++i) {
        const double x = line.numbers("x")[i];
        const double z = line.numbers("z")[i];
        if (x < 0.4999) {
            EXPECT_NEAR(line.numbers("pressure")[i], 5 * x + z, 1e-12);
            EXPECT_NEAR(line.numbers("velocity_x")[i], -(1 + 20 * z), 1e-12);
        } else if (x > 0.5001) {
            EXPECT_TRUE(std::isnan(line.numbers("pressure")[i]));
        }
    }
    EXPECT_NEAR(line.numbers("distance").back(), std::hypot(1.2, 0.06), 1e-12);
    const core::Table plane = probe_plane(gap_block(), {-0.1, -0.1, 0.05}, {0.2, 0, 0}, {0, 0.2, 0}, 3, 2);
    EXPECT_EQ(plane.rows(), 6U);
    EXPECT_NEAR(plane.numbers("pressure")[2], 0.55, 1e-12);
    ProbeOptions wrong;
    wrong.arrays = {"presure"};
    EXPECT_THROW(probe_points(gap_block(), {{0, 0, 0}}, wrong), core::InputError);
}

TEST(Probe, GivesTheFlowThroughTheGapInClosedForm) {
    GapOptions options;
    options.stations = 4;
    const core::Table flow = gap_flow(gap_block(), options);
    ASSERT_EQ(flow.rows(), 4U);
    for (std::size_t i = 0; i < flow.rows(); ++i) {
        EXPECT_NEAR(flow.numbers("width")[i], 0.2, 1e-7);
        EXPECT_NEAR(flow.numbers("area")[i], 0.02, 1e-8);
        EXPECT_NEAR(flow.numbers("bulk_velocity")[i], 2, 1e-6);  // 1 + 20 * 0.05
        EXPECT_NEAR(flow.numbers("volume_flow")[i], 0.04, 1e-8);
        EXPECT_NEAR(flow.numbers("mass_flow")[i], 40, 1e-5);
        const double x = flow.numbers("position")[i];
        EXPECT_NEAR(flow.numbers("mean_pressure")[i], 5 * x + 0.05, 1e-7);
        // Flow mean of z: integral of (1 + 20 z) z over integral of (1 + 20 z), height 0.1.
        EXPECT_NEAR(flow.numbers("bulk_pressure")[i], 5 * x + (0.005 + 20 * 1e-3 / 3) / 0.2, 1e-6);
    }
}

/// Half a gap: base and water begin at a plane that is not y = 0.
Field half_gap(double plane) {
    return gap_block(
        false,
        [](const Vector& p) {
            return Vector{-(1 + 20 * p[2]), 0, 0};
        },
        plane + 0.1);
}

/// A face of 1 x 1 m at a height; pressure is the height, wall shear too where it has one, `odd` has no unit.
Zone plate(const std::string& name, double height, bool shear) {
    Zone zone;
    zone.name = name;
    zone.kind = ZoneKind::wall;
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        points->InsertNextPoint(x, y, height);
    }
    vtkNew<vtkCellArray> face;
    face->InsertNextCell({0, 1, 2, 3});
    zone.surface->SetPoints(points);
    zone.surface->SetPolys(face);
    const auto add = [&](const char* array, const char* unit, int components) {
        vtkNew<vtkDoubleArray> values;
        values->SetName(array);
        values->SetNumberOfComponents(components);
        values->SetNumberOfTuples(4);
        values->Fill(height);
        zone.surface->GetPointData()->AddArray(values);
        zone.arrays.push_back({array, unit, array, unit, Location::nodes, components});
    };
    add("pressure", "Pa", 1);
    add("odd", "", 1);
    if (shear) {
        add("wall_shear", "Pa", 3);
    }
    return zone;
}

TEST(Probe, TakesAllValuesOfARowFromTheNearestSurface) {
    Field field;
    field.files = {"made"};
    field.zones = {plate("with", 1, true), plate("without", 2, false)};
    const core::Table table = probe_points(field, {{0.5, 0.5, 1.2}, {0.5, 0.5, 1.8}});
    EXPECT_NEAR(table.numbers("wall_shear_x")[0], 1, 1e-12);
    EXPECT_NEAR(table.numbers("pressure")[1], 2, 1e-12);
    EXPECT_NEAR(table.numbers("distance_to_surface")[1], 0.2, 1e-12);
    EXPECT_TRUE(std::isnan(table.numbers("wall_shear_x")[1]));  // the other zone's is not its own
}

TEST(Probe, GivesNoUnitToWhatTheFileGivesNone) {
    Field field;
    field.files = {"made"};
    field.zones = {plate("with", 1, true)};
    const core::Table table = probe_points(field, {{0.5, 0.5, 1.2}});
    ASSERT_TRUE(table.find("odd")->is_text());
    EXPECT_EQ(table.text("odd")[0], "1");
    EXPECT_THAT(core::write_csv(table), testing::HasSubstr(", odd,"));
}

TEST(Probe, SaysWhenItsZonesMeanNothing) {
    ProbeOptions options;
    options.zones = {"bas"};
    EXPECT_THROW(probe_points(gap_block(), {{0, 0, 0}}, options), core::UsageError);  // a volume
    Field field;
    field.zones = {plate("base", 1, true)};
    try {
        probe_points(field, {{0, 0, 0}}, options);
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.hint(), "did you mean 'base'?");
    }
}

TEST(Probe, CountsBothHalvesOfAHalfModelAlone) {
    GapOptions options;
    options.stations = 1;
    for (const char* symmetry : {"y", "y=0.3"}) {
        options.symmetry = symmetry;
        const core::Table flow = gap_flow(half_gap(0.3), options);
        EXPECT_NEAR(flow.numbers("width")[0], 0.4, 1e-7);
        EXPECT_NEAR(flow.numbers("volume_flow")[0], 0.08, 1e-8);
        EXPECT_EQ(flow.comments.size(), symmetry == std::string("y") ? 1U : 0U);  // nobody said where it lies
    }
    for (const char* symmetry : {"y", "y=0.05"}) {  // the whole model is no half
        options.symmetry = symmetry;
        EXPECT_THROW(gap_flow(gap_block(), options), core::InputError);
        EXPECT_THROW(gap_profile_figure(gap_block(), options), core::InputError);
    }
    options.symmetry = "z";  // the halves would lie above each other
    EXPECT_THROW(gap_flow(half_gap(0.3), options), core::UsageError);
}

TEST(Probe, RefusesAxesThatAreNone) {
    GapOptions options;
    options.forward = options.up;
    EXPECT_THROW(gap_flow(gap_block(), options), core::UsageError);
    EXPECT_THROW(gap_profile_figure(gap_block(), options), core::UsageError);
}

TEST(Probe, GivesTheFlowOfCellValuesAsTheCellsHaveIt) {
    GapOptions options;
    options.stations = 4;
    const core::Table flow = gap_flow(gap_block(true), options);
    for (std::size_t i = 0; i < flow.rows(); ++i) {
        EXPECT_NEAR(flow.numbers("volume_flow")[i], 0.04,
                    1e-8);  // a mean of the nodes alone would give more at the ground and less at the base
        EXPECT_NEAR(flow.numbers("bulk_velocity")[i], 2, 1e-6);
        EXPECT_NEAR(flow.numbers("mean_pressure")[i], 5 * flow.numbers("position")[i] + 0.05, 1e-7);
    }
}

TEST(Probe, KeepsTheWaterThatComesInFromTheSides) {
    // u = -(2 + x), v = y, w = 0 is free of sources: the flow grows toward the nose by what leaves at the sides.
    GapOptions options;
    options.stations = 5;
    for (const bool in_cells : {false, true}) {
        const core::Table flow = gap_flow(gap_block(in_cells,
                                                    [](const Vector& p) {
                                                        return Vector{-(2 + p[0]), p[1], 0};
                                                    }),
                                          options);
        for (std::size_t i = 1; i < flow.rows(); ++i) {
            const double length = flow.numbers("position")[i] - flow.numbers("position")[i - 1];
            const double through_sides = 2 * 0.1 * 0.1 * length;  // v = 0.1 m/s on both, over the height of 0.1 m
            EXPECT_NEAR(flow.numbers("volume_flow")[i] - flow.numbers("volume_flow")[i - 1], through_sides,
                        in_cells ? 1e-4 : 1e-8);
        }
    }
}

TEST(Probe, BalancesTheRealGapBetweenTwoStations) {
    UNDERBODY_NEEDS_SHARED("cfd/volume/ellipse-h5-coarse.cas.gz");
    const Field field = read_field(test::shared_folder() / "cfd/volume/ellipse-h5-coarse.cas.gz");
    GapOptions options;
    options.symmetry = "y";
    options.stations = 8;
    const core::Table flow = gap_flow(field, options);
    // Through the curved side under the edge of the base, an ellipse of 134.4 x 100.5 mm, by points: a second way.
    constexpr double a = 0.067202, b = 0.050269, gap = 0.005;
    for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>{1, 3}, {3, 6}, {1, 6}}) {
        const double x0 = flow.numbers("position")[from];
        const double x1 = flow.numbers("position")[to];
        constexpr int along = 80, across = 50;
        std::vector<std::array<double, 3>> points;
        std::vector<std::array<double, 2>> normals;  // times the area
        for (int i = 0; i < along; ++i) {
            const auto angle = [&](double share) { return std::acos((x0 + share * (x1 - x0)) / a); };
            const double theta0 = angle(static_cast<double>(i) / along);
            const double theta1 = angle(static_cast<double>(i + 1) / along);
            const double dx = a * (std::cos(theta1) - std::cos(theta0));
            const double dy = b * (std::sin(theta1) - std::sin(theta0));
            const double theta = 0.5 * (theta0 + theta1);
            for (int k = 0; k < across; ++k) {
                points.push_back({a * std::cos(theta), b * std::sin(theta), gap * (k + 0.5) / across});
                normals.push_back({-dy * gap / across, dx * gap / across});  // out of the ellipse, x growing
            }
        }
        ProbeOptions arrays;
        arrays.arrays = {"velocity"};
        const core::Table side = probe_points(field, points, arrays);
        double out = 0;
        for (std::size_t i = 0; i < side.rows(); ++i) {
            out += side.numbers("velocity_x")[i] * normals[i][0] + side.numbers("velocity_y")[i] * normals[i][1];
        }
        const double in = flow.numbers("volume_flow")[to] / 2;
        const double gone = flow.numbers("volume_flow")[from] / 2;
        EXPECT_NEAR(in, gone + out, 0.02 * in)
            << from << " to " << to << ": in " << in << ", out astern " << gone << ", out at the side " << out;
    }
}

TEST(Probe, DrawsTheProfileAcrossTheGap) {
    const core::Figure figure = gap_profile_figure(gap_block());
    ASSERT_EQ(figure.curves.size(), 5U);
    const auto& curve = figure.curves[2];
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        EXPECT_NEAR(curve.x[i], 1 + 20 * curve.y[i] / 1000, 1e-9);
    }
    EXPECT_GT(curve.x.size(), 55U);
}

TEST(Probe, DrawsTheProfileWhereTheMiddleOfAHalfModelLies) {
    GapOptions options;
    for (const double plane : {0.3, -0.4}) {
        options.symmetry = "y=" + std::to_string(plane);
        for (const auto& curve : gap_profile_figure(half_gap(plane), options).curves) {
            ASSERT_GT(curve.x.size(), 55U) << plane;
            EXPECT_NEAR(curve.x.back(), 1 + 20 * curve.y.back() / 1000, 1e-9);
        }
    }
}

}  // namespace
}  // namespace underbody::postproc
