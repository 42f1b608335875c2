// Do triangles of a surface run through each other? Exact answers (CGAL's predicates), a tree of boxes before them.
#pragma once

#include <utility>
#include <vector>

#include "core/progress.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

/// Pairs of triangles that have more in common than the corners or the edge they share; at most `limit` of them.
/// Triangles without area are their own pair. Deterministic.
std::vector<std::pair<std::size_t, std::size_t>> self_intersections(const SurfaceMesh& mesh, std::size_t limit = 16,
                                                                    core::Progress& progress = core::Progress::none());

}  // namespace underbody::geometry
