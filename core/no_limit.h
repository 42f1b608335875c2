// Where there is no bound: one number that JSON, tables and generated C can hold (infinity they cannot).
#pragma once

#include <algorithm>
#include <cmath>

namespace underbody::core {

/// Above every quantity in SI units: an upper bound that bounds nothing (its negative a lower one), the start of a
/// search for the least, the cost of what cannot be evaluated.
constexpr double no_limit = 1e300;

/// A bound that bounds; sums and products with a number of ordinary size may have been made of it.
inline bool is_limit(double bound) { return std::abs(bound) < no_limit / 10; }

/// Below every quantity in SI units that is not zero.
constexpr double least_divisor = 1e-300;

/// A divisor that is not negative, never zero: a quotient by nothing is large and stays a number.
inline double never_zero(double divisor) { return std::max(divisor, least_divisor); }

}  // namespace underbody::core
