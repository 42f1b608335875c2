// Zones with pressure and shear given in closed form: what the tests of loads integrate.
#pragma once

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "postproc/loads/loads.h"

namespace underbody::postproc {

using PointFunction = std::function<double(const Vector&)>;

/// A zone from points and faces, with pressure and shear as functions of the place, on nodes.
inline Zone make_zone(const std::string& name, const std::vector<Vector>& points,
                      const std::vector<std::vector<vtkIdType>>& faces, const PointFunction& pressure,
                      const std::function<Vector(const Vector&)>& shear = {}) {
    Zone zone;
    zone.name = name;
    zone.kind = ZoneKind::wall;
    zone.normals_into_fluid = false;
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> places;
    places->SetDataTypeToDouble();
    vtkNew<vtkDoubleArray> values;
    values->SetName("pressure");
    vtkNew<vtkDoubleArray> tractions;
    tractions->SetName("wall_shear");
    tractions->SetNumberOfComponents(3);
    for (const auto& p : points) {
        places->InsertNextPoint(p.data());
        values->InsertNextValue(pressure(p));
        const Vector t = shear ? shear(p) : Vector{};
        tractions->InsertNextTuple(t.data());
    }
    vtkNew<vtkCellArray> cells;
    for (const auto& face : faces) {
        cells->InsertNextCell(static_cast<vtkIdType>(face.size()), face.data());
    }
    zone.surface->SetPoints(places);
    zone.surface->SetPolys(cells);
    zone.surface->GetPointData()->AddArray(values);
    zone.surface->GetPointData()->AddArray(tractions);
    zone.arrays = {{"pressure", "Pa", "Pressure", "Pa", Location::nodes, 1},
                   {"wall_shear", "Pa", "Wall Shear X", "Pa", Location::nodes, 3}};
    return zone;
}

/// An ellipsoid of quads (triangles at the poles), optionally cut at y = 0 to a half model; `turned`: normals inward.
inline Zone ellipsoid(int rings, const Vector& axes, const PointFunction& pressure, bool half = false,
                      bool turned = false, const std::string& name = "hull",
                      const std::function<Vector(const Vector&)>& shear = {}) {
    std::vector<Vector> points;
    std::vector<std::vector<vtkIdType>> faces;
    const int around = half ? rings : 2 * rings;
    const int columns = half ? around + 1 : around;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < columns; ++j) {
            const double theta = M_PI * i / rings;
            const double phi = (half ? M_PI : 2 * M_PI) * j / around;
            double y = axes[1] * std::sin(theta) * std::sin(phi);
            if (half && (j == 0 || j == around)) {
                y = 0;
            }
            points.push_back({axes[0] * std::sin(theta) * std::cos(phi), y, axes[2] * std::cos(theta)});
        }
    }
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const vtkIdType a = i * columns + j;
            const vtkIdType b = i * columns + (j + 1) % columns;
            const vtkIdType c = b + columns;
            const vtkIdType d = a + columns;
            std::vector<vtkIdType> face = i == 0           ? std::vector<vtkIdType>{a, d, c}
                                          : i == rings - 1 ? std::vector<vtkIdType>{a, d, b}
                                                           : std::vector<vtkIdType>{a, d, c, b};
            if (turned) {
                std::reverse(face.begin(), face.end());
            }
            faces.push_back(face);
        }
    }
    return make_zone(name, points, faces, pressure, shear);
}

inline Field field_of(std::vector<Zone> zones) {
    Field field;
    field.files = {"made.csv"};
    field.zones = std::move(zones);
    return field;
}

inline LoadsOptions about(const Vector& reference, const std::string& symmetry = "") {
    LoadsOptions options;
    options.reference = reference;
    options.symmetry = symmetry;
    return options;
}

inline constexpr double g = 9.80665;
inline constexpr double rho = 998;
inline double hydrostatic(const Vector& p) { return -rho * g * p[2] + 5000; }

/// A box whose top and bottom are zones of their own; any of them may lie the wrong way round.
inline Field box(bool turn_bottom, bool turn_top, bool without_top = false) {
    const std::vector<Vector> x = {{0, 0, 0},   {2, 0, 0},   {2, 1, 0},   {0, 1, 0},
                                   {0, 0, 0.5}, {2, 0, 0.5}, {2, 1, 0.5}, {0, 1, 0.5}};
    std::vector<std::vector<vtkIdType>> bottom = {{0, 3, 2, 1}};
    std::vector<std::vector<vtkIdType>> top = {{4, 5, 6, 7}};
    const auto turn = [](auto& faces) {
        std::for_each(faces.begin(), faces.end(), [](auto& f) { std::reverse(f.begin(), f.end()); });
    };
    if (turn_bottom) {
        turn(bottom);
    }
    if (turn_top) {
        turn(top);
    }
    const auto p = [](const Vector& q) { return 1 + q[2]; };
    std::vector<Zone> zones = {
        make_zone("base", {x[0], x[1], x[2], x[3]}, {{bottom[0][0], bottom[0][1], bottom[0][2], bottom[0][3]}}, p),
        make_zone("sides", x, {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}, p)};
    if (!without_top) {
        zones.push_back(make_zone("top", {x[4], x[5], x[6], x[7]},
                                  {{top[0][0] - 4, top[0][1] - 4, top[0][2] - 4, top[0][3] - 4}}, p));
    }
    return field_of(std::move(zones));
}

inline Field box_over_ground(bool open) {
    Field field = box(false, false, open);
    field.zones.push_back(make_zone("ground", {{-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}}, {{0, 1, 2, 3}},
                                    [](const Vector&) { return 1.0; }));
    return field;
}

}  // namespace underbody::postproc
