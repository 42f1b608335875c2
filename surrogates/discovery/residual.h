// The force that must be added to a declared model for the motion that was measured: by smoothing with the model inside
// the experiment, never by raw differences.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::discovery {

/// Residual force in bins of one variable.
struct ResidualCurve {
    std::string variable;            ///< gap, heave_velocity, speed, ...
    std::string unit;                ///< SI
    std::vector<double> centre;      ///< mean of the variable in the bin
    std::vector<double> mean;        ///< N
    std::vector<double> spread;      ///< N, standard deviation within the bin
    std::vector<double> mean_sigma;  ///< N, error of the mean, for the correlation between neighbours
    std::vector<std::size_t> count;
};

struct Residual {
    std::string quantity;               ///< what it adds to: lift_force for heave runs
    double mean = 0;                    ///< N, over everything
    double root_mean_square = 0;        ///< N
    double sigma = 0;                   ///< N, one standard deviation of the smoothed force (noise that got through)
    std::vector<ResidualCurve> curves;  ///< heave: over gap and heave_velocity; static: over every varying channel
    std::vector<core::Figure> figures;  ///< one a curve, and the residual over time of the first run
    core::Problems problems;
};

/// Heave with pitch: the same with a force and a moment, one Residual each. Heave runs: extended Kalman filter and
/// Rauch-Tung-Striebel smoother (1965) of the declared equation with a residual force that walks at random; with the
/// recorded input inside. Static sets: measured less model at each set point, one Residual a quantity. Throws
/// core::InputError as prepare_heave_records or StaticExperiment do.
std::vector<Residual> measured_residual(const dynamics::Model& model, const dynamics::Measurements& data,
                                        core::Progress& progress = core::Progress::none());

nlohmann::json to_json(const Residual& residual);

/// "severity" ("note" or "warning"), "message" and "place" of each.
nlohmann::json json_of(const core::Problems& problems);

}  // namespace underbody::discovery
