// The extended Kalman filter over the nonlinear heave plant: gap, heave velocity and what the ground force departs from its table.
//
//     dh/dt = w,  S dw/dt = F_g(h) + delta - F_d(w) + u + bias,  d delta/dt = -delta/tau + white noise of density q
//
// total_force is seen through the motion. ground_force = total_force + F_d(w) and drag_force = F_d(w) rest on the declared drag law:
// "model-dependent". Sensors: gap, and heave_velocity when measured; steps may differ and values may be missing.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "surrogates/estimator/training.h"

namespace underbody::estimator {

struct FilterNoise {
    double gap = 2e-4;            ///< m, one standard deviation per sample
    double velocity = 0;          ///< m/s; 0: not measured
    double force_density = 1e-7;  ///< N^2/s: random walk of the departure
    double force_time = 0;        ///< s: relaxation of the departure; 0: none
    double drag_relative = 0;     ///< relative deviation of the declared drag law, carried into the separate forces
    double gate = 6;              ///< a measurement further off than this many deviations is an outlier; 0: none is
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
    bool outside = false;                ///< beyond the force table
};

struct FilterResult {
    std::vector<FilterEstimate> estimates;  ///< one per sample
    double log_likelihood = 0;
    double mean_squared_innovation = 0;     ///< normalised: 1 for a consistent filter
    double innovation_correlation = 0;      ///< of neighbours: 0 for a matched model
    std::size_t outliers = 0, missing = 0, used = 0;
};

/// `smooth`: fixed-interval smoothing (Rauch, Tung and Striebel 1965) after the filter.
/// Throws core::InputError: fewer than three gaps, times that do not ascend, an input that is missing.
FilterResult extended_filter(const SeparatedPlant& plant, const RunSignals& run, const FilterNoise& noise, bool smooth = false);

/// The force density with the highest likelihood over the runs, on a logarithmic grid refined once.
double likely_force_density(const SeparatedPlant& plant, const std::vector<RunSignals>& runs, FilterNoise noise);

/// A surface under the vehicle: its plant.
struct Surface {
    std::string name;
    SeparatedPlant plant;
};

/// Which surface is under the vehicle: a bank of filters, one per surface, weighed by their innovations (thesis figure 7-2).
struct SurfaceProbability {
    std::vector<std::string> names;
    std::vector<double> time;
    std::vector<std::vector<double>> probability;  ///< [surface][sample]
    std::size_t best = 0;
};
/// `switching`: chance per second that the surface changes (0: one surface for the whole run).
SurfaceProbability identify_surface(const std::vector<Surface>& surfaces, const RunSignals& run, const FilterNoise& noise,
                                    double switching = 0);

}  // namespace underbody::estimator
