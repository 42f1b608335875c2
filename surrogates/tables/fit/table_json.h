// A table and its values as JSON, and the units and axes that people read them in.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "surrogates/tables/fit/force_table.h"

namespace underbody::tables {

/// Unit that people read this quantity in here: the one its column was written in, else the SI unit.
std::string shown_unit(const ForceTable& table, const std::string& quantity);

/// Positive numbers that span a factor of twenty and more are drawn on a logarithmic axis: on a linear one the small
/// ones, small gaps above all, would share one column of pixels.
bool spans_decades(double lower, double upper);

/// Evaluation and table as JSON (SI).
void to_json(nlohmann::json& json, const ForceTable& table);
nlohmann::json to_json(const ForceTable& table, const std::vector<double>& point, const Evaluation& evaluation);

}  // namespace underbody::tables
