// What the importer tests share: sums over zones by means that the importers do not use.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "postproc/field/field.h"

namespace underbody::test {

using Triple = std::array<double, 3>;

/// Volume (2-D: area) of a grid cell by cell, each kind of cell cut into tetrahedra in its own way.
double volume_of(vtkUnstructuredGrid& grid);
/// The smallest of the cell volumes.
double smallest_volume(vtkUnstructuredGrid& grid);
/// How many cells of a VTK type.
int count_cells(vtkUnstructuredGrid& grid, int type);

double area_of(vtkPolyData& surface);
/// Sum of -p n A, n being the right-hand normal of each face (2-D: n0 -> n1 turned to the left).
Triple pressure_force(vtkPolyData& surface, const std::string& array = "pressure");
/// Sum of the traction times A.
Triple viscous_force(vtkPolyData& surface, const std::string& array = "wall_shear");
double sum_of(vtkPolyData& surface, const std::string& array);

struct Range {
    double low = 0;
    double high = 0;
};
Range range_of(vtkDataSet& data, const std::string& array);

/// Cells of all volumes.
long long cells_of(const postproc::Field& field);
double volume_of(const postproc::Field& field);

/// The message of the InputError that reading the file throws; "" when it throws none.
std::string refusal(const std::filesystem::path& path, const postproc::ReadOptions& options = {});

/// What a field says of itself, one message a line.
std::string told(const postproc::Field& field);

}  // namespace underbody::test
