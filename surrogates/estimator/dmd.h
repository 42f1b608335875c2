// The peers of today: dynamic mode decomposition with control (Proctor, Brunton and Kutz 2016) and its extended form over a dictionary
// of observables (Williams, Kevrekidis and Rowley 2015; with inputs Korda and Mezic 2018), with the interface of the augmented model.
#pragma once

#include "surrogates/estimator/training.h"

namespace underbody::estimator {

/// Samples in rows: inputs, states now, states one step later (input held between).
struct SnapshotPairs {
    Layout layout;
    double step = 0;  ///< s
    std::size_t count = 0;
    std::vector<double> values;
};
/// Pairs from the plant over the region of `options` (its auxiliaries are the dictionary; empty: plain DMD over velocity and gap).
SnapshotPairs snapshot_pairs(const SeparatedPlant& plant, const TrainingOptions& options, double step,
                             core::Progress& progress = core::Progress::none());
/// Pairs of neighbours out of recorded signals, every state given as a column.
SnapshotPairs snapshot_pairs(const Layout& layout, const std::vector<std::vector<double>>& inputs,
                             const std::vector<std::vector<double>>& states, double step);

/// Discrete law by regression in the `order` leading directions of (inputs, states) (0: all that are not noise), then its exact
/// continuous form by the matrix logarithm. Throws core::InputError: fewer pairs than channels, no continuous form.
AugmentedModel learn_dmd(const SnapshotPairs& pairs, std::size_t order = 0);

/// How well models predict: the same motion by the plant and by the model, from the plant's own start.
struct PredictionError {
    std::string model;
    double gap = 0, velocity = 0;   ///< m, m/s: root mean square over runs and samples up to the horizon
    double total_force = 0;         ///< N; NaN when the model has no forces
    double acceleration = 0;        ///< m/s^2: root mean square of the derivative along the plant's own motion
    bool diverged = false;          ///< left ten times the range of the plant's motion
};
struct PredictionTest {
    double horizon = 10;            ///< s
    double step = 0.02;             ///< s
    std::size_t runs = 40;
    double gap_lower = 0, gap_upper = 1.2, velocity_lower = -.03, velocity_upper = .03;
    double input_sigma = 0.005;     ///< N, pink
    std::uint64_t seed = 99;
};
/// Tangent at mid-range, equivalent linear, and the given models.
std::vector<PredictionError> compare_predictions(const SeparatedPlant& plant, const std::vector<std::pair<std::string, AugmentedModel>>& models,
                                                 const PredictionTest& test, core::Progress& progress = core::Progress::none());

}  // namespace underbody::estimator
