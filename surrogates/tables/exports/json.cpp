// JSON: everything a program in another language needs to evaluate the table.
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

constexpr const char* how_to_evaluate =
    "Hold each coordinate at the ends of its axis. In its cell of width h with t = (x - x0)/h the one-dimensional "
    "functions are, for the "
    "lower end: value (1-t)^2 (1+2t), slope h t (1-t)^2; for the upper end: value t^2 (3-2t), slope -h t^2 (1-t). "
    "The value is the sum over the "
    "corners of the cell and over m of hermite[node][m] times the product over the axes k of the slope function "
    "where bit k of m is set and of "
    "the value function where it is not. Beyond the points of an axis its word 'outside' decides: clamp has slope "
    "0 along it; refuse has neither value nor slopes; "
    "extrapolate adds to each of its four functions the distance beyond the end times their derivative there, so "
    "that the value goes on along its "
    "tangent. The last axis runs fastest in hermite and sigma. sigma: multilinear between the nodes, plus over the "
    "axes cell_error[k][cell] * 4 t (1-t), plus growth[k][0] * distance below or growth[k][1] * distance above its "
    "points. A point counts as outside where "
    "a coordinate is not from 'lower' to 'upper' of its axis. It has no data where it is outside, and where "
    "has_data of 'support' is 0 in the cell between "
    "its lines (last axis fastest; a line belongs to the cell above it). max_error: largest difference from what "
    "the table stands for, in its unit. "
    "Further quantities on the same grid stand under 'more'.";

/// What belongs to one quantity, into an object.
void write_quantity(nlohmann::ordered_json& json, const ExportGrid& grid, const ExportQuantity& quantity) {
    const std::size_t width = std::size_t{1} << grid.axes.size();
    json["max_error"] = quantity.difference;
    json["warnings"] = quantity.warnings;
    json["told"] = quantity.told;
    auto& nodes = json["hermite"] = nlohmann::ordered_json::array();
    for (std::size_t node = 0; node < quantity.surface.nodes(); ++node) {
        const double* data = &quantity.surface.hermite()[node * width];
        nodes.push_back(std::vector<double>(data, data + width));
    }
    json["sigma"] = quantity.error.node_sigma();
    json["cell_error"] = nlohmann::ordered_json::array();
    json["growth"] = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        json["cell_error"].push_back(quantity.error.empty() ? std::vector<double>{} : quantity.error.cell_error(k));
        json["growth"].push_back(quantity.error.growth(k));
    }
}

}  // namespace

void export_json(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& /*result*/) {
    nlohmann::ordered_json json;
    json["format"] = "Underbody force table";
    json["version"] = 1;
    json["name"] = grid.name;
    json["origin"] = header_lines(grid);
    json["quantity"] = grid.first().name;
    json["unit"] = grid.first().unit;
    json["meaning"] = grid.first().meaning;
    json["conditions"] = nlohmann::ordered_json::object();
    for (const auto& [name, value] : grid.conditions) {
        json["conditions"][name] = value;
    }
    json["how_to_evaluate"] = how_to_evaluate;
    json["axes"] = nlohmann::ordered_json::array();
    for (const auto& axis : grid.axes) {
        json["axes"].push_back({{"name", axis.name},
                                {"unit", axis.unit},
                                {"outside", to_string(axis.range)},
                                {"lower", axis.lower},
                                {"upper", axis.upper},
                                {"points", axis.points}});
    }
    write_quantity(json, grid, grid.first());
    for (std::size_t i = 1; i < grid.quantities.size(); ++i) {
        nlohmann::ordered_json more{{"quantity", grid.quantities[i].name},
                                    {"unit", grid.quantities[i].unit},
                                    {"meaning", grid.quantities[i].meaning}};
        write_quantity(more, grid, grid.quantities[i]);
        json["more"].push_back(std::move(more));
    }
    if (!grid.hull.empty()) {
        json["hull"] = grid.hull;  // points around which the table knows something, SI
    }
    if (!grid.support.empty()) {
        json["support"] = {{"lines", grid.support.lines()}, {"has_data", grid.support.has_data()}};
    }
    core::write_file(path, json.dump(1) + "\n");
}

}  // namespace underbody::tables
