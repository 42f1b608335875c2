// The peers of today: dynamic mode decomposition with control (Proctor, Brunton and Kutz 2016) and its extended form
// over a dictionary of observables (Williams, Kevrekidis and Rowley 2015; with inputs Korda and Mezic 2018), with the
// interface of the augmented model.
#pragma once

#include "surrogates/estimator/model/training.h"

namespace underbody::estimator {

/// Samples in rows: inputs, states now, states one step later (input held between).
struct SnapshotPairs {
    Layout layout;
    double step = 0;  ///< s
    std::size_t count = 0;
    std::vector<double> values;
};
/// Pairs from the plant over the region of `options` (its auxiliaries are the dictionary; empty: plain DMD over
/// velocity and gap).
SnapshotPairs snapshot_pairs(const SeparatedPlant& plant, const TrainingOptions& options, double step,
                             core::Progress& progress = core::Progress::none());
/// Pairs of neighbours out of recorded signals, every state given as a column.
SnapshotPairs snapshot_pairs(const Layout& layout, const std::vector<std::vector<double>>& inputs,
                             const std::vector<std::vector<double>>& states, double step);

/// Discrete law by regression in the `order` leading directions of (inputs, states) (0: all that are not noise), then
/// its exact continuous form by the matrix logarithm. Throws core::InputError: fewer pairs than channels, no continuous
/// form.
AugmentedModel learn_dmd(const SnapshotPairs& pairs, std::size_t order = 0);

}  // namespace underbody::estimator
