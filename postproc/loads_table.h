// The loads of many files as one table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "postproc/loads.h"
#include "postproc/settled.h"
#include "postproc/stated_loads.h"
#include "postproc/uncertainty.h"

namespace underbody::postproc {

/// A file's loads with the conditions it was computed for.
struct LoadsCase {
    std::string file;
    std::vector<std::pair<std::string, double>> numbers;      ///< condition -> SI value; quantity names get their units
    std::vector<std::pair<std::string, std::string>> texts;
    LoadsResult loads;
    std::vector<std::pair<std::string, double>> sigmas;             ///< lift_force -> standard uncertainty, SI
    std::vector<std::pair<std::string, MeshUncertainty>> meshes;    ///< lift_force -> what the mesh study says
    std::vector<std::pair<std::string, double>> scatters{};         ///< lift_force -> standard uncertainty by iteration (iteration_sigmas)
    std::vector<Comparison> comparisons{};                          ///< with the solver's own report
    Settled settled{};                                              ///< has the solution settled?
};

/// Texts, numbers, loads (table_row) with their NAME_sigma, coefficients where some case has them, the reference point,
/// values_from, settled, file: one row a case. A condition or coefficient that a case does not have is missing there.
/// `written_units`: condition -> the unit to write it in. A condition called like a column of what was found (the table
/// of an earlier run as the manifest) is kept as NAME_stated. Of plane cases `depth` says what the forces are per;
/// throws core::InputError for plane cases among others.
core::Table loads_table(const std::vector<LoadsCase>& cases, const std::vector<std::pair<std::string, std::string>>& written_units = {});

/// Throws core::InputError at `place` when a load's NAME_scatter is negative.
void check_scatters(const std::vector<std::pair<std::string, double>>& numbers, const core::Place& place);

/// The cases with the standard uncertainty of each load from its iteration alone: `scatters`, else the condition
/// NAME_scatter. Loads without either get none. Throws core::InputError: a negative NAME_scatter.
std::vector<LoadsCase> with_iteration_sigmas(const std::vector<LoadsCase>& cases);

/// Cases that differ in their mesh alone (the number of cells in condition `column`, or "faces": of the surface that was
/// integrated; same texts but `mesh`, same numbers but those of the mesh and of results) become one, that of the finest mesh,
/// with the uncertainty of each load from mesh_uncertainty(), that of the iteration added in. Sizes are those of volumes, of
/// plane cases those of areas (cells) and lines (faces). Cases with one mesh stay, with the sigma of the iteration when it is
/// known. `notes`: cases kept apart by a number that may as well follow from the mesh; that there is no study at all.
/// Throws core::InputError: a case without the column, two cases of one set point with the same number, a negative NAME_scatter.
std::vector<LoadsCase> mesh_studies(const std::vector<LoadsCase>& cases, const std::string& column, core::Problems& notes);

/// The loads against the same quantities in the conditions (a manifest that holds the solver's own forces). The measure
/// `of_force` is over the size of the stated lift, drag and side force; where they state nothing, of the own. A value that
/// is missing is not compared; `notes` says so.
std::vector<Comparison> compare_with_stated(const std::vector<LoadsCase>& cases, core::Problems& notes);

/// {"files": [loads of each, with "conditions"]}
nlohmann::json loads_table_json(const std::vector<LoadsCase>& cases);

}  // namespace underbody::postproc
