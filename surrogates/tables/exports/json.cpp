// JSON: everything a program in another language needs to evaluate the table.
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

void export_json(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& /*result*/) {
    nlohmann::ordered_json json;
    json["format"] = "Underbody force table";
    json["version"] = 1;
    json["origin"] = header_lines(grid);
    json["quantity"] = grid.quantity;
    json["unit"] = grid.unit;
    json["meaning"] = grid.meaning;
    json["conditions"] = nlohmann::ordered_json::object();
    for (const auto& [name, value] : grid.conditions) {
        json["conditions"][name] = value;
    }
    json["how_to_evaluate"] =
        "Hold each coordinate at the ends of its axis. In its cell of width h with t = (x - x0)/h the one-dimensional functions are, for the "
        "lower end: value (1-t)^2 (1+2t), slope h t (1-t)^2; for the upper end: value t^2 (3-2t), slope -h t^2 (1-t). The value is the sum over the "
        "corners of the cell and over m of hermite[node][m] times the product over the axes k of the slope function where bit k of m is set and of "
        "the value function where it is not. Outside an axis its word 'outside' decides: clamp has slope 0 along it; refuse has neither value nor slopes; "
        "extrapolate adds to each of its four functions the distance beyond the end times their derivative there, so that the value goes on along its "
        "tangent. The last axis runs fastest in hermite and sigma. sigma: multilinear between the nodes, plus over the "
        "axes cell_error[k][cell] * 4 t (1-t), plus growth[k][0] * distance below or growth[k][1] * distance above its ends.";
    json["axes"] = nlohmann::ordered_json::array();
    for (const auto& axis : grid.axes) {
        json["axes"].push_back({{"name", axis.name}, {"unit", axis.unit}, {"outside", to_string(axis.range)}, {"points", axis.points}});
    }
    const std::size_t width = std::size_t{1} << grid.axes.size();
    auto& nodes = json["hermite"] = nlohmann::ordered_json::array();
    for (std::size_t node = 0; node < grid.surface.nodes(); ++node) {
        const double* data = &grid.surface.hermite()[node * width];
        nodes.push_back(std::vector<double>(data, data + width));
    }
    json["sigma"] = grid.error.node_sigma();
    json["cell_error"] = nlohmann::ordered_json::array();
    json["growth"] = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        json["cell_error"].push_back(grid.error.empty() ? std::vector<double>{} : grid.error.cell_error(k));
        json["growth"].push_back(grid.error.growth(k));
    }
    if (!grid.hull.empty()) {
        json["hull"] = grid.hull;  // points around which the table knows something, SI
    }
    core::write_file(path, json.dump(1) + "\n");
}

}  // namespace underbody::tables
