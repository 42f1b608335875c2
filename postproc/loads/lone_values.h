// Pressures of a few places that stand far from all others.
#pragma once

#include <vector>

#include "postproc/loads/loads_parts.h"

namespace underbody::postproc {

/// A warning that names the first place whose pressure lies a thousand times as far from the middle as 99 in 100 of the
/// others do: a number written wrong, a cell that diverged. A few such values decide the force. Stagnation points and
/// edges reach some dozens.
void warn_of_lone_values(const std::vector<SummedZone>& parts, LoadsResult& result);

}  // namespace underbody::postproc
