// The length of a prediction against that of the runs.
#pragma once

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::dynamics {

/// s, from the first sample of the longest run to its last.
double longest_run(const Measurements& data);

/// s, of measurements before a window's start that its state is estimated from.
double time_before(const PredictOptions& options);

/// Says that every run is shorter than the horizon, where it is so, and how long a prediction is then.
void remark_long_horizon(const Measurements& data, const PredictOptions& options, Prediction& out);

/// For runs of which no prediction could be made: shorter than it, or sampled too coarsely for it.
core::InputError no_prediction(const Measurements& data, const PredictOptions& options);

}  // namespace underbody::dynamics
