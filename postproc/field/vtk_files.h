// Fields as VTK files: SI, canonical names, units and origin in the file.
#pragma once

#include <filesystem>

#include "core/progress.h"
#include "postproc/field/field.h"

namespace underbody::postproc {

/// By the ending: .vtp all surfaces in one, .vtu all volumes in one, or all surfaces where there are no volumes, .vtm
/// one block a zone (files in a folder of the same name). The cell array `zone` tells zones apart, arrays are
/// not-a-number on zones that do not have them, and a description (vtk_description.h) keeps what is known of the zones.
/// Written whole or not at all. Returns what was left out or filled. Throws core::UsageError for another ending,
/// core::InputError when the field has nothing that fits the ending.
core::Problems write_vtk(const Field& field, const std::filesystem::path& path,
                         core::Progress& progress = core::Progress::none());

/// Throws core::UsageError when the ending is none that `write_vtk` writes.
void check_vtk_ending(const std::filesystem::path& path);

}  // namespace underbody::postproc
