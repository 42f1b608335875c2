// How far an integrator may step in a motion with recorded inputs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/no_limit.h"
#include "surrogates/dynamics/plant/heave_terms.h"

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

/// `step` (s, 0: nothing bounds it), but no more than a tenth of a period of any wave that acts on the body.
inline double within_waves(double step, const HeaveTerms& terms) {
    for (const HeaveTerms::Wave& wave : terms.waves) {
        const double part = 0.1 / std::max(wave.frequency, 1e-9);
        step = step > 0 ? std::min(step, part) : part;
    }
    return step;
}

}  // namespace underbody::dynamics
