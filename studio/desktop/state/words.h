// Lines of words, quoted as a POSIX shell has them: what the log and the command lines are written in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace underbody::studio {

using Words = std::vector<std::string>;

/// Joined by spaces; a word that a shell would read otherwise stands in single quotes.
std::string line_of(const Words& words);

/// The way back: single and double quotes, backslash, '#' at the start of a word begins a comment. Throws
/// core::InputError for a quote that is never closed.
Words words_of(std::string_view line);

}  // namespace underbody::studio
