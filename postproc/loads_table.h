// The loads of many files as one table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "postproc/loads.h"
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
};

/// Texts, numbers, loads (table_row), file: one row a case. A condition that a case does not have is missing there.
/// `written_units`: condition -> the unit to write it in. A condition called like a load (a manifest that already has
/// lift_force) is kept as NAME_stated.
core::Table loads_table(const std::vector<LoadsCase>& cases, const std::vector<std::pair<std::string, std::string>>& written_units = {});

/// Cases that differ in their mesh alone (the number of cells in condition `column`; same texts but `mesh`, same set
/// points: gap, pitch, speed ...) become one, that of the finest mesh, with the uncertainty of each load from
/// mesh_uncertainty(); a condition NAME_scatter (iteration) is added in. Cases with one mesh stay, without a sigma
/// unless they have a scatter. Throws core::InputError when no case has the column.
std::vector<LoadsCase> mesh_studies(const std::vector<LoadsCase>& cases, const std::string& column = "cells");

/// A load against the same quantity in the conditions (a manifest that holds the solver's own forces).
struct Comparison {
    std::string file;
    std::string quantity;
    double value = 0;
    double stated = 0;
    double of_force = 0;  ///< |value - stated| over the size of the stated lift, drag and side force (moments: times the root of the area)
};
std::vector<Comparison> compare_with_stated(const std::vector<LoadsCase>& cases);

/// {"files": [loads of each, with "conditions"]}
nlohmann::json loads_table_json(const std::vector<LoadsCase>& cases);

}  // namespace underbody::postproc
