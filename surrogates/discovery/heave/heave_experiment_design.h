// Which run would separate what heave data leave tied.
#pragma once

#include <string>
#include <vector>

#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave/heave_experiment.h"

namespace underbody::discovery {

/// One sentence: the excitation under which two explanations differ most.
std::string heave_told_apart(const HeaveExperiment& experiment, const FittedHypothesis& chosen,
                             const FittedHypothesis& rival);

/// Fills next_experiment, next_set_points (time, input_force) and next_power.
void next_heave_experiment(const HeaveExperiment& experiment, const std::vector<FittedHypothesis>& fitted,
                           const Attribution& attribution, Discovery& result);

}  // namespace underbody::discovery
