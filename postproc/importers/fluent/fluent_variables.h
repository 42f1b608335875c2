// Numbers of solution variables in legacy Fluent data, in the solver's own names.
#pragma once

#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/importers/mesh/face_mesh.h"

namespace underbody::postproc {

/// Fluent's own name.
inline const std::string pressure_variable = "SV_P";

/// 1 -> "SV_P"; an unknown number n -> "SV_<n>".
std::string fluent_variable(int number);

/// Is a variable asked for? Canonical and original names count; SV_WALL_SHEAR is also wall_shear.
bool wants_variable(const ReadOptions& options, const std::string& variable);

/// Of surfaces alone: is there a wall without a pressure on its own faces, so that the pressure of the cells beside it
/// has to be read too?
bool needs_pressure_of_cells(const FaceMesh& mesh, const std::vector<ValueBlock>& values, const ReadOptions& options);

/// To read again what walls without a pressure of their own need: the pressure of the cells, nothing else.
ReadOptions for_pressure_of_cells(const ReadOptions& options);

}  // namespace underbody::postproc
