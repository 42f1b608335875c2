// Simulink: breakpoints and table data of n-D Lookup Table blocks in one .mat.
#include "core/file.h"
#include "surrogates/tables/exports/export_grid.h"
#include "surrogates/tables/exports/mat_file.h"

namespace underbody::tables {

namespace {

std::string help(const ExportGrid& grid) {
    std::string text;
    for (const auto& line : grid.origin) {
        text += line + "\n";
    }
    text += "n-D Lookup Table: table data " + identifier(grid.first().name) + ", breakpoints";
    for (const auto& axis : grid.axes) {
        text += " bp_" + identifier(axis.name) + " [" + axis.unit + "]";
    }
    text +=
        "; interpolation 'Linear point-slope', extrapolation 'Clip'.\nBeside each quantity its standard deviation "
        "(_sigma). no_data is 1 outside the range and where no points lie around, with breakpoints no_data_bp_ of its "
        "own, the same methods.\n";
    return text;
}

std::vector<std::size_t> sizes_of(const std::vector<std::vector<double>>& points) {
    std::vector<std::size_t> sizes;
    for (const auto& x : points) {
        sizes.push_back(x.size());
    }
    return sizes;
}

}  // namespace

void export_simulink(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    const std::size_t n = grid.axes.size();
    core::PendingFile pending(path);
    {
        MatFile file(pending.path());
        file.text("origin", help(grid));
        std::vector<std::vector<double>> points;
        const Steps steps = no_data_steps(grid);
        for (std::size_t k = 0; k < n; ++k) {
            const ExportAxis& axis = grid.axes[k];
            points.push_back(axis.points);
            file.reals("bp_" + identifier(axis.name), axis.points, 1, axis.points.size());
            file.reals("no_data_bp_" + identifier(axis.name), steps.points[k], 1, steps.points[k].size());
        }
        for (const ExportQuantity& quantity : grid.quantities) {
            const auto& hermite = quantity.surface.hermite();
            std::vector<double> value;
            for (std::size_t node = 0; node < quantity.surface.nodes(); ++node) {
                value.push_back(hermite[node << n]);
            }
            std::vector<double> sigma = quantity.error.node_sigma();
            sigma.resize(value.size(), 0.0);
            const std::string name = identifier(quantity.name);
            file.grid(name, value, sizes_of(points));
            file.grid(name + "_sigma", sigma, sizes_of(points));
            file.reals(name + "_max_error", {quantity.difference}, 1, 1);
        }
        file.grid("no_data", steps.value, sizes_of(steps.points));
    }
    pending.commit();
    for (const auto& axis : grid.axes) {
        if (axis.range != RangePolicy::clamp) {
            result.remarks.push_back(
                {core::Problem::Severity::warning,
                 "a lookup table holds the ends of " + axis.name + " (method Clip): it cannot " + to_string(axis.range),
                 {}});
        }
    }
}

}  // namespace underbody::tables
