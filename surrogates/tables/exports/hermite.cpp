#include "surrogates/tables/exports/hermite.h"

#include "surrogates/tables/fit/force_table_impl.h"

namespace underbody::tables {

const CubicGrid& surface_of(const ForceTable& table) { return table.impl().surface; }

}  // namespace underbody::tables
