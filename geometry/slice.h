// Plane cuts through a surface, as closed curves.
#pragma once

#include <vector>

#include "geometry/surface_mesh.h"

namespace underbody::geometry {

enum class Axis { x, y, z };

/// The curves where the plane (coordinate `axis` equal to `at`) cuts a closed surface; each repeats its first point at
/// its end. The plane is moved by a hair where it would meet a corner. Other coordinates in the order x, y, z.
std::vector<std::vector<Vec3>> slice(const SurfaceMesh& mesh, Axis axis, double at);

/// Edges between triangles of different patches and sharp edges (angle of the normals above `angle`, rad), as pairs.
std::vector<std::array<Vec3, 2>> feature_edges(const SurfaceMesh& mesh, double angle);

}  // namespace underbody::geometry
