// What was wrong with a command line, and what was probably meant.
#pragma once

#include "core/error.h"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace underbody::studio {

/// The parser's complaint as an error that names the command, the word that was not understood and the nearest option
/// or command that there is.
core::UsageError usage_error(const CLI::App& app, const CLI::ParseError& complaint);

}  // namespace underbody::studio
