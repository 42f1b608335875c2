// Was something wrong from the first reading? What is learned then passes for noise, unless it is asked.
#pragma once

#include <deque>
#include <optional>

#include "surrogates/discovery/watch/watch.h"
#include "surrogates/discovery/watch/watch_residuals.h"

namespace underbody::discovery {

/// What was learned from these steps, judged: the noise beside the declared figure (m, of a reading; nothing: none is),
/// and beside the noise that would be left with a force in the model that it may lack.
std::optional<WatchFault> fault_from_the_begin(const WatchPlant& plant, const std::deque<WatchStep>& steps,
                                               const WatchNoise& learned, std::optional<double> declared);

/// Where these steps are nothing that the model does, and with the gap or the input in another unit, turned round, or
/// each in the other's place they are.
std::optional<WatchDoubt> doubtful_log(const WatchPlant& plant, const std::deque<WatchStep>& steps);

}  // namespace underbody::discovery
