// What a reader of a model's numbers must know of its force tables: how each was fitted, and where they are asked
// beyond what they cover.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// One line a force: "lift_force of lift.csv: Gaussian process through 15 points".
std::vector<std::string> fit_lines(const Model& model);
/// The same as a list: quantity, table, kind, points, remarks.
nlohmann::json fits_json(const Model& model);

/// A warning for every held condition that lies outside an axis of a force table: the table holds its end value there.
/// `held`: what is given over the model's own conditions; what varies in the motion is not among them.
core::Problems held_outside(const Model& model, const Conditions& held);

/// A note for every condition that scales a force and that nobody gives: the force is that at the scale's reference.
/// Not of `moving` channels, which the motion or a signal gives; `held` as above.
core::Problems held_at_reference(const Model& model, const Conditions& held, const std::vector<Channel>& moving);

/// A warning for every condition given for a motion that nothing of the model depends on (jet_voltage where no force
/// scales with it), and for a speed astern, at which a force that scales with speed is that of the same speed ahead.
core::Problems held_in_vain(const Model& model, const Conditions& given);

/// A warning for every force table most of whose points lie at gaps of more than ten lengths of the vehicle:
/// millimetres that were taken for metres.
core::Problems gaps_of_another_size(const Model& model);

/// The same of what was measured: a warning for every axis of a force table beyond which measured values lie (columns,
/// conditions of the runs, else the model's), with the range that they have there and in how many rows. Not of the gap
/// of a time series: predictions, estimates and discovery say themselves what becomes of its readings outside.
core::Problems runs_outside(const Model& model, const Measurements& data);

}  // namespace underbody::dynamics
