// The same run twice makes everything look more certain than it is.
#pragma once

#include "surrogates/dynamics/model/measurements.h"

namespace underbody::dynamics {

/// True where two runs of a time series have the same gap, input and other columns that both have, reading by reading.
bool same_readings(const MeasuredRun& a, const MeasuredRun& b);

/// What is said of a run that is left out because it repeats another.
core::Problem used_once(const MeasuredRun& repeated, const MeasuredRun& first);

/// Takes the runs of a time series out that repeat an earlier one, each with a warning among its problems.
void drop_repeated_runs(Measurements& data);

}  // namespace underbody::dynamics
