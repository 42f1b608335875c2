// Points whose errors nobody stated.
#pragma once

#include <string>

#include "surrogates/tables/fit/force_table.h"

namespace underbody::tables {

/// "the points of lift_force state no errors and are taken as exact ..." of a table that goes through such points;
/// empty for any other. It belongs wherever the table's error is read: that error knows nothing of the points' own.
std::string exact_points(const ForceTable& table);

}  // namespace underbody::tables
