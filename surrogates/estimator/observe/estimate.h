// Estimates of separate and total forces over measured runs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/estimator/observe/extended_filter.h"
#include "surrogates/estimator/observe/observer.h"

namespace underbody::dynamics {
struct Measurements;
struct MeasuredRun;
}  // namespace underbody::dynamics

namespace underbody::estimator {

struct EstimateOptions {
    /// extended | kalman | reduced | full | latent | disturbance
    std::string observer = "extended";
    Poles poles;  ///< 1/s, empty: -3, -4; reduced (two), full and latent (two are completed to the left), disturbance
                  ///< (the first)
    std::size_t order = 0;       ///< of the learned model for linear observers; 0: least squares with known rows
    double gap_sigma = 0;        ///< m; 0: declared by the data, else estimated from it
    double velocity_sigma = 0;   ///< m/s, likewise
    double force_density = 0;    ///< N^2/s; 0: the likeliest
    double drag_relative = 0.2;  ///< relative deviation of the declared drag law, carried into the separate forces;
                                 ///< what the data show to depart from the declared laws is counted beside it
    double gate = 6;
    bool smooth = false;  ///< extended: use the whole run for each moment
};

struct RunEstimate {
    std::string name;
    std::size_t samples = 0, used = 0, outliers = 0, missing = 0, gaps_in_time = 0;
    double mean_squared_innovation = 0;  ///< NaN for observers without covariance
    double innovation_correlation = 0;
    double outside = 0;  ///< share of estimates beyond the force table
};

struct Estimation {
    std::string observer;
    core::Table table;  ///< run, time, gap, heave_velocity, ground_force, drag_force, total_force, each with NAME_sigma
    std::vector<RunEstimate> runs;
    FilterNoise noise;
    bool gap_noise_declared = false, density_chosen = false;
    double departure_rms = 0;  ///< N, of what the data show to depart from the declared laws; extended filter only
    /// Label per quantity: "observed" or "model-dependent".
    std::vector<std::pair<std::string, std::string>> labels;
    std::string explanation;
    Separability separability;  ///< of the linear model in use (linear observers) or the declared one at mid-range
    std::vector<ObserverDesign> design;  ///< of linear observers: one; else none
    core::Problems remarks;
    core::Figure figure;  ///< forces against time of the first run
};

/// `plant_of` binds the model to a run's conditions; see separate(). Throws core::InputError: static data, no gap, a
/// reduced observer without measured heave_velocity (with what to take instead), unobservable requests with their
/// direction.
Estimation estimate(const dynamics::Model& model, const dynamics::Measurements& data, const EstimateOptions& options,
                    core::Progress& progress = core::Progress::none());

/// Signals of a measured run, read as `records` says: gaps in time stay gaps, missing inputs are interpolated (and said
/// in `remarks`); of a run without an input none acts.
RunSignals signals_of_run(const dynamics::MeasuredRun& run, core::Problems& remarks,
                          const dynamics::RecordReading& records = {});

/// A linear filter over a run on its own uniform step: resampled where steps differ, started anew after gaps in time.
/// Outliers (dynamics::drop_outliers) are bridged.
struct UniformRun {
    std::vector<double> time, gap, velocity, input;
    std::vector<bool> restart;
    std::size_t outliers = 0, missing = 0, gaps = 0;
    std::size_t bridged = 0;  ///< missing velocities, taken from the slope of the gap over 0.5 s
};
UniformRun uniform(const RunSignals& run, double step);
double usual_step(const RunSignals& run);

void to_json(nlohmann::json& json, const Estimation& estimation);

}  // namespace underbody::estimator
