// What kind of cell some faces make, in which order its nodes go, and how large it is.
#pragma once

#include <cstdint>
#include <vector>

namespace underbody::postproc {

/// VTK's numbers, so that the builder of cells needs none of its headers.
enum CellType : unsigned char {
    vtk_empty = 0,
    vtk_triangle = 5,
    vtk_polygon = 7,
    vtk_quad = 9,
    vtk_tetra = 10,
    vtk_hexahedron = 12,
    vtk_wedge = 13,
    vtk_pyramid = 14,
    vtk_polyhedron = 42
};

/// One face as a cell sees it.
struct FaceView {
    const std::uint32_t* nodes;
    std::uint32_t size;
    bool inward;  ///< the normal of the stored node order points into the cell

    /// Node i in an order whose normal points into (or out of) the cell.
    [[nodiscard]] std::uint32_t node(std::uint32_t i, bool into) const {
        return nodes[into == inward ? i : size - 1 - i];
    }
};

/// A cell that was looked at.
struct CellShape {
    std::vector<FaceView> faces;       ///< what it is made of; set by the caller
    std::vector<std::uint32_t> nodes;  ///< ids from 1, in VTK's order; of a polyhedron each once
    unsigned char type = vtk_empty;    ///< empty: the faces make no cell
    /// A hexahedron whose six faces all look the way they should: its nodes alone tell its volume.
    bool sound_hexahedron = false;
};

/// Sets type and nodes by the faces. What the file calls a polyhedron stays one, even if it has a hexahedron's faces.
void recognise(CellShape& cell, int dimension, bool called_polyhedron);

struct CellSize {
    double volume = 0;   ///< m^3 (2-D: m^2), by the divergence theorem over the faces, each at the mean of its nodes
    double area = 0;     ///< of all faces; 0 for a sound hexahedron, which is closed as it is made
    double opening = 0;  ///< size of the summed area vector
};

/// `points`: three coordinates a node. About the cell's own first node, for precision.
CellSize size_of(const CellShape& cell, const double* points, int dimension);

}  // namespace underbody::postproc
