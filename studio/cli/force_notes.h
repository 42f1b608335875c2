// What stands beside every number that a model's force tables make.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::studio {

class Shell;

/// Prints how each force of the model was fitted, and a warning for each condition that is held outside a table; the
/// same as `forces` and `warnings` in the JSON. `held`: what is given over the model's conditions. What scales a force
/// (speed, voltage), is none of the `moving` and is given by nobody is said too, as `held_at_reference`.
void show_forces(Shell& shell, const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json,
                 const std::vector<dynamics::Channel>& moving = {});

/// What scales a force, is none of the `moving` and is given by nobody: said, and returned for `held_at_reference` of
/// the JSON. For commands that do not show the fits.
std::vector<std::string> show_held_at_reference(Shell& shell, const dynamics::Model& model,
                                                const dynamics::Conditions& held,
                                                const std::vector<dynamics::Channel>& moving = {});

/// Says the warnings of the model's force tables alone (points that have not settled, outliers, ...) and returns
/// them for `warnings` of the JSON: for commands whose numbers rest on the tables and that do not show the fits. What
/// lies outside the tables: conditions, `held` over the model's own, or what was measured.
std::vector<std::string> show_table_warnings(Shell& shell, const dynamics::Model& model,
                                             const dynamics::Conditions& held = {});
std::vector<std::string> show_table_warnings(Shell& shell, const dynamics::Model& model,
                                             const dynamics::Measurements& data);

/// A table that is a result, with the warnings so far in its comments.
core::Table commented(Shell& shell, core::Table table);

}  // namespace underbody::studio
