// Tables that OpenFOAM's function objects write: force.dat, moment.dat, coefficient.dat, surfaceFieldValue.dat ...
#pragma once

#include <string>
#include <string_view>

#include "postproc/importers/reports/monitor.h"

namespace underbody::postproc {

/// Does a text begin with lines "# ..." of which one names columns, "# Time ..."?
bool has_openfoam_table(std::string_view text);

/// The first column is the time (s, or the iteration of a steady run). Vectors in brackets give a column for each
/// component, columns of words are left out. What the lines "# name : value" say of coefficients (directions, reference
/// values, centre) is in Monitor::coefficients. Throws InputError with line for a row that is not as its heading says.
Monitor read_openfoam_table(const std::string& file, std::string_view text);

}  // namespace underbody::postproc
