#include "geometry/water/above_ground.h"

#include "core/error.h"
#include "core/text.h"

namespace underbody::geometry {

void require_above_ground(const Clearance& clearance, const Placement& placement) {
    if (clearance.smallest <= 0) {
        throw core::InputError("contact",
                               "the body's " + clearance.patch + " is " +
                                   core::format_number(-1000 * clearance.smallest, 4) +
                                   " mm below the ground at this gap and pitch",
                               {},
                               "the nearest allowed gap: above " +
                                   core::format_number(1000 * (placement.gap - clearance.smallest), 6) + " mm");
    }
}

}  // namespace underbody::geometry
