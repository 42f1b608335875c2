// Numbers of solution variables in legacy Fluent data, in the solver's own names.
#pragma once

#include <string>

#include "postproc/field.h"

namespace underbody::postproc {

/// 1 -> "SV_P"; an unknown number n -> "SV_<n>".
std::string fluent_variable(int number);

/// Is a variable asked for? Canonical and original names count; SV_WALL_SHEAR is also wall_shear.
bool wants_variable(const ReadOptions& options, const std::string& variable);

/// To read again what walls without a pressure of their own need: the pressure of the cells, nothing else.
ReadOptions for_pressure_of_cells(const ReadOptions& options);

}  // namespace underbody::postproc
