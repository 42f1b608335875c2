// A table at many points at once, and how far a point lies from the points that a table was made of.
#pragma once

#include <cstddef>

#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/line.h"
#include "surrogates/tables/fit/support.h"

namespace underbody::tables {

/// ForceTable::value() of many points, bit for bit the same and several times as fast for two axes: `points` [count *
/// axes], `value` [count], `slope` (may be null) [count * axes], all SI.
void values(const ForceTable& table, const double* points, std::size_t count, double* value,
            double* slope = nullptr) noexcept;

/// Scattered points of two and more axes: distance of a point from their convex hull in shares of the axes' ranges (of
/// the logarithm of a gap that spans a factor of four or more). > 0: no points lie around, the error is that of an
/// extrapolation although no axis is exceeded. 0 inside, for one axis and for grids. Beyond an axis its end counts.
double beyond_points(const ForceTable& table, const double* point);

/// Which parts of the axes' box have points of the table around them (Evaluation::no_data says the same of one point);
/// null: all of it.
const Support* data_support(const ForceTable& table);

/// A warning for every held value that lies outside its axis: by how much, what the table does there, and whether the
/// number would fit in the unit of the table's file.
core::Problems outside_remarks(const ForceTable& table, const Held& held);

}  // namespace underbody::tables
