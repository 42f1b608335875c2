// Surfaces out of files: STL (binary and ASCII), OBJ, PLY, VTP.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

struct MeshReadOptions {
    /// Unit of length of the file: "mm", "m", "in". These formats say none, so it must be given.
    std::optional<std::string> unit;
    /// Where the file names no patches, they are parted along edges sharper than this (rad), largest first: a flat one
    /// whose normal points down is called `base`, the largest other one `hull`, the rest `patch_3` and so on.
    double feature_angle = 0.3490658503988659;  // 20 deg
};

/// A surface as the file has it, in m; points that coincide (STL has each three times) are joined. Patches: the file's
/// own (solids, groups, a cell array `patch`) where it names two or more, else by feature edges. Throws
/// core::InputError: no unit (asks for --unit), another unit than of length, a file cut short (with the byte), faces
/// that name missing points, numbers that are not finite, nothing in it. Polygons are cut into triangles.
/// Whether the surface is closed is for `certify` to say.
SurfaceMesh read_mesh(const std::filesystem::path& path, const MeshReadOptions& options);

/// Parts a surface along its sharp edges and names the parts as above.
void find_patches(SurfaceMesh& mesh, double feature_angle);

}  // namespace underbody::geometry
