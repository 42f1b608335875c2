// How far an integrator may step in a motion with recorded inputs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/no_limit.h"

namespace underbody::dynamics {

/// s: the shortest distance between rows at these times (s, rising), so that no corner of what they hold is stepped
/// over. Rows closer than a thousandth of the mean distance are a jump: the integrator finds it by its own error
/// control, and what acts between them moves no body.
inline double longest_step(const std::vector<double>& times) {
    constexpr double jump = 1e-3;
    double step = core::no_limit;
    if (times.size() < 2) {
        return step;
    }
    const double mean = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        const double apart = times[i + 1] - times[i];
        step = apart >= jump * mean ? std::min(step, apart) : step;
    }
    return step;
}

}  // namespace underbody::dynamics
