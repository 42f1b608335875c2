// Where the body of a model touches the ground.
#pragma once

#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// Gaps that every lift table of the model covers, m; +-1e300 where none has the gap as an axis.
struct GapRange {
    double lower = -1e300, upper = 1e300;
};
GapRange lift_gap_range(const Model& model);
/// [contact] gap; else zero, or the lower end of lift tables that reach below it (a shifted gap).
double contact_gap(const Model& model);

}  // namespace underbody::dynamics
