// The noise of a sensor, estimated from its own readings: one estimate for predictions, filters and discovery.
#pragma once

#include <span>

namespace underbody::dynamics {

/// The step of a sensor that rounds: the grid on which nearly all readings lie when a fifth of them or more repeat the
/// one before. 0 when there is none.
double reading_step(std::span<const double> values);

/// One standard deviation of white noise on a smooth signal, from differences between neighbours with a robust middle
/// (so that outliers and kinks do not count): of second or third order, whichever gives less, since what a motion adds
/// only ever makes one larger. Differences over unequal steps of `time` (empty: all equal) do not count where enough
/// others are left, nor do missing values. Of a sensor that rounds at least that of its steps, step/sqrt(12). NaN with
/// fewer than six differences.
double sensor_noise(std::span<const double> time, std::span<const double> values);

}  // namespace underbody::dynamics
