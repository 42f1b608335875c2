// A session on disk (NAME.ubs, JSON): the state with paths relative to the file, and what the inputs were.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studio/desktop/state/state.h"

namespace underbody::studio {

/// Writes the state whole. Paths are relative to the file's folder; the content hash of each input stands beside it.
/// Keys of an earlier file at that place that this program does not know stay.
void write_session(const State& state, const std::filesystem::path& file);

/// Where the window keeps what was last seen of a study.
std::filesystem::path kept_session(const std::filesystem::path& study);

struct SavedSession {
    State state;  ///< paths absolute
    /// Inputs that are not there (as absolute paths): `locate OLD NEW` says where they are now.
    std::vector<std::string> missing;
    core::Problems problems;  ///< missing and changed inputs
};
/// Throws core::InputError: no JSON, no session, one of a later version.
SavedSession read_session(const std::filesystem::path& file);

}  // namespace underbody::studio
