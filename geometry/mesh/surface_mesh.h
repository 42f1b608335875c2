// A triangulated surface with named patches: the plain value that geometry gives to every other room.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh/vec3.h"

namespace underbody::geometry {

using Triangle = std::array<std::int32_t, 3>;

/// Metres. Axes of a body: x forward (nose), y to port, z up, which are the default axes of CFD files
/// (`--forward +x --up +z`). A body as made has its origin at the centre of its flat base (mid-length, mid-width) with
/// the body above z = 0; a placed body (`geometry/water/placement.h`) has the ground at z = 0.
/// Triangles turn counter-clockwise seen from the water: their normals point out of the body.
struct SurfaceMesh {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
    /// Index into `patch_names`, one for each triangle.
    std::vector<std::int32_t> patch;
    std::vector<std::string> patch_names;

    [[nodiscard]] const Vec3& corner(std::size_t triangle, std::size_t which) const {
        return points[static_cast<std::size_t>(triangles[triangle][which])];
    }
    /// Half the cross product of two edges: length is the triangle's area (m^2), direction its outward normal.
    [[nodiscard]] Vec3 area_vector(std::size_t triangle) const {
        const Vec3& a = corner(triangle, 0);
        return 0.5 * cross(corner(triangle, 1) - a, corner(triangle, 2) - a);
    }
    [[nodiscard]] Vec3 centre(std::size_t triangle) const {
        return (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3.0;
    }
};

struct Box {
    Vec3 lower;
    Vec3 upper;
};
/// Of all points; zeros for an empty mesh.
Box bounding_box(const SurfaceMesh& mesh);

struct PatchSummary {
    std::string name;
    double area = 0;  ///< m^2
    std::size_t faces = 0;
};
std::vector<PatchSummary> patches(const SurfaceMesh& mesh);
/// m^2
double area(const SurfaceMesh& mesh);

/// The triangles of one patch with the points they use, in their order. Throws core::InputError with the nearest name.
SurfaceMesh patch_of(const SurfaceMesh& mesh, const std::string& name);

/// The surface and its mirror image in y = 0: points with y = 0 (exactly) are shared, all else is doubled and turned,
/// so that the result is symmetric to the last bit.
SurfaceMesh with_mirror_image(const SurfaceMesh& half);

/// The part with y >= 0 of a surface made by `with_mirror_image` (every triangle lies on one side).
/// Throws core::InputError when a triangle crosses the plane.
SurfaceMesh port_half(const SurfaceMesh& whole);

/// True when each edge belongs to exactly two triangles that run through it in opposite directions.
bool is_watertight(const SurfaceMesh& mesh);

}  // namespace underbody::geometry
