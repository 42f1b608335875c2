// Refuses a body that touches the ground. For the files of this room only.
#pragma once

#include "geometry/water/placement.h"

namespace underbody::geometry {

/// Throws core::InputError when a body touches the ground or lies below it, with the nearest gap that is allowed.
void require_above_ground(const Clearance& clearance, const Placement& placement);

}  // namespace underbody::geometry
