// Order statistics.
#pragma once

#include <vector>

namespace underbody::core {

/// The p-quantile (0..1) by linear interpolation between order statistics; NaN for no values.
double quantile(std::vector<double> values, double p);
double median(std::vector<double> values);

}  // namespace underbody::core
