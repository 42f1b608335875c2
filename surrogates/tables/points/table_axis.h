// The axes of a table, and what a reader of points must know of them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "surrogates/tables/points/range_policy.h"

namespace underbody::tables {

inline constexpr std::size_t max_axes = 4;

struct TableAxis {
    std::string name;  ///< a quantity name: gap, pitch, speed, jet_voltage, ...
    std::string unit;  ///< SI
    double lower =
        0;  ///< the range of the table; its grid lines may reach further (sums of tables that end in different places)
    double upper = 0;
    std::vector<double> points;  ///< distinct set points, ascending
    RangePolicy range = RangePolicy::clamp;
};

/// Which columns are axes, and what happens beyond their ends.
struct AxisOptions {
    RangePolicies range;            ///< a name that is no axis of the table: core::UsageError
    std::vector<std::string> axes;  ///< columns to use as axes; empty: every known set-point column that varies
};

}  // namespace underbody::tables
