// Whether a PLY file holds all that its header announces: VTK's reader takes what is missing from whatever is in memory.
#pragma once

#include <filesystem>

namespace underbody::postproc {

/// Throws InputError with the byte where a PLY file ends too early, or the line of a header that makes no sense.
void check_ply(const std::filesystem::path& path);

}  // namespace underbody::postproc
