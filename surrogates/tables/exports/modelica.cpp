// Modelica: the text that CombiTable1Ds and CombiTable2Ds of the Modelica Standard Library read.
#include "core/file.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

using Lines = std::vector<std::vector<double>>;

/// One matrix: the axis and the values beside it, or rows along the first and columns along the second axis.
template <class F>
std::string matrix(const std::string& name, const Lines& x, F&& f) {
    const bool one = x.size() == 1;
    std::string out = "\ndouble " + name + "(" + std::to_string(x[0].size() + (one ? 0 : 1)) + "," +
                      std::to_string(one ? 2 : x[1].size() + 1) + ")\n";
    if (!one) {
        out += "0";
        for (const double y : x[1]) {
            out += " " + core::format_number(y);
        }
        out += "\n";
    }
    const std::size_t columns = one ? 1 : x[1].size();
    for (std::size_t i = 0; i < x[0].size(); ++i) {
        out += core::format_number(x[0][i]);
        for (std::size_t j = 0; j < columns; ++j) {
            out += " " + core::format_number(f(i * columns + j));
        }
        out += "\n";
    }
    return out;
}

}  // namespace

void export_modelica(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    const std::size_t n = grid.axes.size();
    const std::string block = n == 1 ? "CombiTable1Ds" : "CombiTable2Ds";
    std::string out = "#1\n";
    for (const auto& line : grid.origin) {
        out += "# " + line + "\n";
    }
    out += "# Use: Modelica.Blocks.Tables." + block + "(tableOnFile=true, fileName=\"" + path.filename().string() +
           "\", tableName=\"" + identifier(grid.first().name) +
           "\", smoothness=Modelica.Blocks.Types.Smoothness.LinearSegments, "
           "extrapolation=Modelica.Blocks.Types.Extrapolation.HoldLastPoint)\n";
    out += std::string("# ") + (n == 1 ? "u" : "u1") + ": " + grid.axes[0].name + " [" + grid.axes[0].unit + "]" +
           (n == 1 ? "" : ", u2: " + grid.axes[1].name + " [" + grid.axes[1].unit + "]") +
           ". Beside each quantity its standard deviation (_sigma); no_data is 1 outside the range and where no points "
           "lie around.\n";
    Lines x;
    for (const auto& axis : grid.axes) {
        x.push_back(axis.points);
    }
    for (const ExportQuantity& q : grid.quantities) {
        out += matrix(identifier(q.name), x, [&](std::size_t node) { return q.surface.hermite()[node << n]; });
        out += matrix(identifier(q.name) + "_sigma", x,
                      [&](std::size_t node) { return q.error.empty() ? 0 : q.error.node_sigma()[node]; });
    }
    const Steps steps = no_data_steps(grid);
    out += matrix("no_data", steps.points, [&](std::size_t node) { return steps.value[node]; });
    core::write_file(path, out);
    for (const auto& axis : grid.axes) {
        if (axis.range != RangePolicy::clamp) {
            result.remarks.push_back(
                {core::Problem::Severity::warning,
                 "a CombiTable holds the ends of " + axis.name + ": it cannot " + to_string(axis.range),
                 {}});
        }
    }
}

}  // namespace underbody::tables
