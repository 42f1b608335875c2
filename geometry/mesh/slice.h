// Plane cuts through a surface, as closed curves.
#pragma once

#include <vector>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

enum class Axis { x, y, z };

/// The curves where the plane (coordinate `axis` equal to `at`) cuts a closed surface; each repeats its first point at
/// its end. The plane is moved by a hair where it would meet a corner. Other coordinates in the order x, y, z.
std::vector<std::vector<Vec3>> slice(const SurfaceMesh& mesh, Axis axis, double at);

/// Lines between patches and along sharp edges (angle of the normals above `angle`, rad), each as far as it runs
/// without a fork; closed ones repeat their first point. Edges inside a patch `protrusion`, whose small curved flanks
/// a coarse mesh shows as facets, count from 40 degrees on.
std::vector<std::vector<Vec3>> feature_lines(const SurfaceMesh& mesh, double angle);

}  // namespace underbody::geometry
