#include "core/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/normal.h"

namespace underbody::core {

double quantile(std::vector<double> values, double p) {
    if (values.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const double place = std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size() - 1);
    const auto below = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), below, values.end());
    const double above = below + 1 == values.end() ? *below : *std::min_element(below + 1, values.end());
    return *below + (place - std::floor(place)) * (above - *below);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double central_deviation(std::vector<double> values) {
    constexpr double one_below = 0.1587, one_above = 0.8413;  // of a normal distribution
    constexpr std::size_t fewest = 4;
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    return values.size() < fewest ? 0 : (quantile(values, one_above) - quantile(values, one_below)) / 2;
}

double robust_deviation(std::vector<double> values) {
    const double middle = median(values);
    for (double& value : values) {
        value = std::abs(value - middle);
    }
    return sigma_of_median_distance * median(std::move(values));
}

double usual_step(std::span<const double> time) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < time.size(); ++i) {
        if (time[i] > time[i - 1]) {
            steps.push_back(time[i] - time[i - 1]);
        }
    }
    return steps.empty() ? 0 : median(std::move(steps));
}

}  // namespace underbody::core
