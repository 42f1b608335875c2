// Measured runs of coupled motions, predicted window by window: what predict() and discovery judge a model by.
#pragma once

#include "surrogates/dynamics/simulate/measured_motion.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::dynamics {

/// One standard deviation of the readings of each state: declared, else from the run's scatter.
std::array<double, most_states> motion_noise(const MotionShape& shape, const Measurements& data,
                                             const MeasuredRun& run);

/// A run with its windows.
struct MotionRunPrediction {
    std::unique_ptr<MeasuredMotion> run;
    std::vector<MotionWindow> windows;
    std::vector<std::string> not_used;  ///< what is said of readings that it is not judged by
};
/// All runs of the data with the model's [records]; states from min(horizon, 2 s) of readings, or options.past.
std::vector<MotionRunPrediction> predict_motion_runs(const Motion& motion, const Model& model, const Measurements& data,
                                                     const PredictOptions& options,
                                                     core::Progress& progress = core::Progress::none());

/// predict() for runs of this motion.
Prediction predict_motion_series(const Motion& motion, const Model& model, const Measurements& data,
                                 const PredictOptions& options, core::Progress& progress = core::Progress::none());

}  // namespace underbody::dynamics
