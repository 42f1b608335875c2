// Pictures of a static discovery.
#pragma once

#include <vector>

#include "core/figure.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/static/static_experiment.h"

namespace underbody::discovery {

std::vector<core::Figure> static_figures(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                                         const std::vector<dynamics::EffectUse>& uses, const Discovery& result);

/// Probabilities of the rivals, with "none" and "unknown".
core::Figure probability_figure(const Discovery& result);
/// Error before and after by channel, in noise, with its interval.
core::Figure error_figure(const Discovery& result);

}  // namespace underbody::discovery
