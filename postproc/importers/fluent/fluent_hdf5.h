// Fluent's common fluids format: its two kinds of file into a face mesh and value blocks. The importer is in
// fluent_hdf5.cpp.
#pragma once

#include <filesystem>

#include "postproc/importers/fluent/fluent_settings.h"
#include "postproc/importers/mesh/face_mesh.h"

namespace underbody::postproc {

/// A case or mesh.
struct Hdf5Mesh {
    FaceMesh mesh;
    FluentSettings settings;
};

/// Reads .cas.h5 and .msh.h5. With `surfaces_only` neither the faces inside the mesh nor nodes that no surface uses are
/// kept. Throws InputError; where the mesh is damaged, an ImportError that says what was understood before.
Hdf5Mesh read_hdf5_mesh(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress);

/// Reads .dat.h5, keeping what the mesh has zones for and what is asked for. Throws InputError, also for data of
/// another mesh (by counts, ids). `problems` gets what is odd but harmless.
std::vector<ValueBlock> read_hdf5_data(const std::filesystem::path& path, const FaceMesh& mesh,
                                       const ReadOptions& options, FluentSettings& settings, core::Problems& problems,
                                       core::Progress& progress);

/// Adds the values on cells alone, for walls that have none of their own.
void add_hdf5_cells(const std::filesystem::path& path, const FaceMesh& mesh, const ReadOptions& options,
                    std::vector<ValueBlock>& values, core::Progress& progress);

/// The name at the end of a path that was written on whatever system.
std::string file_name_in(const std::string& path);

}  // namespace underbody::postproc
