// What a motion rests on that neither its model nor its runs say.
#pragma once

#include <string>

#include "core/error.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// A warning that laws of drag and the friction of the ground count as 0 where the model neither declares them (a
/// declared 0 is one) nor has a table or an effect in their place. Of the motion on the ground: drag in surge, sway and
/// yaw, contact.friction.
core::Problems taken_as_zero_on_ground(const Model& model);
/// Of the whole body: drag in all directions, and contact.friction where it `touches` the ground.
core::Problems taken_as_zero_of_body(const Model& model, bool touches);
/// A warning of runs of heave (with pitch) that say nothing of what pushed them: neither a column nor a condition
/// input_force, and no voltage or flow of a jet that drives a force of the model. None is taken to act on them then;
/// columns that may be meant for it are named.
core::Problems input_taken_as_zero(const Model& model, const Measurements& data);
/// What applies to the motion that measured runs are of: "heave", "heave_pitch", "surface", "body".
core::Problems taken_as_zero(const std::string& motion, const Model& model, const Measurements& data);

}  // namespace underbody::dynamics
