// What a mended model changes: the separation of the forces along the gap and the stability map, made with the old and
// the new model beside each other.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/model/measurements.h"

namespace underbody::estimator {

/// The separate forces that the extended filter gives over measured runs, as means over stretches of gap. SI; sigmas
/// are root mean squares of the stated standard deviations.
struct SeparationAlongGap {
    std::vector<double> gap, ground_force, drag_force, ground_sigma, drag_sigma, total_sigma;
    double force_density = 0;            ///< N^2/s, the likeliest departure from the model's forces
    double mean_squared_innovation = 0;  ///< 1 for a model that explains the motion
    double departure = 0;                ///< N, root mean square of what departs from the model's forces
};
/// `bins` stretches of equal width over the gaps that were measured; empty ones are left out. Throws as estimate()
/// does.
SeparationAlongGap separation_along_gap(const dynamics::Model& model, const dynamics::Measurements& data,
                                        std::size_t bins = 30, core::Progress& progress = core::Progress::none());

struct MadeAgain {
    std::optional<SeparationAlongGap> separation_before, separation_after;  ///< none for static sets
    std::optional<dynamics::StabilityRegion> map_before, map_after;
    std::vector<std::string> left_out;  ///< what could not be made, and why
    /// Separation before and after, each map, and their boundaries over each other.
    [[nodiscard]] std::vector<core::Figure> figures() const;
};
/// With the conditions of the first run; maps over the measured gaps (static sets: those of the tables) and -0.1 to 0.1
/// m/s, no input. What cannot be made is named instead.
MadeAgain make_again(const dynamics::Model& before, const dynamics::Model& after, const dynamics::Measurements& data,
                     core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const SeparationAlongGap& separation);
void to_json(nlohmann::json& json, const MadeAgain& again);

}  // namespace underbody::estimator
