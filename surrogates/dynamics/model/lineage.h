// Lines of a model's lineage that mean something to the program.
#pragma once

#include <string_view>

namespace underbody::dynamics {

/// Begins a line that names what was found and what the data could not well tell it from ("coulomb_friction, or
/// linear_damping"). It is said wherever the model is read.
inline constexpr std::string_view tied_line = "tied: ";

}  // namespace underbody::dynamics
