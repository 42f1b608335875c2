#include "postproc/loads/named_loads.h"

#include "postproc/field/vector_math.h"

namespace underbody::postproc {

NamedLoads named_loads(const Wrench& wrench, const VehicleAxes& axes) {
    const Vector astern = {-axes.forward[0], -axes.forward[1], -axes.forward[2]};
    const Vector down = {-axes.up[0], -axes.up[1], -axes.up[2]};
    // 0.0 + makes minus zero plain zero.
    return {0.0 + dot(wrench.force, axes.up),        0.0 + dot(wrench.force, astern),
            0.0 + dot(wrench.force, axes.starboard), 0.0 + dot(wrench.moment, axes.starboard),
            0.0 + dot(wrench.moment, axes.forward),  0.0 + dot(wrench.moment, down)};
}

}  // namespace underbody::postproc
