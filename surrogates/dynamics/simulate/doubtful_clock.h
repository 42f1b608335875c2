// Is the clock of measured runs the model's? Seconds that were headed minutes, or milliseconds.
#pragma once

#include <optional>

#include "core/error.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// A warning where the accelerations of recorded heave are not those that the model's forces give at the recorded gaps,
/// velocities and inputs, and would be with times of another unit. Accelerations are compared as averages over windows
/// under a weight that goes to nought at both ends with its slope, so that the gap is not differentiated and hardly any
/// of its noise is left. Nothing where both fit, or neither: a model that lacks much does not doubt a clock.
std::optional<core::Problem> doubtful_clock(const Model& model, const Measurements& data);

}  // namespace underbody::dynamics
