// Which nodes the cells of a grid have, where their middles lie, which nodes lie inside.
#pragma once

#include <span>
#include <vector>

#include "postproc/field/surface_arrays.h"
#include "postproc/field/vector_math.h"

class vtkCellArray;
class vtkPolyData;
class vtkPointSet;
class vtkUnstructuredGrid;

namespace underbody::postproc {

/// Rows of numbers, one after the other.
struct Rows {
    std::vector<Index> offsets{0};  ///< one more than rows
    std::vector<Index> values;

    [[nodiscard]] std::size_t count() const { return offsets.size() - 1; }
    [[nodiscard]] std::span<const Index> operator[](std::size_t row) const {
        return {values.data() + offsets[row], static_cast<std::size_t>(offsets[row + 1] - offsets[row])};
    }
};

Rows rows_of(vtkCellArray& cells);

/// Centre of gravity of a polygon (of a line: its middle), by fans around the mean of its corners; not-a-number without
/// any.
Vector centre_of_polygon(const std::vector<Vector>& corners);

/// Lives shorter than its source. Throws core::InputError: a cell with a node that is not there.
class CellGeometry {
public:
    explicit CellGeometry(vtkUnstructuredGrid& grid);  ///< linear cells of two or three dimensions, polyhedra
    explicit CellGeometry(vtkPolyData& surface);       ///< its polygons

    [[nodiscard]] const Rows& cells() const { return cells_; }    ///< the nodes of each cell
    [[nodiscard]] const Rows& around() const { return around_; }  ///< the cells that have each node
    [[nodiscard]] Vector point(Index node) const {
        return {points_[3 * static_cast<std::size_t>(node)], points_[3 * static_cast<std::size_t>(node) + 1],
                points_[3 * static_cast<std::size_t>(node) + 2]};
    }
    [[nodiscard]] std::size_t nodes() const { return points_.size() / 3; }
    /// Centre of gravity of a cell that can be seen whole from the mean of its nodes.
    [[nodiscard]] const Vector& centre(Index cell) const { return centres_[static_cast<std::size_t>(cell)]; }
    /// Has the node cells on all sides? Never so on a surface.
    [[nodiscard]] bool inside(std::size_t node) const {
        return !size_.empty() && norm(opening_[node]) < 1e-9 * size_[node];
    }

private:
    CellGeometry(vtkPointSet& data, vtkCellArray& cells);
    void note_side(std::span<const Index> nodes, const Vector& outward);
    [[nodiscard]] std::vector<Vector> corners_of(std::size_t cell) const;
    [[nodiscard]] Vector centre_of_plane_cell(std::size_t cell);
    [[nodiscard]] Vector centre_of(vtkUnstructuredGrid& grid, std::size_t cell);

    Rows cells_;
    Rows around_;
    std::span<const double> points_;
    std::vector<double> own_points_;
    std::vector<Vector> centres_;
    std::vector<Vector> opening_;  ///< of a grid, by node: the sides of its cells around the node, outward, summed
    std::vector<double> size_;     ///< their sizes
};

}  // namespace underbody::postproc
