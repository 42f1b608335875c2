// Variants side by side, and how well forces at several speeds or voltages fall on one curve.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "surrogates/tables/force_table.h"
#include "surrogates/tables/line.h"

namespace underbody::tables {

/// What a variant is judged by.
enum class Measure {
    lowest,           ///< smallest mean over the common range (drag)
    highest,          ///< largest mean (lift)
    restoring_slope,  ///< largest -dF/d(axis)
    restoring_width,  ///< widest total range with dF/d(axis) < 0 (pitch window)
};

struct ComparisonOptions {
    std::string axis;   ///< along which; empty: gap, or the first
    Held held;          ///< SI
    Measure measure = Measure::restoring_slope;
};

/// Where two tables differ by more than twice their joint error.
struct Difference {
    std::string first, second;
    std::vector<std::pair<double, double>> beyond_error;  ///< ranges of the axis, SI
    double largest = 0;   ///< second - first where it is largest in size
    double at = 0;        ///< there
    double sigma = 0;     ///< joint error there
};

struct Comparison {
    std::string quantity, axis, measure;
    double lower = 0, upper = 0;  ///< common range
    std::vector<std::string> names;
    std::vector<double> values;   ///< of the measure, one a table
    std::vector<double> errors;   ///< one standard deviation of it, from 40 draws of each table
    std::string winner;
    bool beyond_error = false;    ///< the winner leads the next by more than twice the joint error
    std::vector<Difference> differences;
};

/// Throws core::UsageError: fewer than two tables, different quantities, no common range.
Comparison compare_tables(const std::vector<std::pair<std::string, ForceTable>>& tables, const ComparisonOptions& options);
void to_json(nlohmann::json& json, const Comparison& comparison);

struct CollapseOptions {
    double density = 998;    ///< kg/m^3
    double length = 0;       ///< m, of a column `length`, or this; 0: gap stays as it is
    double area = 0;         ///< m^2, S_xy; 0: pi/4 length width, or 1 when no width is known
    double width = 0;        ///< m
    std::string by = "speed";  ///< speed or jet_voltage
};

struct CollapseGroup {
    double level = 0;          ///< the speed or voltage
    std::size_t points = 0;
    double mean_ratio = 1;     ///< collapsed force over the reference curve, mean
    double exponent = 2;       ///< that would make it fall on the curve of the reference group
    double worst = 0;          ///< largest deviation, in its joint error
    double worst_gap = 0;      ///< m
};

struct Collapse {
    std::string quantity, by, by_unit;
    double reference = 0;      ///< level of the group with most points
    std::vector<CollapseGroup> groups;   ///< the others
    bool holds = false;        ///< every point within twice its joint error of the reference curve
    double exponent = 2;       ///< over all groups; NaN when there is one group only
    std::string verdict;
    core::Table points;        ///< gap over length, coefficient (C_L or force over square), level, deviation
};

/// Points at several speeds (voltages) as coefficients over gap: C = 2 F/(rho U^2 S) (physics notes 4.4), or F/V^2. The group with most points is the
/// reference curve. Throws core::InputError when only one level is there, or nothing overlaps.
Collapse collapse(const core::Table& table, const std::string& quantity, const CollapseOptions& options);
void to_json(nlohmann::json& json, const Collapse& collapse);

}  // namespace underbody::tables
