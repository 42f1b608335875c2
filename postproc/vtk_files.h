// Fields as VTK files: SI, canonical names, units and origin in the file.
#pragma once

#include <filesystem>
#include <vector>

#include "core/progress.h"
#include "postproc/field.h"

namespace underbody::postproc {

/// By the ending: .vtp all surfaces in one (cell array `zone`), .vtu everything in one, .vtm one block a zone (files in
/// a folder of the same name). Written whole or not at all. Returns what was left out (arrays that not all zones have).
/// Throws core::UsageError for another ending, core::InputError when the field has nothing that fits the ending.
core::Problems write_vtk(const Field& field, const std::filesystem::path& path, core::Progress& progress = core::Progress::none());

}  // namespace underbody::postproc
