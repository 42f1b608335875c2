// What CFX's solver writes as text (.out): residuals by iteration, and the forces on the walls at the end.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "postproc/importers/reports/force_report.h"
#include "postproc/importers/reports/monitor.h"

namespace underbody::postproc {

/// Does the text hold the tables of iterations of CFX's solver?
bool has_cfx_iterations(std::string_view text);
/// Does the text hold the wall forces that CFX's solver sums up at its end?
bool has_cfx_forces(std::string_view text);

/// One row per outer loop iteration (transient: per time step, of its last coefficient loop): for each equation its RMS
/// residual, and as "NAME max" the largest one. An equation that is not solved in an iteration has NaN there.
Monitor read_cfx_iterations(const std::string& file, std::string_view text);

/// "Pressure Force On Walls", "Viscous Force On Walls" and the same of the moments: reports along x, y, z in SI,
/// moments about the origin of the file's axes. The wall's force by the fluid, without the reference pressure (unless
/// the run says otherwise). Units are the run's solution units, SI where its command language does not say. Throws
/// InputError with line: a table without its counterpart, rows that do not add up to the totals below them (2 % of the
/// largest).
std::vector<ForceReport> read_cfx_forces(const std::string& file, std::string_view text);

}  // namespace underbody::postproc
