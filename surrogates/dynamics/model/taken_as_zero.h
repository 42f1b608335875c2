// What a motion rests on that its model does not say.
#pragma once

#include <string>

#include "core/error.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// A warning that laws of drag and the friction of the ground count as 0 where the model neither declares them (a
/// declared 0 is one) nor has a table or an effect in their place. Of the motion on the ground: drag in surge, sway and
/// yaw, contact.friction.
core::Problems taken_as_zero_on_ground(const Model& model);
/// Of the whole body: drag in all directions, and contact.friction where it `touches` the ground.
core::Problems taken_as_zero_of_body(const Model& model, bool touches);
/// Of the motion that measured runs are of: "surface", "body"; nothing of others.
core::Problems taken_as_zero(const std::string& motion, const Model& model);

}  // namespace underbody::dynamics
