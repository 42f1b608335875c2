// The vehicle's axes in those of a file.
#pragma once

#include <array>

namespace underbody::postproc {

/// Unit vectors, file axes; starboard = forward x up.
struct VehicleAxes {
    std::array<double, 3> forward, up, starboard;
};

/// Throws core::UsageError: an axis without a direction, forward and up that are not perpendicular.
VehicleAxes vehicle_axes(const std::array<double, 3>& forward, const std::array<double, 3>& up);

}  // namespace underbody::postproc
