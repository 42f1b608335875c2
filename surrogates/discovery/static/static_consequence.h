// What a finding of a static set changes for the vehicle: where it rests, before and after.
#pragma once

#include "core/progress.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/static/static_experiment.h"

namespace underbody::discovery {

/// Gaps at which lift and net weight balance, with the other channels at the middle of what was measured, and (when the
/// model has a mass) the shares of the stability region. Effects of the rig move no equilibrium of the vehicle; for
/// them `gap_after` is the one that somebody would read off the uncorrected measurements.
Consequence static_consequence(const dynamics::Model& before, const std::vector<dynamics::EffectUse>& uses,
                               const StaticExperiment& experiment, core::Progress& progress);

}  // namespace underbody::discovery
