// Closed surfaces of known shape, to test and compare with.
#pragma once

#include <cstddef>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

/// The whole ellipsoid about the origin, about so many triangles, points on it, symmetric in y to the last bit; patch
/// `hull`.
SurfaceMesh ellipsoid_surface(double a, double b, double c, std::size_t triangles);

}  // namespace underbody::geometry
