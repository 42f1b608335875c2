// reading = force + slope (depth, or gap where no depth is given) + force
#include "surrogates/dynamics/effects/immersed_part.h"

namespace underbody::dynamics {

const Effect& cable_buoyancy_effect() {
    static const ImmersedPart kind("cable_buoyancy", "buoyancy of a cable", "gap", "strut_buoyancy", 0.15);
    return kind;
}

}  // namespace underbody::dynamics
