#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "import_support.h"

namespace underbody::test {

namespace {

Triple minus(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Triple cross(const Triple& a, const Triple& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Triple at(vtkPointSet& data, vtkIdType id) {
    Triple p{};
    data.GetPoint(id, p.data());
    return p;
}

Triple area_vector(vtkPointSet& data, vtkIdList& nodes) {
    if (nodes.GetNumberOfIds() == 2) {
        const Triple d = minus(at(data, nodes.GetId(1)), at(data, nodes.GetId(0)));
        return {-d[1], d[0], 0};
    }
    Triple sum{};
    const Triple a = at(data, nodes.GetId(0));
    for (vtkIdType i = 1; i + 1 < nodes.GetNumberOfIds(); ++i) {
        const Triple n = cross(minus(at(data, nodes.GetId(i)), a), minus(at(data, nodes.GetId(i + 1)), a));
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += n[k] / 2;
        }
    }
    return sum;
}

/// VTK's own faces of the cell (outward for a right cell) against the mean of its points.
double cell_volume(vtkUnstructuredGrid& grid, vtkIdType id) {
    vtkCell* cell = grid.GetCell(id);
    if (cell->GetCellDimension() == 2) {
        return area_vector(grid, *cell->GetPointIds())[2];
    }
    Triple centre{};
    const vtkIdType count = cell->GetNumberOfPoints();
    for (vtkIdType i = 0; i < count; ++i) {
        const Triple p = at(grid, cell->GetPointId(static_cast<int>(i)));
        for (std::size_t k = 0; k < 3; ++k) {
            centre[k] += p[k] / static_cast<double>(count);
        }
    }
    double volume = 0;
    for (int f = 0; f < cell->GetNumberOfFaces(); ++f) {
        vtkIdList* nodes = cell->GetFace(f)->GetPointIds();
        const vtkIdType corners = nodes->GetNumberOfIds();
        Triple mean{};
        for (vtkIdType i = 0; i < corners; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                mean[k] += at(grid, nodes->GetId(i))[k] / static_cast<double>(corners);
            }
        }
        const Triple normal = area_vector(grid, *nodes);
        volume += dot(minus(mean, centre), normal) / 3;
    }
    return volume;
}

vtkDataArray* values(vtkPolyData& surface, const std::string& name) {
    vtkDataArray* array = surface.GetCellData()->GetArray(name.c_str());
    if (array == nullptr) {
        throw std::runtime_error("no face values " + name);
    }
    return array;
}

}  // namespace

double volume_of(vtkUnstructuredGrid& grid) {
    double sum = 0;
    for (vtkIdType i = 0; i < grid.GetNumberOfCells(); ++i) {
        sum += cell_volume(grid, i);
    }
    return sum;
}

double smallest_volume(vtkUnstructuredGrid& grid) {
    double least = std::numeric_limits<double>::infinity();
    for (vtkIdType i = 0; i < grid.GetNumberOfCells(); ++i) {
        least = std::min(least, cell_volume(grid, i));
    }
    return least;
}

int count_cells(vtkUnstructuredGrid& grid, int type) {
    int count = 0;
    for (vtkIdType i = 0; i < grid.GetNumberOfCells(); ++i) {
        count += grid.GetCellType(i) == type ? 1 : 0;
    }
    return count;
}

double area_of(vtkPolyData& surface) {
    double sum = 0;
    vtkNew<vtkIdList> nodes;
    for (vtkIdType i = 0; i < surface.GetNumberOfCells(); ++i) {
        surface.GetCellPoints(i, nodes);
        const Triple n = area_vector(surface, *nodes);
        sum += std::sqrt(dot(n, n));
    }
    return sum;
}

Triple pressure_force(vtkPolyData& surface, const std::string& array) {
    Triple sum{};
    vtkNew<vtkIdList> nodes;
    vtkDataArray* p = values(surface, array);
    for (vtkIdType i = 0; i < surface.GetNumberOfCells(); ++i) {
        surface.GetCellPoints(i, nodes);
        const Triple n = area_vector(surface, *nodes);
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] -= p->GetTuple1(i) * n[k];
        }
    }
    return sum;
}

Triple viscous_force(vtkPolyData& surface, const std::string& array) {
    Triple sum{};
    vtkNew<vtkIdList> nodes;
    vtkDataArray* traction = values(surface, array);
    for (vtkIdType i = 0; i < surface.GetNumberOfCells(); ++i) {
        surface.GetCellPoints(i, nodes);
        const Triple n = area_vector(surface, *nodes);
        const double area = std::sqrt(dot(n, n));
        for (int k = 0; k < 3; ++k) {
            sum[static_cast<std::size_t>(k)] += traction->GetComponent(i, k) * area;
        }
    }
    return sum;
}

double sum_of(vtkPolyData& surface, const std::string& array) {
    double sum = 0;
    vtkDataArray* v = values(surface, array);
    for (vtkIdType i = 0; i < surface.GetNumberOfCells(); ++i) {
        sum += v->GetTuple1(i);
    }
    return sum;
}

Range range_of(vtkDataSet& data, const std::string& name) {
    vtkDataArray* array = data.GetCellData()->GetArray(name.c_str());
    if (array == nullptr) {
        throw std::runtime_error("no values " + name);
    }
    Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
        range.low = std::min(range.low, array->GetTuple1(i));
        range.high = std::max(range.high, array->GetTuple1(i));
    }
    return range;
}

long long cells_of(const postproc::Field& field) {
    long long count = 0;
    for (const auto& zone : field.zones) {
        count += zone.volume != nullptr ? zone.volume->GetNumberOfCells() : 0;
    }
    return count;
}

double volume_of(const postproc::Field& field) {
    double sum = 0;
    for (const auto& zone : field.zones) {
        sum += zone.volume != nullptr ? volume_of(*zone.volume) : 0;
    }
    return sum;
}

std::string refusal(const std::filesystem::path& path, const postproc::ReadOptions& options) {
    try {
        (void)postproc::read_field(path, options);
    } catch (const core::InputError& error) {
        return error.what();
    }
    return {};
}

std::string told(const postproc::Field& field) {
    std::string text;
    for (const auto& problem : field.problems) {
        text += problem.message + "\n";
    }
    return text;
}

}  // namespace underbody::test
