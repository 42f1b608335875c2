// CSV: values, all slopes and the error at the grid lines; ForceTable::read takes it back as it was.
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

/// unit / axis unit / ...
std::string slope_unit(const ExportGrid& grid, const ExportQuantity& quantity, std::size_t mask) {
    std::string unit = quantity.unit == "1" ? "1" : quantity.unit;
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        if ((mask >> k & 1) == 0) {
            continue;
        }
        unit += " (" + grid.axes[k].unit + ")^-1";
    }
    return core::si_unit(unit);
}

/// What the columns do not say of one quantity.
nlohmann::json facts_of(const ExportGrid& grid, const ExportQuantity& quantity) {
    nlohmann::json facts{{"underbody_table", 1}};
    facts["quantity"] = quantity.name;
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        const ExportAxis& axis = grid.axes[k];
        facts["axes"].push_back(axis.name);
        facts["range"].push_back(to_string(axis.range));
        facts["known"].push_back({axis.lower, axis.upper});
        facts["cell_error"].push_back(quantity.error.empty() ? std::vector<double>{} : quantity.error.cell_error(k));
        facts["growth"].push_back(quantity.error.growth(k));
    }
    facts["conditions"] = nlohmann::json::object();
    for (const auto& [name, value] : grid.conditions) {
        facts["conditions"][name] = value;
    }
    facts["warnings"] = quantity.warnings;
    facts["told"] = quantity.told;
    if (!grid.hull.empty()) {
        facts["hull"] = grid.hull;
    }
    if (!grid.support.empty()) {
        facts["support"] = {{"lines", grid.support.lines()}, {"has_data", grid.support.has_data()}};
    }
    return facts;
}

}  // namespace

void export_csv(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& /*result*/) {
    const std::size_t n = grid.axes.size();
    const std::size_t width = std::size_t{1} << n;
    std::string text;
    for (const auto& line : header_lines(grid)) {
        text += "# " + line + "\n";
    }
    for (const auto& quantity : grid.quantities) {
        text += "# " + facts_of(grid, quantity).dump() + "\n";
    }
    for (const auto& axis : grid.axes) {
        text += axis.name + " [" + axis.unit + "], ";
    }
    for (const auto& quantity : grid.quantities) {
        text += (&quantity == &grid.first() ? "" : ", ") + quantity.name + " [" + quantity.unit + "], " +
                quantity.name + "_sigma [" + quantity.unit + "]";
        for (std::size_t mask = 1; mask < width; ++mask) {
            text += ", " + quantity.name + "_per";
            for (std::size_t k = 0; k < n; ++k) {
                text += (mask >> k & 1) != 0 ? "_" + grid.axes[k].name : "";
            }
            text += " [" + slope_unit(grid, quantity, mask) + "]";
        }
    }
    text += "\n";
    for (std::size_t node = 0; node < grid.first().surface.nodes(); ++node) {
        std::size_t rest = node;
        std::string line;
        for (std::size_t k = n; k-- > 0;) {
            const auto& points = grid.axes[k].points;
            line = core::format_number(points[rest % points.size()]) + ", " + line;
            rest /= points.size();
        }
        for (const auto& quantity : grid.quantities) {
            const double* data = &quantity.surface.hermite()[node * width];
            const double sigma = quantity.error.empty() ? 0 : quantity.error.node_sigma()[node];
            line += (&quantity == &grid.first() ? "" : ", ") + core::format_number(data[0]) + ", " +
                    (sigma > 0 ? core::format_number(sigma) : "");
            for (std::size_t mask = 1; mask < width; ++mask) {
                line += ", " + core::format_number(data[mask]);
            }
        }
        text += line + "\n";
    }
    core::write_file(path, text);
}

}  // namespace underbody::tables
