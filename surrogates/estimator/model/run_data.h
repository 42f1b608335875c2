// Measured runs as training data and as motions to predict.
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/estimator/model/dmd.h"
#include "surrogates/estimator/model/peers.h"
#include "surrogates/estimator/observe/estimate.h"

namespace underbody::estimator {

/// Whole runs to learn from and whole runs to test on.
struct RunSplit {
    dynamics::Measurements train, test;
    std::string how;  ///< "4 runs to learn from, 2 to test on, as the data set says"
};
/// As the data set marks them. Where it marks none and `hold_out` is asked for, every fourth run, at least one, is for
/// tests; a single run serves for both, and `how` says so.
RunSplit split_runs(const dynamics::Measurements& data, bool hold_out);

/// Samples out of runs smoothed with the model: gap, velocity, and the ground force with its departure from the table;
/// drag as declared; rates exact from the equation of motion, the departure's by central differences. Samples beside
/// gaps in time are left out.
TrainingSet training_from_runs(const dynamics::Model& model, const dynamics::Measurements& data,
                               const std::vector<std::string>& auxiliaries, const EstimateOptions& options = {},
                               core::Progress& progress = core::Progress::none());

/// Windows of the smoothed runs on a uniform step, each `horizon` long (shorter runs whole), none over a gap in time.
/// Throws core::InputError when no run is half that long.
std::vector<TestMotion> motions_from_runs(const dynamics::Model& model, const dynamics::Measurements& data,
                                          double horizon, const EstimateOptions& options = {},
                                          core::Progress& progress = core::Progress::none());

/// Snapshots `step` apart along motions, under the mean input between them.
SnapshotPairs snapshot_pairs(const std::vector<TestMotion>& motions, const std::vector<std::string>& auxiliaries,
                             double step);

}  // namespace underbody::estimator
