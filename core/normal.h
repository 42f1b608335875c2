// The normal distribution where verdicts and errors are told in it.
#pragma once

#include <cmath>

namespace underbody::core {

/// The number that a standard normal one exceeds with the chance `tail`, above 0 and below 1.
double normal_quantile(double tail);

/// Standard deviations on either side that hold 95 of 100 normal numbers.
inline constexpr double sigmas_of_95 = 1.959963984540054;

/// Standard deviation of normal numbers over the median of their distances from their median.
inline constexpr double sigma_of_median_distance = 1.482602218505602;

/// Standard deviations from which a difference counts as more than its error: of one in 22 normal numbers.
inline constexpr double beyond_sigmas = 2;
/// Is a difference of two numbers with these standard deviations more than twice their joint error? Not where one is
/// NaN.
inline bool beyond_joint_error(double difference, double sigma_a, double sigma_b) {
    return std::abs(difference) > beyond_sigmas * std::hypot(sigma_a, sigma_b);
}

struct Interval {
    double low = 0;
    double high = 0;
};
/// 95 % interval of a probability of which `successes` of `trials` were seen (Wilson 1927); 0 to 1 for no trials.
Interval wilson_interval(double successes, double trials);

}  // namespace underbody::core
