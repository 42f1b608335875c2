// How far a load is from what somebody else states of it: one measure for reports, monitors, manifests and studies.
#pragma once

#include <functional>

#include "postproc/field/vector_math.h"

namespace underbody::postproc {

/// N: size of the resultant force. `value_of("lift_force")` and of drag and side force, N; one that is not known
/// (not-a-number) counts as nought.
double resultant(const std::function<double(const char*)>& value_of);

/// What deviations are measured by.
struct LoadScale {
    double force = 0;   ///< N: size of the resultant force on the same zones
    double length = 0;  ///< m: of the body (LoadsResult::length)
};

/// The scale of loads whose resultant is `own`; where that is nothing beside the `stated` one, of this: nought is no
/// measure.
LoadScale load_scale(double own, double stated, double length);

/// What the difference of `own` and `stated` is put over: the force, for a moment force times length; the larger of
/// both where there is no force at all (a pure moment).
double load_measure(double own, double stated, bool moment, const LoadScale& scale);

/// |own - stated| of a force over the force, of a moment over force times length; over the larger of both where there
/// is no force at all (a pure moment). 0 where both are 0; not-a-number where one of them is.
double deviation(double own, double stated, bool moment, const LoadScale& scale);

}  // namespace underbody::postproc
