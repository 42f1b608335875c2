// What the integrators of heave and pitch share.
#pragma once

#include "surrogates/dynamics/simulate/heave_pitch.h"

namespace underbody::dynamics {

/// Puts edges that are in the ground onto it, carries out the impact if one strikes (true), and finds the contact state
/// from here on.
bool land(const HeavePitch& plant, PitchState& y, ContactState& bearing, const Surroundings& around = {});

}  // namespace underbody::dynamics
