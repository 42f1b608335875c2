// Declared noise held against the readings.
#pragma once

#include <optional>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// The same time series without the noise figures that the scatter of their readings contradicts (judged_noise()), so
/// that it is estimated; nothing where all hold. What is said of it goes to `remarks`.
std::optional<Measurements> without_doubtful_noise(const Model& model, const Measurements& data,
                                                   core::Problems& remarks);

}  // namespace underbody::dynamics
