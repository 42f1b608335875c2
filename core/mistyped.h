// Names that a person probably meant otherwise.
#pragma once

#include <string>

#include "core/table.h"

namespace underbody::core {

/// The quantity (`quantity_names()`) that a number of an unknown name was probably meant for: "sped" -> "speed". Empty
/// when the name is one of them, or is like none of them and may be a name of the user's own.
std::string mistyped_quantity(const std::string& name);

/// The quantity that a column of a table was probably meant for, though its name is another: "Gap (mm)", "force_in
/// [N]", "vz [m/s]", "trim angle [deg]". Empty for a quantity under its own name, for one that has another dimension,
/// and for a name that is like none of them. A column without a unit counts when all its fields are numbers.
std::string meant_quantity(const Column& column);

/// "name it 'gap [mm]'": the heading that the column of that quantity needs.
std::string heading_for(const Column& column, const std::string& quantity);

}  // namespace underbody::core
