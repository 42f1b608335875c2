#include "core/normal.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <numbers>

namespace underbody::core {

double normal_quantile(double tail) { return std::numbers::sqrt2 * boost::math::erfc_inv(2 * tail); }

Interval wilson_interval(double successes, double trials) {
    if (!(trials > 0)) {
        return {0, 1};
    }
    constexpr double z = sigmas_of_95;
    const double p = successes / trials;
    const double centre = (p + z * z / (2 * trials)) / (1 + z * z / trials);
    const double half = z / (1 + z * z / trials) * std::sqrt(p * (1 - p) / trials + z * z / (4 * trials * trials));
    return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

}  // namespace underbody::core
