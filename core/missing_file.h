// What to say of a file that is not there.
#pragma once

#include <filesystem>
#include <string>

namespace underbody::core {

/// "did you mean 'X'?" when a file in the same folder is near in name; else empty.
std::string hint_for_missing(const std::filesystem::path& path);

}  // namespace underbody::core
