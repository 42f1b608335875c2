// Waves are looked for at many frequencies: which of them would explain most of the innovations, and with which
// numbers.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "surrogates/discovery/hypothesis.h"

namespace underbody::discovery {

/// A wave that is small: what it would explain, and with which numbers.
struct WaveLine {
    double frequency = 0, gain = 0, amplitude = 0, phase = 0;
};
/// From what a force of 1 N takes from the innovations, as a sine and as a cosine over time.
WaveLine wave_line(double frequency, const std::vector<double>& sine, const std::vector<double>& cosine,
                   const std::vector<double>& innovations);

/// Innovations of a run: so many channels at each of these times.
struct SampledRun {
    std::vector<double> time;
    std::size_t channels = 1;
    std::size_t begin = 0;  ///< of its innovations
};
/// Hz: a period that no run shows twice cannot be told from any other slow change.
double lowest_frequency(const std::vector<SampledRun>& runs);

/// Frequencies that explain most, with amplitude and phase: starts for the hypothesis.
std::vector<std::vector<double>> wave_starts(const std::vector<SampledRun>& runs,
                                             const std::vector<double>& innovations,
                                             const std::function<WaveLine(double frequency)>& line_at,
                                             std::size_t count);

/// Begins every hypothesis that is scanned at `starts()`, and takes those out that have none.
void begin_scanned(std::vector<Hypothesis>& list, const std::function<std::vector<std::vector<double>>()>& starts);

}  // namespace underbody::discovery
