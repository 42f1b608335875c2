// The stability region of the closed loop: where its starts end, with saturation, lag, sample time and sensor noise.
#pragma once

#include "core/progress.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/estimator/control/closed_loop.h"

namespace underbody::estimator {

struct LoopRegionOptions {
    std::vector<core::NamedRange> axes;  ///< gap and heave_velocity, in any order, SI
    std::size_t columns = 60, rows = 40;
    bool refine = true;  ///< areas refined below the grid, as for open-loop regions
};

/// Classes: "held" (attractor at the reference, within 2 % of the gap axis), "parked 1", "parked 2" ... (rests
/// elsewhere, or swings about one place, with their gaps), "contact" (touches the ground on its way), "escape" (above
/// the gap axis by its own length), "undecided" (still moving at the end of LoopOptions::duration). With sensor noise
/// each start has its own noise, seeded by its place: the map is the same every time. The grid, the areas and the
/// figure are those of open-loop regions (surrogates/dynamics/basin/region.h). Throws core::InputError for axes that
/// are not gap and heave_velocity.
dynamics::StabilityRegion loop_region(const SeparatedPlant& plant, const ControlLaw& law,
                                      const LoopEstimator& estimator, const LoopOptions& loop,
                                      const LoopRegionOptions& options,
                                      core::Progress& progress = core::Progress::none());

/// Chance that the loop holds the gap from each start, over `draws` of the sensors' noise: ProbabilityMap::safe is the
/// share of the draws that end "held". Without noise one draw says it all. The classes of a single draw are those of
/// loop_region.
dynamics::ProbabilityMap loop_probability(const SeparatedPlant& plant, const ControlLaw& law,
                                          const LoopEstimator& estimator, const LoopOptions& loop,
                                          const LoopRegionOptions& options, std::size_t draws,
                                          core::Progress& progress = core::Progress::none());

}  // namespace underbody::estimator
