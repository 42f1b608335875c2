// Kalman filter of a run of a coupled motion: likelihood of the readings, and the loads that a model lacks.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "surrogates/dynamics/simulate/measured_motion.h"

namespace underbody::discovery {

/// Noise of sensors and of what acts on the body.
struct MotionNoise {
    std::array<double, dynamics::most_states> white{};  ///< one standard deviation of a reading, state by state
    std::array<double, dynamics::most_states> slow{};   ///< of coloured noise beside it: places alone
    double slow_time = 0.2;                             ///< s, correlation time of all
    dynamics::MotionLoads load{};                       ///< N s^(1/2) or N m s^(1/2), white
    dynamics::MotionLoads walk{};  ///< N/s^(1/2) or N m/s^(1/2): loads that walk at random (residuals alone)
    /// Of a reading in all, one standard deviation.
    [[nodiscard]] double total(std::size_t state) const;
    [[nodiscard]] bool coloured() const;
};

/// Samples of a run that may be used: first to last.
struct MotionRecord {
    std::size_t run = 0;  ///< index into the data
    std::string name;
    std::size_t first = 0, last = 0;
    dynamics::MotionReadings readings;  ///< NaN where none, or not to be used
};

/// States of the filter at most: those of the motion, residual loads, coloured noise of the places.
inline constexpr std::size_t filter_states = dynamics::most_states + 2 * dynamics::most_loads;

/// What the filter did at each sample of a record, as plain numbers: for the smoother and for linear answers.
struct MotionTrace {
    using Column = std::array<double, filter_states>;
    using Square = std::array<double, filter_states * filter_states>;  ///< column-major, of as many as the motion has
    std::vector<Column> predicted, state;
    std::vector<Square> predicted_covariance, covariance;
    std::vector<Square> step;  ///< from this sample to the next, linear
    struct Update {
        std::size_t channel = 0;
        double delay = 0;  ///< s, of a place's reading
        double root = 1;   ///< standard deviation of the innovation
        Column gain{};
    };
    std::vector<std::vector<Update>> updates;
};

/// -2 log likelihood; whitened innovations are appended, one for each measured channel at each sample (0 where nothing
/// was read).
double filter_motion(dynamics::MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise,
                     std::vector<double>& innovations, MotionTrace* trace = nullptr);

/// A run about the path that the filter took, as far as a search of the noise needs it: with its steps held fixed the
/// filter is linear and asks the model nothing.
struct LinearMotionRun {
    double cost = 0;    ///< -2 log likelihood by the filter itself, at the noise of the path; 1e300 where it ran away
    MotionTrace trace;  ///< without covariances and updates
    std::vector<dynamics::MotionState> residual;  ///< reading less that of the path; NaN: none
    std::vector<double> width;                    ///< s, of the steps
    dynamics::MotionStart start;
    std::array<double, dynamics::most_states> delay{};  ///< s, of readings
    const dynamics::MotionShape* shape = nullptr;
};
LinearMotionRun linear_motion(dynamics::MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise);
/// -2 log likelihood of a linear run with this noise (without a walk of the loads).
double linear_cost(const LinearMotionRun& run, const MotionNoise& noise);

/// Change of the innovations by a small load at each sample of the record, to first order; appended.
void linear_answer(const dynamics::MotionShape& shape, const MotionTrace& trace, const MotionRecord& record,
                   std::size_t axis, const std::vector<double>& load, std::vector<double>& answer);

/// How fast loads may walk so that residuals follow this vehicle over seconds.
void walk_of_loads(const dynamics::MeasuredMotion& run, MotionNoise& noise);

/// A run smoothed (Rauch, Tung and Striebel 1965) with loads that walk at random beside the model's.
struct SmoothedMotion {
    std::vector<double> time;
    std::vector<std::array<double, dynamics::most_loads>> load, load_sigma;
    std::vector<dynamics::MotionState> state;
};
SmoothedMotion smooth_motion(dynamics::MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise);

}  // namespace underbody::discovery
