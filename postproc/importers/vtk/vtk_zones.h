// VTK data as zones: names, units, sides, one zone a leaf.
#pragma once

#include <vtkDataObject.h>

#include <filesystem>
#include <string>

#include "postproc/field/field.h"

namespace underbody::postproc {

/// The zones of what was read from a file: grids with cells that have a volume are volumes; faces are surfaces, but for
/// those of a plane flow. Throws core::InputError when there are no points in it.
Field field_from_vtk(const std::filesystem::path& path, const std::string& format, vtkDataObject* object,
                     const ReadOptions& options, core::Progress& progress);

}  // namespace underbody::postproc
