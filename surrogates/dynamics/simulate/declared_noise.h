// Declared noise held against the readings.
#pragma once

#include <optional>
#include <string>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// The median over the runs of sensor_noise() of a channel, as read, in its unit; a reading at the end of the gap's
/// range has none. 0 where no run has readings enough.
double scatter_of(const Model& model, const Measurements& data, const std::string& channel);

/// The same time series without the noise figures that the scatter of their readings contradicts (judged_noise()), so
/// that it is estimated; nothing where all hold. What is said of it goes to `remarks`.
std::optional<Measurements> without_doubtful_noise(const Model& model, const Measurements& data,
                                                   core::Problems& remarks);

}  // namespace underbody::dynamics
