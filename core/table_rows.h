// Which rows of a table lie within ranges of its columns.
#pragma once

#include <string>
#include <vector>

#include "core/table.h"
#include "core/units.h"

namespace underbody::core {

/// Ranges of columns of this table, "volume=2000cm^3:2300cm^3,gap=1mm:5mm" (numbers without a unit are SI).
/// Throws UsageError: no such column of numbers (with the nearest), what is no range.
std::vector<NamedRange> ranges_of_columns(const std::string& text, const Table& table);

/// Rows whose values lie within every range, ends included; a missing value lies in none.
/// Throws UsageError: no such column of numbers (with the nearest).
std::vector<std::size_t> rows_within(const Table& table, const std::vector<NamedRange>& ranges);

}  // namespace underbody::core
