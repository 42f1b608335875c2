// The residuals in the log of an OpenFOAM solver.
#pragma once

#include <string>
#include <string_view>

#include "postproc/importers/reports/monitor.h"

namespace underbody::postproc {

/// Does the text hold lines such as "smoothSolver:  Solving for Ux, Initial residual = 0.1, Final residual = ..."?
bool has_openfoam_residuals(std::string_view text);

/// One row a time: for each equation its initial residual, of the first time it is solved in that step (pressure is
/// solved several times). The first column is "Iteration", of transient solvers "Time".
Monitor read_openfoam_log(const std::string& file, std::string_view text);

}  // namespace underbody::postproc
