// VTK's XML poly data. Internal.
#pragma once

#include <string>
#include <string_view>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

/// ASCII, inline base64 or appended raw arrays, uncompressed, little endian: what `write_mesh` writes and what ParaView
/// writes with compression off. Throws core::InputError.
SurfaceMesh read_vtp(std::string_view bytes, const std::string& file);

}  // namespace underbody::geometry
