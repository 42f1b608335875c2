// Numbers of a model that are other than in its file, for the commands that take a model.
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/model/model.h"

namespace underbody::studio {

/// Help of --set.
const char* set_help();

/// The model of the file with every NAME=VALUE of --set (a declared number by its dotted name, with a unit). Throws
/// core::UsageError: no number, another unit, beyond its bounds; core::InputError: an unknown name, with the nearest.
dynamics::Model model_with(const std::string& file, const std::vector<std::string>& set);

}  // namespace underbody::studio
