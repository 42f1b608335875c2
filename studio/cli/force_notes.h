// What stands beside every number that a model's force tables make.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "surrogates/dynamics/model/model.h"

namespace underbody::studio {

class Shell;

/// Prints how each force of the model was fitted, and a warning for each condition that is held outside a table; the
/// same as `forces` and `warnings` in the JSON. `held`: what is given over the model's conditions.
void show_forces(Shell& shell, const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json);

}  // namespace underbody::studio
