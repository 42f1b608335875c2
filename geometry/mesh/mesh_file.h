// Surfaces into files and out of them: STL (binary, ASCII), OBJ, PLY, VTP.
#pragma once

#include <filesystem>
#include <string>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

enum class MeshFormat { stl_binary, stl_ascii, obj, ply, vtp };

/// By the ending (.stl is binary). Throws core::UsageError that names the known endings.
MeshFormat mesh_format_of(const std::filesystem::path& path);

/// `scale` multiplies the coordinates (1000 writes millimetres). STL binary holds float32 and no patches; STL ASCII has
/// one solid a patch, OBJ one group a patch, PLY (binary, double) an integer `patch`, VTP (binary appended, double) the
/// cell array `patch` and a field array with the names.
std::string mesh_bytes(const SurfaceMesh& mesh, MeshFormat format, double scale = 1);
/// The same as a file, `mesh` in m; the format by the ending unless it is given. Throws core::UsageError (an unknown
/// ending), core::SystemError (it cannot be written).
void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, double scale = 1);
void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, MeshFormat format, double scale);

}  // namespace underbody::geometry
