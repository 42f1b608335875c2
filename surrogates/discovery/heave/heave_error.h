// What a model predicts over a horizon from states estimated out of the measurements before it; and what that means for
// the vehicle.
#pragma once

#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/guards.h"
#include "surrogates/discovery/heave/heave_experiment.h"

namespace underbody::discovery {

/// Squared error of each window of a prediction, in the order of the records.
struct WindowSquares {
    std::vector<std::size_t> record;  ///< index into the experiment's chosen records
    std::vector<double> square, count;
    std::vector<double> errors;  ///< m, reading by reading
    /// Summed by record.
    [[nodiscard]] BlockSquares by_record(std::size_t records) const;
    /// Summed over neighbouring windows of one record: about `wanted` blocks in all, none across two records.
    [[nodiscard]] BlockSquares blocks(std::size_t records, std::size_t wanted) const;
};

/// What predict() says of these runs, window by window: the error that is reported.
struct PredictedWindows {
    double horizon = 0;     ///< s, as asked for; shorter where no run is as long; 0: no run is long enough
    WindowSquares windows;  ///< `record` is the run's place among those predicted
};
PredictedWindows predicted_windows(const dynamics::Model& model, const dynamics::Measurements& data, double horizon,
                                   const std::string& channel, core::Progress& progress);

/// Windows of `horizon` seconds one after the other, each from the filtered state at its start; measured readings (not
/// averages) less prediction. Two hypotheses are compared by these, each with the noise that suits it; what a user sees
/// is predicted_windows().
WindowSquares window_errors(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                            const HeaveNoise& noise, double horizon);

/// Root mean square of the velocity that a Kalman filter with one explanation gives, less the velocity smoothed with
/// the better one, m/s.
double estimator_error(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                       const HeaveNoise& noise, const std::vector<dynamics::EffectUse>& better,
                       const HeaveNoise& better_noise);

/// A smooth force as an effect for model.toml: a table over its variables, nowhere larger than `largest` (N), that
/// fades to zero over a tenth of the range beyond what was seen.
dynamics::EffectUse force_table(const FlexibleForce& force, double largest);

/// Equilibria and stability region of the free motion before and after.
Consequence heave_consequence(const dynamics::Model& before, const dynamics::Model& after, const HeaveRecords& records,
                              core::Progress& progress);

}  // namespace underbody::discovery
