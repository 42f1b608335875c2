// The length of a prediction against that of the runs.
#pragma once

#include <functional>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::dynamics {

/// s, from the first sample of the longest run to its last.
double longest_run(const Measurements& data);

/// s, of measurements before a window's start that its state is estimated from.
double time_before(const PredictOptions& options);

/// Says that every run is shorter than the horizon, where it is so, and how long a prediction is then.
void remark_long_horizon(const Measurements& data, const PredictOptions& options, Prediction& out);

/// For runs of which no prediction could be made: `predict` over a quarter of the longest, where that is shorter than
/// the horizon asked for, and said so. Throws core::InputError where it is not, or the runs are sampled too coarsely.
Prediction predict_shorter(const Measurements& data, const PredictOptions& options,
                           const std::function<Prediction(const PredictOptions&)>& predict);

}  // namespace underbody::dynamics
