#include "postproc/loads/vehicle_axes.h"

#include <string>

#include "core/error.h"
#include "postproc/field/vector_math.h"

namespace underbody::postproc {

VehicleAxes vehicle_axes(const Vector& forward, const Vector& up) {
    const auto unit = [](const Vector& v, const char* name) {
        const double size = norm(v);
        if (!(size > 0)) {
            throw core::UsageError("usage", std::string("the ") + name + " axis has no direction");
        }
        return Vector{v[0] / size, v[1] / size, v[2] / size};
    };
    VehicleAxes axes{unit(forward, "forward"), unit(up, "up"), {}};
    if (std::abs(dot(axes.forward, axes.up)) > 1e-6) {
        throw core::UsageError("usage", "forward and up are not perpendicular", {},
                               "for instance option 'forward +x' and option 'up +z'");
    }
    axes.starboard = cross(axes.forward, axes.up);
    return axes;
}

}  // namespace underbody::postproc
