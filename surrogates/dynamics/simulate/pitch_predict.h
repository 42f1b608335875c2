// Measured runs of heave with pitch, predicted window by window: what predict() and discovery judge a model by.
#pragma once

#include "surrogates/dynamics/simulate/pitch_run.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::dynamics {

/// One standard deviation of the readings of each state: declared, else from the run's scatter.
std::array<double, pitch_states> pitch_noise(const Measurements& data, const MeasuredRun& run);

/// A run with its windows.
struct PitchRunPrediction {
    std::unique_ptr<PitchRun> run;
    std::vector<PitchWindow> windows;
    std::vector<std::string> not_used;  ///< what is said of readings that it is not judged by
};
/// All runs of the data with the model's [records]; states from min(horizon, 2 s) of readings, or options.past.
std::vector<PitchRunPrediction> predict_pitch_runs(const Model& model, const Measurements& data,
                                                   const PredictOptions& options,
                                                   core::Progress& progress = core::Progress::none());

/// predict() for runs that move in heave and pitch.
Prediction predict_pitch_series(const Model& model, const Measurements& data, const PredictOptions& options,
                                core::Progress& progress = core::Progress::none());

}  // namespace underbody::dynamics
