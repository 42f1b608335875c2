// Which cases make one curve over the gap.
#pragma once

#include <cstddef>
#include <vector>

#include "cases/conditions.h"

namespace underbody::cases {

/// Cases that differ in the gap alone.
struct GapGroup {
    Conditions held;                 ///< what tells them from the other groups
    std::vector<std::size_t> cases;  ///< indices of those that were given
};

/// In the order of their first case; cases without a gap are in none.
std::vector<GapGroup> gap_groups(const std::vector<const Conditions*>& entries);

/// What the cases of the fullest curve have: of the groups of which most is known that with the most cases. Empty where
/// all are one group, or no case has a gap.
Conditions held_by_fullest(const std::vector<GapGroup>& groups);

}  // namespace underbody::cases
