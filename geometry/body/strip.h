// Strips of triangles between two chains of points.
#pragma once

#include <vector>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

using Chain = std::vector<std::int32_t>;

/// Fills the strip between `lower` and `upper` (both run to the right when seen from outside with `lower` below; either
/// may be a single point), choosing at each step the shorter diagonal.
void fill_strip(SurfaceMesh& mesh, const Chain& lower, const Chain& upper, std::int32_t patch);

}  // namespace underbody::geometry
