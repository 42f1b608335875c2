// How well models predict, side by side: the learned ones beside tangent, equivalent-linear and nonlinear models.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/estimator/model/dmd.h"

namespace underbody::estimator {

/// A motion to predict: uniform samples, the input held over each step. SI, gap up.
struct TestMotion {
    double step = 0;  ///< s
    std::vector<double> gap, velocity, input;
    std::vector<double> total_force;  ///< N, F_g - F_d along the motion
    std::vector<double> total_rate;   ///< N/s, its time derivative
    std::shared_ptr<const SeparatedPlant>
        plant;  ///< at this motion's own conditions; none: the one given to the comparison
};

struct PredictionTest {
    double horizon = 10;  ///< s
    double step = 0.02;   ///< s
    std::size_t runs = 40;
    double gap_lower = 0, gap_upper = 1.2, velocity_lower = -.03, velocity_upper = .03;
    double input_sigma = 0.005;  ///< N, pink
    std::uint64_t seed = 99;
};
/// Motions of the plant from starts spread over the region, under a coloured input; none of them is in a training set
/// of another seed.
std::vector<TestMotion> test_motions(const SeparatedPlant& plant, const PredictionTest& test);

struct PredictionError {
    std::string model;
    double acceleration = 0;  ///< m/s^2: root mean square error of the derivative of the velocity along the motions
    double total_rate = 0;    ///< N/s: likewise of the total force; NaN when the model has no forces
    double gap = 0,
           velocity = 0;     ///< m, m/s: root mean square over motions and samples, predicted from each motion's start
    double gap_at_end = 0;   ///< m: root mean square at the end of the motions
    double total_force = 0;  ///< N; NaN when the model has no forces
    bool diverged = false;   ///< left the range of the motions by ten times its width; errors are clipped there
};

using NamedModels = std::vector<std::pair<std::string, AugmentedModel>>;
/// Tangent at mid-range, equivalent linear, the given models, and the nonlinear plant itself, on the same motions.
/// Auxiliary variables start from the plant's own curves. The range for the tangent and the clip is that of the
/// motions.
std::vector<PredictionError> compare_predictions(const SeparatedPlant& plant, const NamedModels& models,
                                                 const std::vector<TestMotion>& motions,
                                                 core::Progress& progress = core::Progress::none());

/// The room's own list of peers, learned from the same samples: order 6 or the rank below it (method 2) with p3, least
/// squares with known rows, dynamic mode decomposition with control, and its extended form over ground_force,
/// velocity_squared, gap_squared, gap_cubed.
NamedModels usual_peers(const SeparatedPlant& plant, TrainingOptions training, double dmd_step,
                        core::Progress& progress = core::Progress::none());
/// The same from samples and snapshots at hand: `samples` with ground_force and drag_force, `plain` without
/// auxiliaries, `lifted` over usual_dictionary().
NamedModels usual_peers(const SeparatedPlant& plant, const TrainingSet& samples, const SnapshotPairs& plain,
                        const SnapshotPairs& lifted);
const std::vector<std::string>& usual_dictionary();

/// One line a model.
std::string prediction_text(const std::vector<PredictionError>& errors);
core::Figure prediction_figure(const std::vector<PredictionError>& errors, const std::string& caption);
void to_json(nlohmann::json& json, const PredictionError& error);

}  // namespace underbody::estimator
