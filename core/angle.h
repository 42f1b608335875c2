// Angles are radians in the program; degrees are for people.
#pragma once

#include <numbers>

namespace underbody::core {

/// rad.
constexpr double degree = std::numbers::pi / 180;

}  // namespace underbody::core
