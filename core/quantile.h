// Order statistics.
#pragma once

#include <vector>

namespace underbody::core {

/// The p-quantile (0..1) by linear interpolation between order statistics; NaN for no values.
double quantile(std::vector<double> values, double p);
double median(std::vector<double> values);
/// Half the range from 15.87 to 84.13 % of the finite values: one standard deviation of normal ones, whatever the
/// tails. 0 for fewer than four.
double central_deviation(std::vector<double> values);

}  // namespace underbody::core
