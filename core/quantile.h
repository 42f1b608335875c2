// Order statistics.
#pragma once

#include <span>
#include <vector>

namespace underbody::core {

/// The p-quantile (0..1) by linear interpolation between order statistics; NaN for no values.
double quantile(std::vector<double> values, double p);
/// The 0.5-quantile: of an even count half way between the two in the middle.
double median(std::vector<double> values);
/// Half the range from 15.87 to 84.13 % of the finite values: one standard deviation of normal ones, whatever the
/// tails. 0 for fewer than four.
double central_deviation(std::vector<double> values);
/// sigma_of_median_distance times the median distance from the median: the standard deviation of normal values, deaf to
/// outliers. NaN for no values.
double robust_deviation(std::vector<double> values);

/// The median of the steps between neighbouring times that run forward, in their unit; 0 where there is none.
double usual_step(std::span<const double> time);

}  // namespace underbody::core
