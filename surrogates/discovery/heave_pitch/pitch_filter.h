// Kalman filter of a run in heave and pitch: likelihood of the readings, and the force and moment that a model lacks.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "surrogates/dynamics/simulate/pitch_run.h"

namespace underbody::discovery {

/// Noise of sensors and of what acts on the body.
struct PitchNoise {
    std::array<double, dynamics::pitch_states> white{};  ///< one standard deviation of a reading, state by state
    double gap_slow = 0;                                 ///< m, standard deviation of coloured noise of the gap
    double pitch_slow = 0;                               ///< rad
    double slow_time = 0.2;                              ///< s, correlation time of both
    double force = 0;                                    ///< N s^(1/2), white force on the body
    double moment = 0;                                   ///< N m s^(1/2)
    double force_walk = 0;                               ///< N/s^(1/2): a force that walks at random (residuals alone)
    double moment_walk = 0;                              ///< N m/s^(1/2)
    /// Of a reading in all, one standard deviation.
    [[nodiscard]] double total(std::size_t state) const;
};

/// Samples of a run that may be used: first to last.
struct PitchRecord {
    std::size_t run = 0;  ///< index into the data
    std::string name;
    std::size_t first = 0, last = 0;
    std::array<std::vector<double>, dynamics::pitch_states> value;  ///< readings; NaN where none, or not to be used
};

/// States of the filter: gap, heave velocity, pitch, pitch rate, residual force, residual moment, coloured noise of gap
/// and of pitch.
inline constexpr std::size_t filter_states = 8;

/// What the filter did at each sample of a record, as plain numbers: for the smoother and for linear answers.
struct PitchTrace {
    using Column = std::array<double, filter_states>;
    using Square = std::array<double, filter_states * filter_states>;  ///< column-major
    std::vector<Column> predicted, state;
    std::vector<Square> predicted_covariance, covariance;
    std::vector<Square> step;  ///< from this sample to the next, linear
    struct Update {
        std::size_t channel = 0;
        double delay = 0;  ///< s, of the gap's reading
        double root = 1;   ///< standard deviation of the innovation
        Column gain{};
    };
    std::vector<std::vector<Update>> updates;
};

/// -2 log likelihood; whitened innovations are appended, one for each measured channel at each sample (0 where nothing
/// was read).
double filter_pitch(dynamics::PitchRun& run, const PitchRecord& record, const PitchNoise& noise,
                    std::vector<double>& innovations, PitchTrace* trace = nullptr);

/// A run about the path that the filter took, as far as a search of the noise needs it: with its steps held fixed the
/// filter is linear and asks the model nothing.
struct LinearPitchRun {
    double cost = 0;   ///< -2 log likelihood by the filter itself, at the noise of the path; 1e300 where it ran away
    PitchTrace trace;  ///< without covariances and updates
    std::vector<std::array<double, dynamics::pitch_states>> residual;  ///< reading less that of the path; NaN: none
    std::vector<double> width;                                         ///< s, of the steps
    std::array<double, 2> slope_factor{};                              ///< of the start, gap and pitch
    double delay = 0;                                                  ///< s, of the gap's reading
};
LinearPitchRun linear_pitch(dynamics::PitchRun& run, const PitchRecord& record, const PitchNoise& noise);
/// -2 log likelihood of a linear run with this noise (without a walk of the loads).
double linear_cost(const LinearPitchRun& run, const PitchNoise& noise);

/// Change of the innovations by a small force (axis 0) or moment (axis 1) at each sample of the record, to first order;
/// appended.
void linear_answer(const PitchTrace& trace, const PitchRecord& record, std::size_t axis,
                   const std::vector<double>& load, std::vector<double>& answer);

/// How fast force and moment may walk so that residuals follow a vehicle of this mass and inertia over seconds.
void walk_of_loads(const dynamics::HeavePitch& plant, PitchNoise& noise);

/// A run smoothed (Rauch, Tung and Striebel 1965) with a force and a moment that walk at random beside the model's.
struct SmoothedPitchRun {
    std::vector<double> time, force, moment;  ///< s, N up, N m nose up
    std::vector<double> force_sigma, moment_sigma;
    std::vector<dynamics::PitchState> state;
};
SmoothedPitchRun smooth_pitch(dynamics::PitchRun& run, const PitchRecord& record, const PitchNoise& noise);

}  // namespace underbody::discovery
