// Which set points would separate what is still tied, or see what is still below the limit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/static/static_experiment.h"

namespace underbody::discovery {

/// One sentence: where two explanations differ most, in noise, within the range that was measured.
std::string static_told_apart(const StaticExperiment& experiment, const FittedHypothesis& chosen,
                              const FittedHypothesis& rival);

/// Fills next_experiment, next_set_points and next_power.
void next_static_experiment(const StaticExperiment& experiment, const std::vector<FittedHypothesis>& fitted,
                            const Attribution& attribution, std::uint64_t seed, Discovery& result);

}  // namespace underbody::discovery
