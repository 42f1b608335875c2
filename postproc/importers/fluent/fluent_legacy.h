// Legacy Fluent files: sections into a face mesh and value blocks. The importer is in fluent_legacy_importer.cpp.
#pragma once

#include "postproc/importers/fluent/fluent_settings.h"
#include "postproc/importers/fluent/fluent_text.h"
#include "postproc/importers/mesh/face_mesh.h"

namespace underbody::postproc {

/// A case or mesh.
struct LegacyMesh {
    FaceMesh mesh;
    FluentSettings settings;
};

/// Reads .msh and .cas, ASCII and binary. With `surfaces_only` the faces inside the mesh are not kept.
LegacyMesh read_legacy_mesh(ByteStream& in, bool surfaces_only, core::Progress& progress);

/// Reads .dat, keeping what the mesh has zones for. Refuses data of another mesh (by counts, zones, ids).
/// `problems` gets what is odd but harmless.
std::vector<ValueBlock> read_legacy_data(ByteStream& in, const FaceMesh& mesh, const ReadOptions& options,
                                         FluentSettings& settings, core::Problems& problems, core::Progress& progress);

}  // namespace underbody::postproc
