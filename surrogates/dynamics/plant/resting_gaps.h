// Where a body in heave may rest.
#pragma once

#include <utility>
#include <vector>

#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

/// m: from contact or the lower end of the force tables to their upper end.
std::pair<double, double> resting_range(const HeavePlant& plant);
/// Ascending, from one end of that range to the other: between neighbours lies at most one sign change of the force at
/// rest that a table can make, and the force is smooth.
std::vector<double> bracketing_gaps(const HeavePlant& plant);

}  // namespace underbody::dynamics
