// The commands and options that there are, as data: for shell completion and for the functions of the Python module.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
}

namespace underbody::studio {

/// {name, description, examples, needs_command, positionals [{name, description, required, several}],
///  options [{names, description, flag, required, several, kind, choices}], commands [...]}. `kind`: "number", "text".
nlohmann::json option_tree(const CLI::App& app);

}  // namespace underbody::studio
