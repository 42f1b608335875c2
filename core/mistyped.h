// Names that a person probably meant otherwise.
#pragma once

#include <string>

#include "core/table.h"

namespace underbody::core {

/// The quantity (`quantity_names()`) that a number of an unknown name was probably meant for: "sped" -> "speed". Empty
/// when the name is one of them, or is like none of them and may be a name of the user's own.
std::string mistyped_quantity(const std::string& name);

/// "there is no quantity 'sped'": what is said of a name that should be one of `quantity_names()`, and the hint that
/// belongs to it: the nearest one, or all.
std::string no_quantity(const std::string& name);
std::string quantity_hint(const std::string& name);

/// How sure it is that a word which is no quantity's name stands for one.
enum class Likeness {
    certain,   ///< "ride_height", "inlet_velocity": taken as said
    usual,     ///< "h", "theta", "fz": what loggers and post-processors call it; told as a mistake
    possible,  ///< "height", "angle", "flow": worth a remark
};

/// Lower case, words joined by '_', without what stands in round brackets: "Ride height (mm)" -> "ride_height".
std::string plain_name(const std::string& name);

/// The quantity that a word of people, loggers or solvers stands for, at least so sure; of several the first whose unit
/// has the dimension of `unit` (empty: any). Empty when it is a quantity's own name, or nobody's word.
std::string other_name_of(const std::string& word, Likeness likeness, const std::string& unit = {});

/// The quantity that a column of a table was probably meant for, though its name is another: "Gap (mm)", "force_in
/// [N]", "vz [m/s]", "trim angle [deg]". Empty for a quantity under its own name, for one that has another dimension,
/// and for a name that is like none of them. A column without a unit counts when all its fields are numbers.
std::string meant_quantity(const Column& column, Likeness likeness = Likeness::usual);

/// meant_quantity(), and of standard deviations the same with the ending "_sigma": "lift_froce_sigma [N]",
/// "lift_force_sgima [N]", "lift_force_std [N]" were meant for "lift_force_sigma".
std::string meant_name(const Column& column, Likeness likeness = Likeness::usual);

/// "'gap [mm]'": the heading that the column of that quantity, or of its standard deviation, needs.
std::string heading_for(const Column& column, const std::string& name);

}  // namespace underbody::core
