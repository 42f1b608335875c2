// Readers of other libraries meet an unknown file in a child process first: what makes them crash or run for ever does
// not take the program with it.
#pragma once

#include <filesystem>
#include <functional>

namespace underbody::postproc {

/// Runs `read` in a child process, with time and memory that the size of `path` justifies. Throws InputError when the
/// child crashes or exceeds them; whether `read` throws is not looked at.
void try_in_child(const std::filesystem::path& path, const std::function<void()>& read);

}  // namespace underbody::postproc
