// Shared by the writers of solver cases. Internal.
#pragma once

#include <filesystem>
#include <string>

namespace underbody::geometry {

/// Throws core::InputError (kind "exists") when the folder is there and holds something, or is a file.
void require_empty_folder(const std::filesystem::path& folder);

/// Twelve significant digits, as every solver reads them.
std::string digits(double value);

}  // namespace underbody::geometry
