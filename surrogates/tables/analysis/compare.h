// Variants side by side: where they differ beyond their errors, and which wins.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/line.h"

namespace underbody::tables {

/// What a variant is judged by.
enum class Measure {
    lowest,           ///< smallest mean over the common range (drag)
    highest,          ///< largest mean (lift)
    restoring_slope,  ///< largest -dF/d(axis); only where that restores
    restoring_width,  ///< widest total range with dF/d(axis) < 0 (pitch window); only where that restores
    largest,          ///< largest value over the common range
    smallest,         ///< smallest value over the common range
};
/// "lowest", "restoring_slope", ...: as options and files write them.
const std::vector<std::string>& measure_names();

/// True where a force that falls along the axis brings the body back: lift along the gap, a moment along its own angle.
bool restores_along(const std::string& quantity, const std::string& axis);

/// "lift", "drag", "pitch moment": what people call the quantity.
std::string noun_of(const std::string& quantity);

struct ComparisonOptions {
    std::string axis;                ///< along which; empty: gap, or the first
    Held held;                       ///< SI
    std::optional<Measure> measure;  ///< default: restoring_slope where that restores, lowest of a drag, else highest
};

/// Where two tables differ by more than twice their joint error.
struct Difference {
    std::string first, second;
    std::vector<std::pair<double, double>> beyond_error;  ///< ranges of the axis, SI
    double largest = 0;                                   ///< second - first where it is largest in size
    double at = 0;                                        ///< there
    double sigma = 0;                                     ///< joint error there; NaN where points state none
};

struct Comparison {
    std::string quantity, axis, measure;
    double lower = 0, upper = 0;  ///< common range
    std::vector<std::string> names;
    std::string unit;            ///< of the measure, SI
    std::vector<double> values;  ///< of the measure, one a table
    std::vector<double> errors;  ///< one standard deviation of it, from 40 draws of each table
    std::string winner;          ///< empty when none restores, and for a single table
    bool errors_known = false;   ///< the points of all state errors; else `errors` are of the interpolation alone
    bool beyond_error = false;   ///< the winner leads the next by more than twice the joint error
    std::vector<Difference> differences;
};

/// Throws core::UsageError: no table, different quantities, no common range, a restoring measure of a force that does
/// not restore along the axis.
Comparison compare_tables(const std::vector<std::pair<std::string, ForceTable>>& tables,
                          const ComparisonOptions& options);
void to_json(nlohmann::json& json, const Comparison& comparison);

}  // namespace underbody::tables
