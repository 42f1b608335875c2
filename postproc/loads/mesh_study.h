// Which cases are one case on several meshes, and what these say of the error: one notion for the command line and
// studies.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/loads_case.h"

namespace underbody::postproc {

/// What tells cases apart: their conditions but the mesh and what was computed.
using SetPoint = std::vector<std::pair<std::string, std::string>>;

/// Of a case with these conditions (SI). `column` names its mesh or counts its cells; so do `mesh`, `cells`, `faces`,
/// `nodes`, `points` and `elements`. Results (lift_force, closure, ...) tell no cases apart.
SetPoint set_point(const std::vector<std::pair<std::string, std::string>>& texts,
                   const std::vector<std::pair<std::string, double>>& numbers, const std::string& column);

/// Names in which two set points are not alike.
std::vector<std::string> differences(const SetPoint& a, const SetPoint& b);

/// What meshes say of a force, or a moment, whose size is judged by `scale`: a rest of symmetry that is nothing beside
/// it has no order (mesh_uncertainty).
MeshUncertainty mesh_uncertainty_of(const std::vector<MeshValue>& values, bool moment, const LoadScale& scale);

/// Throws core::InputError at `place` when a load's NAME_scatter is negative.
void check_scatters(const std::vector<std::pair<std::string, double>>& numbers, const core::Place& place);

/// The cases with the standard uncertainty of each load from its iteration alone: `scatters`, else the condition
/// NAME_scatter. Loads without either get none. Throws core::InputError: a negative NAME_scatter.
std::vector<LoadsCase> with_iteration_sigmas(const std::vector<LoadsCase>& cases);

/// Cases that differ in their mesh alone (the number of cells in condition `column`, or "faces": of the surface that
/// was integrated; same texts but `mesh`, same numbers but those of the mesh and of results) become one, that of the
/// finest mesh, with the uncertainty of each load from mesh_uncertainty(), that of the iteration added in. Sizes are
/// those of volumes, of plane cases those of areas (cells) and lines (faces). Cases with one mesh stay, with the sigma
/// of the iteration when it is known. `notes`: cases kept apart by a number that may as well follow from the mesh; that
/// there is no study at all. Throws core::InputError: a case without the column, two cases of one set point with the
/// same number, a negative NAME_scatter.
std::vector<LoadsCase> mesh_studies(const std::vector<LoadsCase>& cases, const std::string& column,
                                    core::Problems& notes);

}  // namespace underbody::postproc
