// The declared heave equation inside the experiment: an extended Kalman filter over the recorded input, whose
// innovations are the residuals that every hypothesis is judged by.
#pragma once

#include <span>
#include <vector>

#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/heave/heave_record.h"
#include "surrogates/dynamics/plant/heave_equation.h"

namespace underbody::discovery {

/// What is random in an experiment. All estimated from the data by maximum likelihood unless declared.
struct HeaveNoise {
    double gap = 2e-4;       ///< m, white, of a single reading
    double velocity = 1e-3;  ///< m/s, white, of a single reading
    double process = 1e-9;   ///< m^2/s^3, density of white acceleration: the disturbances nobody measured
    double slow = 0;         ///< m, standard deviation of coloured noise on the gap (first-order)
    double slow_time = 0.3;  ///< s, its correlation time
};

/// A smooth force without a law: sum of coefficients times FlexibleBasis functions of gap, velocity, time or input.
struct FlexibleForce {
    enum class Variable { gap, heave_velocity, time, input_force };
    std::vector<Variable> variables;
    FlexibleBasis basis;
    std::vector<double> coefficients;  ///< N, one per column
    std::vector<double> mix;  ///< column-major: coefficients of forces that are orthonormal over the states seen
    /// Numbers in N, root mean square over the states seen, of each of those forces.
    void set(std::span<const double> numbers) {
        coefficients.assign(coefficients.size(), 0);
        for (std::size_t j = 0; j < numbers.size(); ++j) {
            for (std::size_t k = 0; k <= j; ++k) {
                coefficients[k] += mix[j * coefficients.size() + k] * numbers[j];
            }
        }
    }
    /// Holds the force constant beyond what was seen; of the input, and of the velocity beside the gap, beyond half as
    /// far again.
    std::vector<double> lower, upper;
    [[nodiscard]] double operator()(double h, double w, double t, double u) const {
        double slope_h = 0;
        double slope_w = 0;
        return value(h, w, t, u, slope_h, slope_w);
    }
    /// Adds its slopes along gap and velocity to what is there.
    double value(double h, double w, double t, double u, double& slope_h, double& slope_w) const;
};

/// One explanation, ready to run.
struct HeaveExplanation {
    dynamics::HeaveTerms terms;  ///< of the model with the hypothesis' effects (its sources are not used)
    double lift_gain = 1;        ///< further factor on the lift table
    const FlexibleForce* flexible = nullptr;
    bool hold = true;  ///< the recorded input is held from sample to sample (digital controller); else linear between
};

/// How a step of the heave equation changes small differences of (gap, velocity).
struct HeaveTransition {
    double hh = 1, hw = 0, wh = 0, ww = 1;
};
/// One step of dt seconds, exact for the equation linearised where it begins (exponential Rosenbrock-Euler, Hochbruck
/// and Ostermann 2010), its matrix functions cut after four terms: moves gap h and velocity w of the acceleration `a`
/// there. Good while dt times the stiffness of `slopes` is below one.
HeaveTransition short_step(double dt, double a, const dynamics::HeaveSlopes& slopes, double& h, double& w);
/// The larger of |slope along w| and the root of that along h, 1/s.
double stiffness_of(const dynamics::HeaveSlopes& slopes);

/// Fills held_input and linear_input from the recorded input: to be called whenever that was changed.
void prepare_input(HeaveRecord& record);

/// Recorded input as the body feels it (delay, dead zone, gain, lag): input[k] is its mean from the record's time k-1
/// to k. A record without held_input is worked out from its raw input.
void transform_input(const HeaveRecord& record, const HeaveExplanation& explanation, std::vector<double>& input);

/// Runs the filter over one record. Appends the normalised innovations (gap, then velocity when measured, of each step;
/// 0 where there was no reading, so that the length never changes) and returns sum log S of the readings there were.
/// `states`, when given, gets the filtered (gap, velocity) of each step, one after the other; `memories` the
/// history_states numbers of the history force's memory.
double filter_innovations(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
                          std::vector<double>& innovations, std::vector<double>* states = nullptr,
                          std::vector<double>* memories = nullptr);

/// Smoothed states of one record (Rauch, Tung and Striebel 1965), with a residual force that walks at random:
/// what force must be added to the model for the motion that was seen.
struct SmoothedRun {
    std::vector<double> time, gap, velocity, force, force_sigma;
};
/// N/sqrt(s) per kg of the body: how fast a residual force that nobody knows is let change.
inline constexpr double usual_force_walk = 0.001;
/// `force_walk` N/sqrt(s): how fast the residual force may change.
SmoothedRun smooth_with_force(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
                              double force_walk);

/// dw/dt of an explanation at a moment and its slopes, without memory: what the filter integrates.
double acceleration_of(const HeaveRecord& record, const HeaveExplanation& explanation, double t, double h, double w,
                       double input, dynamics::HeaveSlopes& slopes);

/// Motion of the explanation from step k - 1 to step k under input[k]. Without the memory of a history force.
void step_once(const HeaveRecord& record, const HeaveExplanation& explanation, const std::vector<double>& input,
               std::size_t k, double& gap, double& velocity);

/// Free run of the explanation from (gap, velocity) at step `first` to step `last`: predicted gap readings. `memory`:
/// of the history force there, from the filter; nullptr: the body has moved steadily before.
void free_run(const HeaveRecord& record, const HeaveExplanation& explanation, const std::vector<double>& input,
              std::size_t first, std::size_t last, double gap, double velocity, std::vector<double>& predicted,
              const double* memory = nullptr);

}  // namespace underbody::discovery
