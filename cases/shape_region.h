// The stability map of a shape that is being designed: the study's vehicle with what is known of the shape's lift.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "cases/known_lift.h"
#include "cases/study.h"
#include "core/figure.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::cases {

/// What a map is asked of.
struct ShapeRegion {
    RegionSpec vehicle;                 ///< its model, tables and axes
    std::map<std::string, double> set;  ///< declared numbers of the model changed, SI
    KnownLift lift;
    std::optional<double> net_weight;  ///< N; none: the model's
    double pitch = 0, speed = 0.5;     ///< rad, m/s: of a surrogate over several
};

/// The vehicle of a study: the [[region]] of that name, else the first; of a study that has none the model of its first
/// [[measurement]], without tables. Throws core::InputError (missing) when the study declares no vehicle.
RegionSpec vehicle_of(const Study& study, const std::string& region = {});

/// The vehicle's model with the known lift in the place of its own; what its jets lift, and its other forces, stay. Its
/// speed is that of the lift, so that the map's attractors are the equilibria of the lift's own curve. `surrogate` is
/// needed where the lift rests on it. Throws core::InputError: no lift is known or its loads are missing, one gap
/// alone, a wrong model.
dynamics::Model shape_model(const Study& study, const StudyResults& results, const ShapeRegion& asked,
                            const LearnedLoads* surrogate);

/// Gap and heave velocity as the vehicle's region has them, else all gaps of the lift and 0.05 m/s either way; coarse,
/// for a map that follows a hand.
dynamics::RegionOptions shape_region_options(const ShapeRegion& asked, const dynamics::Model& model,
                                             std::size_t starts = 40);

/// "glide.toml, net weight 0.3 N, 3.954 kg with added mass, 0.5 m/s"
std::string vehicle_words(const ShapeRegion& asked, const dynamics::Model& model);

/// dynamics::region_figure under the words of the lift; the caption says all that it rests on.
core::Figure shape_region_figure(const dynamics::StabilityRegion& region, const KnownLift& lift,
                                 const std::string& vehicle);

}  // namespace underbody::cases
