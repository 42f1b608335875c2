// The closed forms of this room, for people and tests: films between base and ground, jets, scaling, drag, the surface
// run. Each calls the function that the models themselves use. Frame: the vertical channel, forces positive up; SI.
#pragma once

#include <vector>

#include "core/closed_form.h"

namespace underbody::dynamics {

/// Films (slider, wedge, radial, jet_film, squeeze, jet), then the vehicle (coefficients, spring, scaling, voltage,
/// drag, jets, munk, surface, kinematics).
const std::vector<core::ClosedForm>& closed_forms();

/// The two lists that it is made of.
std::vector<core::ClosedForm> film_forms();
std::vector<core::ClosedForm> vehicle_forms();

}  // namespace underbody::dynamics
