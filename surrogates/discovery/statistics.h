// Small statistics that discovery and its bench share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/quantile.h"

namespace underbody::discovery {

using core::median;
using core::quantile;
using core::robust_deviation;
double mean(std::span<const double> values);
double root_mean_square(std::span<const double> values);

/// P(X > x) for X chi-squared with `dof` degrees of freedom.
double chi_squared_tail(double x, double dof);
/// P(X > x) for X of Fisher's F distribution.
double f_tail(double x, double dof_above, double dof_below);

/// -log10 of the chance that `count` squared normal values sum to more than `gain`; goes on where the chance is too
/// small for a number.
double surprise(double gain, double count);

double sum_of_squares(std::span<const double> values);

/// Chance that readings in which two laws lie `separation` standard deviations apart reach odds of 20 for the true one.
double chance_to_settle(double separation);

/// Autocorrelation of a series at a lag; 0 when it is constant.
double autocorrelation(std::span<const double> values, std::size_t lag);

/// Root mean square error over groups (runs) with its 95 % interval from resampling whole groups.
struct ErrorEstimate {
    double rmse = 0;
    double low = 0;
    double high = 0;
    std::size_t count = 0;
};
/// `sum_of_squares[g]` and `counts[g]` of each group. With fewer than five groups the resampled interval is too narrow
/// and is widened by the factor of Student's t over the normal. Deterministic by `seed`.
ErrorEstimate error_by_groups(const std::vector<double>& sum_of_squares, const std::vector<double>& counts,
                              std::uint64_t seed);

}  // namespace underbody::discovery
