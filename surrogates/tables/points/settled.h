// Whether the solutions behind the points of a table had settled, where its column `settled` says so ("settled",
// "not settled", "unknown").
#pragma once

#include <string>
#include <vector>

#include "core/error.h"
#include "core/table.h"

namespace underbody::tables {

/// The cases (column `case`, else `file`, else "row N") whose solutions had not settled; empty without the column.
std::vector<std::string> not_settled(const core::Table& points);

/// A warning where some had not: "2 of 9 points are of solutions that have not settled: a, b".
core::Problems unsettled_points(const core::Table& points);

/// For the head of a file: that all had settled, or of how many it is not known. What had not is a warning of the
/// table.
std::vector<std::string> settled_lines(const core::Table& points);

}  // namespace underbody::tables
