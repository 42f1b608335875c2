// Readers of other libraries meet an unknown file in a child process first: what makes them crash or run for ever does
// not take the program with it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/progress.h"

namespace underbody::postproc {

/// Runs `read` in a child process, with time and memory that the size of `path` justifies, and gives what it returns
/// (empty when it throws: whether it does is not looked at). Throws InputError when the child crashes or exceeds them.
/// Throws core::Cancelled, and ends the child, when `progress` is cancelled.
std::string report_of_child(const std::filesystem::path& path, const std::function<std::string()>& read,
                            core::Progress& progress = core::Progress::none());

/// The same for what has nothing to report.
void try_in_child(const std::filesystem::path& path, const std::function<void()>& read,
                  core::Progress& progress = core::Progress::none());

}  // namespace underbody::postproc
