// The states that a stability map may have as axes.
#pragma once

#include <array>
#include <string>

namespace underbody::studio {

/// Of a state of the motion in heave and pitch.
inline std::size_t place_of(const std::string& axis) {
    return axis == "gap" ? 0U : axis == "heave_velocity" ? 1U : axis == "pitch" ? 2U : 3U;
}

/// SI.
inline const char* unit_of(const std::string& axis) {
    constexpr std::array<const char*, 4> units = {"m", "m/s", "rad", "rad/s"};
    return units[place_of(axis)];
}

}  // namespace underbody::studio
