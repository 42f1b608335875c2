#include "core/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace underbody::core {

double quantile(std::vector<double> values, double p) {
    if (values.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    std::sort(values.begin(), values.end());
    const double place = std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size() - 1);
    const std::size_t below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double central_deviation(std::vector<double> values) {
    constexpr double one_below = 0.1587, one_above = 0.8413;  // of a normal distribution
    constexpr std::size_t fewest = 4;
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    return values.size() < fewest ? 0 : (quantile(values, one_above) - quantile(values, one_below)) / 2;
}

}  // namespace underbody::core
