// The closed forms of this room, for people and tests.
#pragma once

#include <vector>

#include "core/closed_form.h"

namespace underbody::geometry {

/// "ellipsoid": added mass of an ellipsoid in unbounded ideal fluid, and the body of even density that it belongs to.
const std::vector<core::ClosedForm>& closed_forms();

}  // namespace underbody::geometry
