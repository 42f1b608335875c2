// What those who read and compare stated loads share.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "postproc/loads/loads.h"

namespace underbody::postproc {

/// One of the six named loads as force or moment along an axis of the file.
struct NamedAxis {
    std::string name;
    bool moment;
    Vector direction;
};

inline std::vector<NamedAxis> named_axes(const LoadsResult& result) {
    const Vector astern = {-result.forward[0], -result.forward[1], -result.forward[2]};
    const Vector down = {-result.up[0], -result.up[1], -result.up[2]};
    return {{"lift_force", false, result.up},        {"drag_force", false, astern},
            {"side_force", false, result.starboard}, {"pitch_moment", true, result.starboard},
            {"roll_moment", true, result.forward},   {"yaw_moment", true, down}};
}

/// The row whose time is nearest; `times` are not empty.
inline std::size_t nearest_row(const std::vector<double>& times, double time) {
    const auto nearest = std::min_element(times.begin(), times.end(),
                                          [&](double a, double b) { return std::abs(a - time) < std::abs(b - time); });
    return static_cast<std::size_t>(nearest - times.begin());
}

}  // namespace underbody::postproc
