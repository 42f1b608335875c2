// From a table of measured or computed points to clean data for a fit: which columns are axes, which rows count,
// what repeats, and whether the points fill a grid.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/table.h"
#include "surrogates/tables/points/table_axis.h"

namespace underbody::tables {

/// Points of one quantity, ready to be fitted. All SI; repeated set points are merged.
struct SetPoints {
    std::string quantity;
    std::string unit;
    std::vector<TableAxis> axes;
    std::vector<std::vector<double>> x;  ///< [row][axis]
    std::vector<double> value;           ///< [row]
    std::vector<double> sigma;           ///< [row]; empty when the table states no errors
    std::vector<double> doubted;   ///< [row] what a suspect point misses the others by, a standard deviation beside its
                                   ///< own; empty: none is suspect
    std::vector<double> scatter;   ///< [row] noise found in points that state no errors; empty: none
    std::vector<std::size_t> row;  ///< row of the table that each came from (the first of those merged)
    bool full_grid = false;        ///< every combination of the axes' points occurs exactly once
    std::string missing;           ///< not a grid, but nearly one: which set points lack
    std::vector<std::size_t> order;  ///< full grid: order[i] is the row at grid node i (last axis fastest)
    /// Columns of the table that hold one value throughout: the conditions of the table (name, SI value).
    std::vector<std::pair<std::string, double>> constants;
    core::Table table;  ///< the rows that were used
    core::Problems remarks;

    [[nodiscard]] bool has_sigma() const { return !sigma.empty(); }
    /// Known standard deviation of a point: what it states, or its scatter, and what it is doubted by.
    [[nodiscard]] double noise(std::size_t i) const {
        const auto of = [i](const std::vector<double>& v) { return v.empty() ? 0 : v[i]; };
        return std::hypot(of(sigma), of(scatter), of(doubted));
    }
    [[nodiscard]] bool is_doubted(std::size_t i) const { return !doubted.empty() && doubted[i] > 0; }
};

/// How a comment of a table begins that changes what its numbers mean: it is a warning of every table that is made of
/// them, and so stands where these are read, in exports too.
inline constexpr std::string_view warning_comment = "warning: ";

/// Throws core::InputError with file, line and column: unknown quantity, one point, an axis without spread, set points
/// that repeat and disagree, sigma zero or negative or missing, missing set points, no axis at all, more than max_axes.
SetPoints set_points(const core::Table& table, const std::string& quantity, const AxisOptions& options);

/// A point by its coordinates in the units of its file: "gap 5 mm, pitch 2 deg".
std::string described(const SetPoints& points, std::size_t point);

/// Names that can be axes of a table: set points and states, not forces.
const std::vector<std::string>& axis_names();

}  // namespace underbody::tables
