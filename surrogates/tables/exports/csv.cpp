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
std::string slope_unit(const ExportGrid& grid, std::size_t mask) {
    std::string unit = grid.unit == "1" ? "1" : grid.unit;
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        if ((mask >> k & 1) == 0) {
            continue;
        }
        unit += " (" + grid.axes[k].unit + ")^-1";
    }
    return core::si_unit(unit);
}

}  // namespace

void export_csv(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& /*result*/) {
    const std::size_t n = grid.axes.size();
    const std::size_t width = std::size_t{1} << n;
    std::string text;
    for (const auto& line : header_lines(grid)) {
        text += "# " + line + "\n";
    }
    nlohmann::json facts{{"underbody_table", 1}};
    facts["quantity"] = grid.quantity;
    for (std::size_t k = 0; k < n; ++k) {
        facts["axes"].push_back(grid.axes[k].name);
        facts["range"].push_back(to_string(grid.axes[k].range));
        facts["cell_error"].push_back(grid.error.empty() ? std::vector<double>{} : grid.error.cell_error(k));
        facts["growth"].push_back(grid.error.growth(k));
    }
    facts["conditions"] = nlohmann::json::object();
    for (const auto& [name, value] : grid.conditions) {
        facts["conditions"][name] = value;
    }
    if (!grid.hull.empty()) {
        facts["hull"] = grid.hull;
    }
    text += "# " + facts.dump() + "\n";
    for (const auto& axis : grid.axes) {
        text += axis.name + " [" + axis.unit + "], ";
    }
    text += grid.quantity + " [" + grid.unit + "], " + grid.quantity + "_sigma [" + grid.unit + "]";
    for (std::size_t mask = 1; mask < width; ++mask) {
        text += ", " + grid.quantity + "_per";
        for (std::size_t k = 0; k < n; ++k) {
            text += (mask >> k & 1) != 0 ? "_" + grid.axes[k].name : "";
        }
        text += " [" + slope_unit(grid, mask) + "]";
    }
    text += "\n";
    for (std::size_t node = 0; node < grid.surface.nodes(); ++node) {
        std::size_t rest = node;
        std::string line;
        for (std::size_t k = n; k-- > 0;) {
            const auto& points = grid.axes[k].points;
            line = core::format_number(points[rest % points.size()]) + ", " + line;
            rest /= points.size();
        }
        const double* data = &grid.surface.hermite()[node * width];
        const double sigma = grid.error.empty() ? 0 : grid.error.node_sigma()[node];
        text += line + core::format_number(data[0]) + ", " + (sigma > 0 ? core::format_number(sigma) : "");
        for (std::size_t mask = 1; mask < width; ++mask) {
            text += ", " + core::format_number(data[mask]);
        }
        text += "\n";
    }
    core::write_file(path, text);
}

}  // namespace underbody::tables
