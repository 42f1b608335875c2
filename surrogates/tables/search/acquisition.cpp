#include "surrogates/tables/search/acquisition.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace underbody::tables {

namespace {

// Beyond this many sigmas the sums below cancel: series in 1/z^2 take over.
constexpr double far = 25;

double log_density(double z) { return -0.5 * z * z - 0.5 * std::log(2 * std::numbers::pi); }
double cumulative(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// log of the standard normal's distribution function.
double log_cumulative(double z) {
    if (z > -far) {
        return std::log(cumulative(z));
    }
    const double q = 1 / (z * z);
    return log_density(z) - std::log(-z) + std::log1p(-q * (1 - 3 * q * (1 - 5 * q * (1 - 7 * q))));
}

/// log(density(z) + z * cumulative(z)).
double log_gain(double z) {
    if (z > -far) {
        return std::log(std::exp(log_density(z)) + z * cumulative(z));
    }
    const double q = 1 / (z * z);
    return log_density(z) + std::log(q) + std::log1p(-3 * q * (1 - 5 * q * (1 - 7 * q * (1 - 9 * q))));
}

}  // namespace

LogImprovement log_expected_improvement(double mean, double sigma, double best) {
    if (!(sigma > 0)) {
        const double gain = best - mean;
        return gain > 0 ? LogImprovement{std::log(gain), -1 / gain, 0}
                        : LogImprovement{-std::numeric_limits<double>::infinity(), 0, 0};
    }
    const double z = (best - mean) / sigma;
    const double log_g = log_gain(z);
    // g' = cumulative, and E = sigma g(z).
    const double ratio = std::exp(log_cumulative(z) - log_g);
    return {std::log(sigma) + log_g, -ratio / sigma, (1 - z * ratio) / sigma};
}

LogChance log_chance_below(double mean, double sigma, double limit) {
    if (!(sigma > 0)) {
        return {mean <= limit ? 0 : -std::numeric_limits<double>::infinity(), 0, 0};
    }
    const double z = (limit - mean) / sigma;
    const double log_p = log_cumulative(z);
    const double rate = std::exp(log_density(z) - log_p);
    return {log_p, -rate / sigma, -z * rate / sigma};
}

}  // namespace underbody::tables
