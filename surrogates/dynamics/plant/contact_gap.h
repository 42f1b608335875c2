// Where the body of a model touches the ground.
#pragma once

#include "core/no_limit.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// Gaps that every lift table of the model covers, m; +-core::no_limit where none has the gap as an axis.
struct GapRange {
    double lower = -core::no_limit, upper = core::no_limit;
};
GapRange lift_gap_range(const Model& model);
/// [contact] gap; else zero, or the lower end of lift tables that reach below it (a shifted gap).
double contact_gap(const Model& model);

}  // namespace underbody::dynamics
