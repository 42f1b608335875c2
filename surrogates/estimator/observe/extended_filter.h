// The extended Kalman filter over the nonlinear heave plant: gap, heave velocity and what the ground force departs from
// its table.
//
//     dh/dt = w,  M dw/dt = F_g(h) + delta - F_d(h, w) + u + bias,  d delta/dt = -delta/tau + white noise of density q
//
// total_force is seen through the motion. ground_force = total_force + F_d and drag_force = F_d rest on the declared
// laws: "model-dependent". Their deviations say what the motion cannot tell: along (1, 1) of the two nothing is
// observed. Sensors: gap, and heave_velocity when measured; steps may differ and values may be missing.
#pragma once

#include <array>
#include <vector>

#include "surrogates/estimator/model/training.h"

namespace underbody::estimator {

struct FilterNoise {
    double gap = 2e-4;            ///< m, one standard deviation per sample
    double velocity = 0;          ///< m/s; 0: not measured
    double force_density = 1e-7;  ///< N^2/s: random walk of the departure
    double force_time = 0;        ///< s: relaxation of the departure; 0: none
    double drag_relative = 0;     ///< relative deviation of the declared drag law, carried into the separate forces
    /// The motion shows the total force alone: what departs from the declared laws may be the ground's or the drag's.
    /// True: the one or the other, each as likely, in the deviations of the two; false: all of it is the ground's.
    bool split_departure = false;
    double gate = 6;             ///< a measurement further off than this many deviations is an outlier; 0: none is
    double departure_sigma = 0;  ///< N: how far the table may be off at the start; 0: as far as its largest force
};

/// One run: samples at ascending times; NaN where a value is missing.
struct RunSignals {
    std::vector<double> time, gap, velocity, input;  ///< velocity and input may be empty
    bool held = false;  ///< the input is held from its sample to the next; else linear between samples
};

struct FilterEstimate {
    double gap = 0, velocity = 0, departure = 0;
    double ground_force = 0, drag_force = 0, total_force = 0;
    double gap_sigma = 0, velocity_sigma = 0, departure_sigma = 0;
    double ground_sigma = 0, drag_sigma = 0, total_sigma = 0;
    std::array<double, 9> covariance{};  ///< of (gap, velocity, departure), row-major
    double innovation = 0;               ///< m, of the gap; NaN when missing
    double innovation_sigma = 0;
    bool outlier = false;
    bool outside = false;  ///< beyond the force table
};

struct FilterResult {
    std::vector<FilterEstimate> estimates;  ///< one per sample
    double log_likelihood = 0;
    double mean_squared_innovation = 0;  ///< normalised: 1 for a consistent filter
    double innovation_correlation = 0;   ///< of neighbours: 0 for a matched model
    std::size_t outliers = 0, missing = 0, used = 0;
};

/// One standard deviation of what goes from the ground's force to the drag and back unseen: FilterNoise::drag_relative
/// of the drag, and the share of the departure (with its own deviation) that is the drag's.
double split_sigma(const FilterNoise& noise, const FilterEstimate& estimate);

/// `smooth`: fixed-interval smoothing (Rauch, Tung and Striebel 1965) after the filter.
/// Throws core::InputError: fewer than three gaps, times that do not ascend, an input that is missing.
FilterResult extended_filter(const SeparatedPlant& plant, const RunSignals& run, const FilterNoise& noise,
                             bool smooth = false);

/// A run with the plant at its own conditions.
struct PlantRun {
    const SeparatedPlant* plant;
    const RunSignals* signals;
};
/// The force density with the highest likelihood over the runs, on a logarithmic grid refined once.
double likely_force_density(const std::vector<PlantRun>& runs, FilterNoise noise);

/// The filter sample by sample, without allocation: what a loop closed in real time runs. plant and noise must outlive
/// it.
class ExtendedRunner {
public:
    /// Mean of (gap, velocity, departure) and its covariance, row-major.
    struct Belief {
        std::array<double, 3> x{};
        std::array<double, 9> p{};
    };
    /// Throws core::InputError when the gap sensor's noise is not positive.
    ExtendedRunner(const SeparatedPlant& plant, const FilterNoise& noise);

    void start(const Belief& belief);
    /// From one sample: at the measured gap, at rest unless the velocity is measured, with a wide belief about the
    /// force.
    void start(double gap, double velocity);
    /// The next sample lies `dt` later; `input` was held since `time`.
    void predict(double dt, double input, double time = 0);
    /// NaN: not measured. Returns the log likelihood of the sample.
    double measure(double gap, double velocity, FilterEstimate& estimate);
    /// What a belief says of gap, velocity and forces.
    void describe(const Belief& belief, FilterEstimate& estimate) const;

    [[nodiscard]] const Belief& belief() const { return belief_; }
    [[nodiscard]] const Belief& predicted() const { return predicted_; }            ///< before the last measurement
    [[nodiscard]] const std::array<double, 9>& transition() const { return phi_; }  ///< over the last step
    [[nodiscard]] double departure_sigma() const { return departure_sigma_; }

private:
    bool update(std::size_t component, double value, double sigma, double& innovation, double& spread,
                bool trust_always);

    const SeparatedPlant* plant_;
    const FilterNoise* noise_;
    double departure_sigma_ = 0;
    Belief belief_, predicted_;
    std::array<double, 9> phi_{};
    std::size_t rejected_ = 0;
};

/// Start of a run out of its first gaps (surrogates/dynamics/simulate/start_state.h).
ExtendedRunner::Belief start_of_run(const ExtendedRunner& runner, const RunSignals& run, const FilterNoise& noise);
/// The run with its input as the plant's actuator lets it reach the body: means over the steps, held.
RunSignals through_actuator(const SeparatedPlant& plant, RunSignals run);
/// Mean of the input over the step that ends at sample k.
double input_over(const RunSignals& run, std::size_t k);
/// Throws core::InputError: lengths that differ, fewer than three gaps, times that do not ascend, an input that is
/// missing.
void check_run(const RunSignals& run);

}  // namespace underbody::estimator
