// The part of a case's Allrun that runs the solver, on one core or several.
#pragma once

#include <string>

namespace underbody::geometry {

/// Shell functions: `failed NAME CODE`, and `solver FOLDER NAME`, which runs simpleFoam in FOLDER (its log is log.NAME
/// of the case), with UNDERBODY_CORES above 1 by MPI: decomposed, run, put together again.
std::string solver_functions();

}  // namespace underbody::geometry
