// The loads of cases over the gap, where a study has no force table yet.
#pragma once

#include "core/figure.h"
#include "core/table.h"

namespace underbody::studio {

/// Lift over gap, points of one pitch in one colour; without points where the cases have no gap or no lift.
[[nodiscard]] core::Figure lift_of_cases(const core::Table& loads);

/// The [[table]] that makes a force table of them, as a study.toml has it; empty where there are no points.
[[nodiscard]] std::string table_of_cases(const core::Table& loads);

}  // namespace underbody::studio
