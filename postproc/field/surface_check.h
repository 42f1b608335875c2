// What is wrong with the faces of a surface, and how they meet.
#pragma once

#include <cstddef>

#include "core/progress.h"

class vtkPolyData;

namespace underbody::postproc {

/// Where the faces of a surface meet, by node numbers: two nodes at one place with two numbers are two nodes.
struct SurfaceEdges {
    std::size_t boundary = 0;      ///< edges with one face
    std::size_t inconsistent = 0;  ///< edges whose two faces run along them the same way
    std::size_t non_manifold = 0;  ///< edges with three faces or more
};

struct SurfaceCheck {
    SurfaceEdges edges;
    std::size_t zero_area = 0;        ///< faces whose area is nothing against the square of their size (1e-12)
    std::size_t first_zero_area = 0;  ///< index of the first of them
    std::size_t unused_nodes = 0;     ///< nodes that no face names
};

/// One pass over the polygons of a surface; linear in their number.
SurfaceCheck check_surface(vtkPolyData& surface, core::Progress& progress = core::Progress::none());

/// Makes the node order of neighbouring faces agree, each connected part like its first face. Returns the number of
/// faces that were turned; the values on faces stay where they are. The surface's polygons are replaced.
std::size_t make_consistent(vtkPolyData& surface, core::Progress& progress = core::Progress::none());

}  // namespace underbody::postproc
