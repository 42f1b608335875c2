// The loads of many files as one table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "postproc/loads/loads_case.h"

namespace underbody::postproc {

/// Texts, numbers, loads (table_row) with their NAME_sigma, coefficients where some case has them, the reference point
/// and length, values_from, settled, file: one row a case. A condition or coefficient that a case does not have is
/// missing there. `written_units`: condition -> the unit to write it in. A condition called like a column of what was
/// found (the table of an earlier run as the manifest) is kept as NAME_stated. Of plane cases `depth` says what the
/// forces are per; throws core::InputError for plane cases among others.
core::Table loads_table(const std::vector<LoadsCase>& cases,
                        const std::vector<std::pair<std::string, std::string>>& written_units = {});

/// The loads against the same quantities in the conditions (a manifest that holds the solver's own forces). A value
/// that is missing is not compared; `notes` says so.
std::vector<Comparison> compare_with_stated(const std::vector<LoadsCase>& cases, core::Problems& notes);

/// {"files": [loads of each, with "conditions"]}
nlohmann::json loads_table_json(const std::vector<LoadsCase>& cases);

}  // namespace underbody::postproc
