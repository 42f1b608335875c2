// reading = force + slope (depth, or gap where no depth is given) + force
#include "surrogates/dynamics/effects/immersed_part.h"

namespace underbody::dynamics {

const Effect& strut_buoyancy_effect() {
    static const ImmersedPart kind("strut_buoyancy", "buoyancy of an immersed strut", "depth", "cable_buoyancy", 0.85);
    return kind;
}

}  // namespace underbody::dynamics
