#include "surrogates/dynamics/simulate/start_state.h"

#include <algorithm>
#include <cmath>

#include "core/no_limit.h"

namespace underbody::dynamics {

StartState start_state(const std::vector<double>& time, const std::vector<double>& gap, std::size_t first,
                       std::size_t last) {
    constexpr double window = 0.5;  // s: short beside the motions of a vehicle, long beside a sensor's noise
    constexpr std::size_t least = 5;
    constexpr double one_instant = 1e-12;  // spread of the times over their size
    StartState start;
    double n = 0, st = 0, sh = 0, stt = 0, sth = 0, low = core::no_limit, high = -core::no_limit;
    for (std::size_t i = first; i <= last && i < time.size(); ++i) {
        const double t = time[i] - time[first];
        if (std::isfinite(gap[i]) && (t < window || start.readings < least)) {
            ++start.readings;
            n += 1;
            st += t;
            sh += gap[i];
            stt += t * t;
            sth += t * gap[i];
            low = std::min(low, gap[i]);
            high = std::max(high, gap[i]);
        }
    }
    if (n == 0) {
        return start;
    }
    const double determinant = n * stt - st * st;
    if (determinant > one_instant * n * stt) {
        start.velocity = (n * sth - st * sh) / determinant;
        start.slope_factor = n / determinant;
        start.gap_factor = stt / determinant;
    }
    start.gap = (sh - start.velocity * st) / n;
    start.range = high - low;
    return start;
}

}  // namespace underbody::dynamics
