// What a model predicts over a horizon from states estimated out of the measurements before it; and what that means for
// the vehicle.
#pragma once

#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave/heave_experiment.h"

namespace underbody::discovery {

/// Windows of `horizon` seconds one after the other, each from the filtered state at its start; measured readings (not
/// averages) less prediction, summed by record.
void horizon_errors(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                    const HeaveNoise& noise, double horizon, std::vector<double>& sum_of_squares,
                    std::vector<double>& counts);

/// Root mean square of the velocity that a Kalman filter with one explanation gives, less the velocity smoothed with
/// the better one, m/s.
double estimator_error(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                       const HeaveNoise& noise, const std::vector<dynamics::EffectUse>& better,
                       const HeaveNoise& better_noise);

/// A smooth force as an effect for model.toml: a table over its variables.
dynamics::EffectUse force_table(const FlexibleForce& force);

/// Equilibria and stability region of the free motion before and after.
Consequence heave_consequence(const dynamics::Model& before, const dynamics::Model& after, const HeaveRecords& records,
                              core::Progress& progress);

}  // namespace underbody::discovery
