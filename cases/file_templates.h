// The files that a user writes: their formats, and templates to begin with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/file_format.h"

namespace underbody::cases {

/// shape, study, model, dataset.
const std::vector<const core::FileFormat*>& file_formats();

/// Throws core::UsageError with the nearest name.
const core::FileFormat& file_format(const std::string& name);

/// Writes a commented file that its reader accepts as it stands (a data set with its first run, example numbers), and
/// returns what was written. `path` empty: the usual name in the current folder; a folder: the usual name in it.
/// Throws core::UsageError: unknown format; core::InputError (kind "exists"): a file is there already, nothing is
/// written.
std::vector<std::filesystem::path> write_template(const std::string& format, const std::filesystem::path& path = {});

}  // namespace underbody::cases
