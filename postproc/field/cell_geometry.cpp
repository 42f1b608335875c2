#include "postproc/field/cell_geometry.h"

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace underbody::postproc {

namespace {

std::vector<Index> integers(vtkDataArray& array) {
    std::vector<Index> result(static_cast<std::size_t>(array.GetNumberOfValues()));
    if (auto* wide = vtkArrayDownCast<vtkCellArray::ArrayType64>(&array)) {
        std::copy_n(wide->GetPointer(0), result.size(), result.begin());
    } else if (auto* narrow = vtkArrayDownCast<vtkCellArray::ArrayType32>(&array)) {
        std::copy_n(narrow->GetPointer(0), result.size(), result.begin());
    }
    return result;
}

/// For each node the cells that have it.
Rows turned_round(const Rows& cells, std::size_t nodes) {
    Rows result;
    result.offsets.assign(nodes + 1, 0);
    for (const Index node : cells.values) {
        if (node < 0 || static_cast<std::size_t>(node) >= nodes) {
            throw core::InputError("range",
                                   "a cell names node " + std::to_string(node) + " of " + std::to_string(nodes));
        }
        ++result.offsets[static_cast<std::size_t>(node) + 1];
    }
    for (std::size_t i = 0; i < nodes; ++i) {
        result.offsets[i + 1] += result.offsets[i];
    }
    result.values.resize(cells.values.size());
    std::vector<Index> next(result.offsets.begin(), result.offsets.end() - 1);
    for (std::size_t c = 0; c < cells.count(); ++c) {
        for (const Index node : cells[c]) {
            result.values[static_cast<std::size_t>(next[static_cast<std::size_t>(node)]++)] = static_cast<Index>(c);
        }
    }
    return result;
}

/// The faces of VTK's linear cells by their nodes; -1 ends a triangle early.
using Faces = std::span<const std::array<int, 4>>;
Faces faces_of(int type) {
    static constexpr std::array<std::array<int, 4>, 4> tetra = {
        {{0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}, {0, 2, 1, -1}}};
    static constexpr std::array<std::array<int, 4>, 6> hexahedron = {
        {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
    static constexpr std::array<std::array<int, 4>, 6> voxel = {
        {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};
    static constexpr std::array<std::array<int, 4>, 5> wedge = {
        {{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
    static constexpr std::array<std::array<int, 4>, 5> pyramid = {
        {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
    switch (type) {
        case VTK_TETRA:
            return tetra;
        case VTK_HEXAHEDRON:
            return hexahedron;
        case VTK_VOXEL:
            return voxel;
        case VTK_WEDGE:
            return wedge;
        case VTK_PYRAMID:
            return pyramid;
        default:
            return {};
    }
}

/// Centre of gravity in the making: pieces with their sizes, about a point near by.
struct Centre {
    Vector sum{};
    double size = 0;
    void add(const Vector& at, double much) {
        sum = plus(sum, at, much);
        size += much;
    }
    [[nodiscard]] Vector place(const Vector& otherwise) const { return size > 0 ? plus({}, sum, 1 / size) : otherwise; }
};

}  // namespace

Rows rows_of(vtkCellArray& cells) {
    Rows rows;
    if (cells.GetNumberOfCells() > 0) {
        rows.offsets = integers(*cells.GetOffsetsArray());
        rows.values = integers(*cells.GetConnectivityArray());
    }
    return rows;
}

Vector centre_of_polygon(const std::vector<Vector>& corners) {
    if (corners.empty()) {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        return {nan, nan, nan};
    }
    const double share = 1 / static_cast<double>(corners.size());
    Vector mean{};
    for (const auto& corner : corners) {
        mean = plus(mean, corner, share);
    }
    Centre centre;
    for (std::size_t i = 0; i < corners.size() && corners.size() > 3; ++i) {
        const Vector& a = corners[i];
        const Vector& b = corners[(i + 1) % corners.size()];
        centre.add(plus({}, plus(plus(mean, a), b), 1.0 / 3), norm(cross(plus(a, mean, -1), plus(b, mean, -1))));
    }
    return centre.place(mean);
}

CellGeometry::CellGeometry(vtkPointSet& data, vtkCellArray& cells) : cells_(rows_of(cells)) {
    if (data.GetPoints() != nullptr) {
        points_ = values_of(*data.GetPoints()->GetData(), own_points_);
    }
    around_ = turned_round(cells_, nodes());
    centres_.resize(cells_.count());
}

CellGeometry::CellGeometry(vtkUnstructuredGrid& grid) : CellGeometry(grid, *grid.GetCells()) {
    opening_.assign(nodes(), {});
    size_.assign(nodes(), 0);
    for (std::size_t c = 0; c < cells_.count(); ++c) {
        const int type = grid.GetCellType(static_cast<vtkIdType>(c));
        const bool plane = type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_POLYGON;
        centres_[c] = plane ? centre_of_plane_cell(c) : centre_of(grid, c);
    }
}

CellGeometry::CellGeometry(vtkPolyData& surface) : CellGeometry(surface, *surface.GetPolys()) {
    for (std::size_t c = 0; c < cells_.count(); ++c) {
        centres_[c] = centre_of_polygon(corners_of(c));
    }
}

/// A side of a cell, for the nodes on it: around a node with cells on all sides these sum to nothing.
void CellGeometry::note_side(std::span<const Index> nodes, const Vector& outward) {
    for (const Index node : nodes) {
        Vector& opening = opening_[static_cast<std::size_t>(node)];
        opening = plus(opening, outward);
        size_[static_cast<std::size_t>(node)] += norm(outward);
    }
}

std::vector<Vector> CellGeometry::corners_of(std::size_t cell) const {
    std::vector<Vector> corners;
    for (const Index node : cells_[cell]) {
        corners.push_back(point(node));
    }
    return corners;
}

/// Of a case in the plane of x and y.
Vector CellGeometry::centre_of_plane_cell(std::size_t cell) {
    const auto nodes = cells_[cell];
    const Vector centre = centre_of_polygon(corners_of(cell));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::array<Index, 2> edge = {nodes[i], nodes[(i + 1) % nodes.size()]};
        const Vector along = plus(point(edge[1]), point(edge[0]), -1);
        note_side(edge, plus({}, along, cross(plus(point(edge[0]), centre, -1), along)[2] < 0 ? -1.0 : 1.0));
    }
    return centre;
}

Vector CellGeometry::centre_of(vtkUnstructuredGrid& grid, std::size_t cell) {
    const auto nodes = cells_[cell];
    const int type = grid.GetCellType(static_cast<vtkIdType>(cell));
    const auto mean_of = [&](std::span<const Index> some) {
        Vector sum{};
        for (const Index node : some) {
            sum = plus(sum, point(node), 1 / static_cast<double>(some.size()));
        }
        return sum;
    };
    const Vector mean = mean_of(nodes);
    Centre centre;
    const auto add_face = [&](std::span<const Index> face) {
        const Vector middle = mean_of(face);
        const Vector outward = plus(middle, mean, -1);
        Vector area{};
        for (std::size_t i = 0; i < face.size(); ++i) {
            const Vector a = point(face[i]);
            const Vector b = point(face[(i + 1) % face.size()]);
            // A tetrahedron from the middle of the cell over a piece of the face.
            const Vector piece = cross(plus(a, middle, -1), plus(b, middle, -1));
            centre.add(plus({}, plus(plus(plus(mean, middle), a), b), 0.25), std::abs(dot(outward, piece)));
            area = plus(area, piece);
        }
        note_side(face, plus({}, area, dot(area, outward) < 0 ? -1.0 : 1.0));
    };
    if (type == VTK_POLYHEDRON) {
        vtkIdType faces = 0;
        const vtkIdType* stream = nullptr;
        grid.GetFaceStream(static_cast<vtkIdType>(cell), faces, stream);
        for (vtkIdType f = 0; f < faces; ++f) {
            const std::vector<Index> face(stream + 1, stream + 1 + *stream);
            add_face(face);
            stream += 1 + *stream;
        }
    } else {
        for (const auto& local : faces_of(type)) {
            std::array<Index, 4> face{};
            std::size_t count = 0;
            for (; count < 4 && local[count] >= 0; ++count) {
                face[count] = nodes[static_cast<std::size_t>(local[count])];
            }
            add_face({face.data(), count});
        }
    }
    return centre.place(mean);
}

}  // namespace underbody::postproc
