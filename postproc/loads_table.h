// The loads of many files as one table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "postproc/loads.h"

namespace underbody::postproc {

/// A file's loads with the conditions it was computed for.
struct LoadsCase {
    std::string file;
    std::vector<std::pair<std::string, double>> numbers;      ///< condition -> SI value; quantity names get their units
    std::vector<std::pair<std::string, std::string>> texts;
    LoadsResult loads;
};

/// Texts, numbers, loads (table_row), file: one row a case. A condition that a case does not have is missing there.
/// `written_units`: condition -> the unit to write it in. A condition called like a load (a manifest that already has
/// lift_force) is kept as NAME_stated.
core::Table loads_table(const std::vector<LoadsCase>& cases, const std::vector<std::pair<std::string, std::string>>& written_units = {});

/// {"files": [loads of each, with "conditions"]}
nlohmann::json loads_table_json(const std::vector<LoadsCase>& cases);

}  // namespace underbody::postproc
