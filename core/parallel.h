// Parallel loops on oneTBB whose results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

#include "core/progress.h"

namespace underbody::core {

/// Limits the threads of every parallel loop in the process; 0: all cores.
void set_threads(int threads);
int threads();

/// Calls body(begin, end) over [0, count) in blocks of fixed size `block` (so that a block's result is the same
/// whatever the number of threads). Checks for cancelling between blocks; the first exception is rethrown.
void parallel_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& body,
                     Progress& progress = Progress::none());

/// Calls body(i) for each i in [0, count).
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body,
                  Progress& progress = Progress::none());

}  // namespace underbody::core
