// Is a channel of measured heave what it is called? Readings that stand still, gaps of another unit or sign, columns
// that have changed places, a velocity that does not belong to its gap: one judgement and one wording for predictions,
// discovery and the watch.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/contact_gap.h"

namespace underbody::dynamics {

/// True where one value stands for a fifth of the readings (more than twenty; NaN: none) in one piece.
bool stands_still(const std::vector<double>& values);
/// "the gap of RUN stands still for a fifth of the run: a stuck sensor?"
std::string still_text(const std::string& run);

/// Gaps beside which the model has no tables.
struct BesideTables {
    std::string text;  ///< "its gap, 4 m in the middle, lies outside the tables ...: a thousandth would fit"
    std::string hint;  ///< what to look at; empty where no other unit or sign would fit
};
/// Where the middle of the gaps (m; NaN: none), or more than half of them, lies outside; nothing without tables.
std::optional<BesideTables> beside_tables(const std::vector<double>& gap, const GapRange& tables);

/// True where the gap has none of its declared noise and the input has it.
bool look_exchanged(double gap_noise, double input_noise, std::optional<double> declared);

/// What a measured velocity says beside the gap's own changes over a second each; both NaN without enough motion.
struct VelocityScale {
    double slope;  ///< regression: a foreign channel gives about 0, a turned one -1
    double ratio;  ///< root of the mean squares' ratio: a delay of one sensor leaves it at 1
};
VelocityScale velocity_scale(const std::vector<double>& time, const std::vector<double>& gap,
                             const std::vector<double>& velocity, double gap_noise);
struct DoubtfulVelocity {
    std::string text;
    bool turned = false;  ///< its sign alone is wrong
};
/// By the scales of all runs.
std::optional<DoubtfulVelocity> doubtful_velocity(const std::vector<VelocityScale>& scales);

/// All of the above of the runs of a data set, as warnings.
core::Problems doubtful_readings(const Model& model, const Measurements& data);

}  // namespace underbody::dynamics
