// Values that a solver keeps in cells, carried to the nodes between them.
#pragma once

#include <vtkDoubleArray.h>
#include <vtkSmartPointer.h>

#include <memory>
#include <string>
#include <vector>

class vtkPolyData;
class vtkUnstructuredGrid;

namespace underbody::postproc {

struct Zone;

/// Carries values from cells to nodes so that a linear field comes out exactly, at the boundary too: each cell extends
/// its value along its own gradient (least squares over the cells that share a node with it), and a node takes the mean
/// of the cells around it; with cells on all sides it stays among their values. A plain mean of the cells would be off
/// by half a cell's change at every wall.
///
/// Where a boundary zone has the array on its faces, its nodes take the value from there; a wall's velocity (no slip,
/// or a belt that moves) as it stands.
class NodeValues {
public:
    /// All cells of a grid; `boundaries`: zones some of whose faces are faces of these cells, by the place of their
    /// nodes.
    NodeValues(vtkUnstructuredGrid& grid, const std::vector<const Zone*>& boundaries);
    /// The polygons of a surface that has nothing but polygons.
    explicit NodeValues(vtkPolyData& surface);
    ~NodeValues();

    /// Values of the cell array `name` at the nodes, in its unit; not-a-number where no cell around has a value. An
    /// array of one component that is nowhere negative stays so. Throws core::InputError: no such cell array.
    [[nodiscard]] vtkSmartPointer<vtkDoubleArray> of(const std::string& name) const;

private:
    class Carrier;
    std::unique_ptr<Carrier> carrier_;
};

}  // namespace underbody::postproc
