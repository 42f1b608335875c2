// The noise of a sensor, estimated from its own readings: one estimate for predictions, filters and discovery.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace underbody::dynamics {

/// s: times that differ by less are one; a reading so late belongs to a window that ends with it.
constexpr double same_instant = 1e-9, window_slack = 1e-6;

/// What a sensor of gap, and one of speed, is taken to scatter by where its readings do not say; m, m/s.
constexpr double usual_gap_noise = 1e-4, usual_velocity_noise = 1e-3;

/// The step of a sensor that rounds: the grid on which nearly all readings lie when a fifth of them or more repeat the
/// one before. 0 when there is none.
double reading_step(std::span<const double> values);

/// One standard deviation of white noise on a smooth signal, from differences between neighbours with a robust middle
/// (so that outliers and kinks do not count): of second or third order, whichever gives less, since what a motion adds
/// only ever makes one larger. Differences over unequal steps of `time` (empty: all equal) do not count where enough
/// others are left, nor do missing values. Of a sensor that rounds at least that of its steps, step/sqrt(12). NaN with
/// fewer than six differences.
double sensor_noise(std::span<const double> time, std::span<const double> values);

/// The noise of a channel as declared, unless its readings say otherwise.
struct JudgedNoise {
    double value = 0;
    std::string from;   ///< "declared", "estimated", "estimated: the scatter ... times the declared figure"
    std::string doubt;  ///< a sentence where the two disagree: the scatter is used; empty where they do not
};
/// `estimated`: the middle of sensor_noise() of the runs; not above 0: it is not known.
JudgedNoise judged_noise(const std::string& channel, std::optional<double> declared, double estimated);

/// What errors of a channel are told in, its unit: the declared deviation of one reading unless what was `found` is
/// larger than it allows. Coloured noise scatters less from reading to reading than it is large, so that less says
/// nothing against it.
double unit_of_errors(std::optional<double> declared, double found);

}  // namespace underbody::dynamics
