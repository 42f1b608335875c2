// The loads of many files as one table.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "postproc/loads/loads_case.h"

namespace underbody::postproc {

/// A row of a table of loads: under which conditions, and what was found.
struct LoadsRow {
    std::vector<std::pair<std::string, std::string>> texts;
    std::vector<std::pair<std::string, double>> numbers;  ///< SI
    std::vector<std::pair<std::string, double>> values;   ///< loads and their NAME_sigma, SI
};

/// What the columns of a table of loads are called.
struct LoadsColumns {
    std::vector<LoadsColumn> values;  ///< in this order; only name and unit count
    /// Of a condition that is a number: its SI unit, and the unit to write it in ("": the SI unit).
    std::function<std::pair<std::string, std::string>(const std::string& name)> units;
    std::function<bool(const std::string& name)> is_found;  ///< is this the name of what was found?
};

/// Adds to `table` what every table of loads has, of files or of a study: texts, numbers and values, one row a case.
/// What a case does not have is missing there. A condition called as what was found is, or as a column that `table` has
/// (the table of an earlier run as the manifest), is kept as NAME_stated; a value under a name that stands there is
/// left out.
void add_loads_rows(core::Table& table, const std::vector<LoadsRow>& rows, const LoadsColumns& columns);

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
