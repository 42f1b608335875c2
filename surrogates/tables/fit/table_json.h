// A table and its values as JSON, and the units that people read them in.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "surrogates/tables/fit/force_table.h"

namespace underbody::tables {

/// Unit that people read this quantity in here: the one its column was written in, else the SI unit.
std::string shown_unit(const ForceTable& table, const std::string& quantity);

/// Evaluation and table as JSON (SI).
void to_json(nlohmann::json& json, const ForceTable& table);
nlohmann::json to_json(const ForceTable& table, const std::vector<double>& point, const Evaluation& evaluation);

}  // namespace underbody::tables
