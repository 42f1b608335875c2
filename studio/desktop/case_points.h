// The loads of cases over the gap, where a study has no force table yet.
#pragma once

#include "cases/study.h"
#include "core/figure.h"

namespace underbody::studio {

/// Lift over gap, points of cases that differ in the gap alone in one colour; without points where the cases have no
/// gap or no lift.
[[nodiscard]] core::Figure lift_of_cases(const cases::Study& study, const cases::StudyResults& results);

}  // namespace underbody::studio
