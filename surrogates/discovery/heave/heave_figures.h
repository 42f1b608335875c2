// Pictures of a heave discovery.
#pragma once

#include <vector>

#include "core/figure.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave/heave_experiment.h"

namespace underbody::discovery {

std::vector<core::Figure> heave_figures(const HeaveExperiment& experiment, const HeaveNoise& noise,
                                        const std::vector<dynamics::EffectUse>& uses, const Discovery& result);

}  // namespace underbody::discovery
