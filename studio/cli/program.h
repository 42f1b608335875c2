// The command line as a tree of commands, for the program and for those who run commands in their own process.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace underbody::studio {

class Shell;

/// All commands with their options; `only` (a command's name): that one alone.
void add_commands(CLI::App& app, Shell& shell, const std::string& only = {});

}  // namespace underbody::studio
