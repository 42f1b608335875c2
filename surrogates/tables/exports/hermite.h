// The numbers behind a table's value, for writers of code outside this room.
#pragma once

#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/grid.h"

namespace underbody::tables {

/// The piecewise cubic that ForceTable::value() evaluates, with its Hermite data. Lives as long as the table.
const CubicGrid& surface_of(const ForceTable& table);

}  // namespace underbody::tables
