#include "cases/step_results.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace underbody::cases {

using nlohmann::json;

namespace {

/// JSON knows no infinity and no NaN: null.
double number(const json& value) { return value.is_null() ? std::nan("") : value.get<double>(); }

EquilibriumResult equilibrium(const json& point) {
    EquilibriumResult one;
    one.gap = number(point.at("gap"));
    one.stable = point.at("stable").get<bool>();
    one.stiffness = number(point.at("stiffness"));
    one.sigma = number(point.value("sigma", json()));
    one.stiffness_sigma = number(point.value("stiffness_sigma", json()));
    one.frequency = frequency_in_hertz(point);
    one.frequency_sigma = frequency_in_hertz(point, "frequency_sigma");
    one.kick_velocity = number(point.value("kick_velocity", json()));
    one.probability = number(point.value("probability", json()));
    return one;
}

std::vector<std::string> texts(const json& list) { return list.get<std::vector<std::string>>(); }

}  // namespace

const MeshResult::Quantity* MeshResult::find(const std::string& quantity) const {
    return find_result(quantities, quantity);
}

double frequency_in_hertz(const json& equilibrium, const std::string& key) {
    const double frequency = number(equilibrium.value(key, json()));
    return equilibrium.value("frequency_unit", "Hz") == "rad/s" ? frequency / (2 * std::numbers::pi) : frequency;
}

TableResult table_result(const std::string& name, const json& document) {
    TableResult table;
    table.name = name;
    table.quantity = document.at("quantity").get<std::string>();
    table.fit = document.at("kind").get<std::string>();
    table.points = core::read_csv(document.at("points").get<std::string>(), name);
    table.remarks = texts(document.at("remarks"));
    if (document.contains("equilibria")) {  // only with a net weight
        for (const auto& point : document.at("equilibria")) {
            table.equilibria.push_back(equilibrium(point));
        }
    }
    for (const auto& file : document.at("exports")) {
        table.exports.push_back({file.at("format").get<std::string>(), file.at("file").get<std::string>()});
    }
    return table;
}

MeshResult mesh_result(const std::string& name, const json& document) {
    MeshResult mesh;
    mesh.name = name;
    mesh.cells = document.at("cells").get<std::vector<double>>();
    for (const auto& [quantity, found] : document.at("quantities").items()) {
        MeshResult::Quantity one;
        one.name = quantity;
        for (const auto& value : found.at("values")) {
            one.values.push_back(number(value));
        }
        one.verdict = found.at("verdict").get<std::string>();
        one.standard_uncertainty = number(found.at("standard_uncertainty"));
        mesh.quantities.push_back(std::move(one));
    }
    return mesh;
}

RegionResult region_result(const std::string& name, const json& document) {
    RegionResult region;
    region.name = name;
    region.columns = document.at("columns").get<std::size_t>();
    region.rows = document.at("rows").get<std::size_t>();
    for (const auto& entry : document.at("classes")) {
        RegionResult::End end;
        end.name = entry.at("name").get<std::string>();
        end.kind = entry.at("kind").get<std::string>();
        end.fraction = number(entry.at("fraction"));
        if (entry.contains("gap")) {  // of attractors in heave
            end.gap = number(entry.at("gap"));
        }
        region.ends.push_back(std::move(end));
    }
    for (const auto& point : document.at("equilibria")) {
        region.equilibria.push_back(equilibrium(point));
        region.equilibria.back().frequency = frequency_in_hertz(point);
    }
    region.remarks = texts(document.at("remarks"));
    return region;
}

VerifyResult verify_result(const std::string& name, const json& document) {
    return {name,
            document.at("rows").size(),
            number(document.at("worst")),
            document.at("worst_case").get<std::string>(),
            document.at("failed").get<std::size_t>(),
            number(document.at("tolerance"))};
}

}  // namespace underbody::cases
