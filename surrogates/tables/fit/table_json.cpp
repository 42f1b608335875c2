#include "surrogates/tables/fit/table_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/units.h"
#include "surrogates/tables/fit/table_batch.h"

namespace underbody::tables {

namespace {
/// Of all axes; "mixed" when they differ.
std::string common_policy(const std::vector<TableAxis>& axes) {
    const bool same =
        std::all_of(axes.begin(), axes.end(), [&](const TableAxis& a) { return a.range == axes.front().range; });
    return same ? to_string(axes.front().range) : "mixed";
}
}  // namespace

bool spans_decades(double lower, double upper) { return lower > 0 && upper >= 20 * lower; }

std::string shown_unit(const ForceTable& table, const std::string& quantity) {
    if (const core::Column* column = table.points().find(quantity); column != nullptr && !column->is_text()) {
        return column->written_unit.empty() ? column->unit : column->written_unit;
    }
    const auto* known = core::find_quantity(quantity);
    return known != nullptr ? known->unit : table.unit();
}

void to_json(nlohmann::json& json, const ForceTable& table) {
    json = nlohmann::json{{"quantity", table.quantity()},
                          {"unit", table.unit()},
                          {"kind", table.kind()},
                          {"source", table.source()},
                          {"points", table.points().rows()},
                          {"range_policy", common_policy(table.axes())}};
    json["axes"] = nlohmann::json::array();
    for (std::size_t k = 0; k < table.axes().size(); ++k) {
        const TableAxis& axis = table.axes()[k];
        json["axes"].push_back({{"name", axis.name},
                                {"unit", axis.unit},
                                {"lower", axis.lower},
                                {"upper", axis.upper},
                                {"range_policy", to_string(axis.range)},
                                {"set_points", axis.points.size()},
                                {"grid_lines", table.knots(k).size()}});
    }
    json["conditions"] = nlohmann::json::object();
    for (const auto& [name, value] : table.conditions()) {
        json["conditions"][name] = value;
    }
    json["remarks"] = nlohmann::json::array();
    for (const auto& remark : table.remarks()) {
        json["remarks"].push_back(remark.message);
    }
}

nlohmann::json to_json(const ForceTable& table, const std::vector<double>& point, const Evaluation& evaluation) {
    nlohmann::json json{{"quantity", table.quantity()}, {"unit", table.unit()},          {"value", evaluation.value},
                        {"sigma", evaluation.sigma},    {"outside", evaluation.outside}, {"kind", table.kind()}};
    json["no_data"] = evaluation.no_data;
    json["max_error"] = table.sampling_error();
    json["beyond_points"] = beyond_points(table, point.data());
    for (std::size_t k = 0; k < point.size(); ++k) {
        const std::string& name = table.axes()[k].name;
        json["at"][name] = point[k];
        json["slope"][name] = evaluation.slope[k];
        json["beyond"][name] = evaluation.beyond[k];
    }
    return json;
}

}  // namespace underbody::tables
