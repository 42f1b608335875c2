#include "surrogates/tables/exports/export.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "surrogates/tables/exports/export_grid.h"
#include "surrogates/tables/fit/table_json.h"
#include "surrogates/tables/points/table_files.h"

namespace underbody::tables {

namespace {

struct Exporter {
    ExportFormat format;
    void (*write)(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
    bool straight = false;  ///< its consumer draws straight lines between the points
    std::filesystem::path (*beside)(const std::filesystem::path& path) = nullptr;  ///< a second file that it writes
    std::size_t most_axes = max_axes;
};

const std::vector<Exporter>& exporters() {
    static const std::vector<Exporter> all = {
        {{"c", table_ending("c"), "C99 header: no heap, no library, constant time; double, float or whole numbers"},
         export_c},
        {{"csv", table_ending("csv"), "table with slopes and error that this program reads back exactly"}, export_csv},
        {{"json", table_ending("json"), "grid, Hermite data and error"}, export_json},
        {{"mat", table_ending("mat"), "MATLAB and Octave: .mat and a .m that looks it up"},
         export_mat,
         false,
         mat_function},
        {{"jsbsim", table_ending("jsbsim"), "JSBSim functions with tables, fine enough for its linear interpolation"},
         export_jsbsim,
         true,
         nullptr,
         3},
        {{"simulink", table_ending("simulink"), "breakpoints and data of Simulink's n-D Lookup Table in one .mat"},
         export_simulink,
         true},
        {{"modelica", table_ending("modelica"), "text that Modelica's CombiTable1Ds and CombiTable2Ds read"},
         export_modelica,
         true,
         nullptr,
         2},
        {{"fmu", table_ending("fmu"),
          "FMU 2.0, model exchange and co-simulation; Linux and (with its cross compiler) Windows, source included"},
         export_fmu},
    };
    return all;
}

/// Every export says so near its beginning (an FMU in its first entry, which is stored as it is).
bool is_export(const std::filesystem::path& path) {
    const core::MappedFile file(path);
    const std::string_view head = file.bytes().substr(0, 4096);
    return file.bytes().empty() || head.find("orce table by Underbody") != std::string_view::npos ||
           head.find("Underbody force table") != std::string_view::npos;
}

/// A file that is there is replaced only if it is an export, and not the one that the table was made of.
void check_path(const std::filesystem::path& path, const ForceTable& table, bool overwrite) {
    std::error_code ignored;
    if (path.empty()) {
        throw core::UsageError("path", "an export needs a path to write to");
    }
    if (std::filesystem::is_directory(path, ignored)) {
        throw core::InputError("path", "this is a folder, an export is a file", {path.string(), {}, {}, {}},
                               "name a file in it, such as " + (path / "lift").string() + " with the format's ending");
    }
    if (!std::filesystem::exists(path, ignored)) {
        return;
    }
    if (std::filesystem::equivalent(path, table.source(), ignored)) {
        throw core::InputError("exists", "the table is made of this file: the export would replace its points",
                               {path.string(), {}, {}, {}}, "choose another name");
    }
    if (!overwrite && !is_export(path)) {
        throw core::InputError("exists", "the file is there and is no force table that Underbody wrote",
                               {path.string(), {}, {}, {}}, "choose another name, or say option 'overwrite'");
    }
}

const Exporter& exporter_of(const std::string& format) {
    const auto found = std::find_if(exporters().begin(), exporters().end(),
                                    [&](const Exporter& e) { return e.format.name == format; });
    if (found == exporters().end()) {
        std::vector<std::string> names;
        for (const auto& f : export_formats()) {
            names.push_back(f.name);
        }
        throw core::UsageError("format", "there is no export format '" + format + "'", {},
                               core::did_you_mean(format, names));
    }
    return *found;
}

/// Straight lines between the values of a grid, one axis after the other.
double straight_value(const CubicGrid& grid, const std::vector<double>& point) {
    const std::size_t axes = grid.dimensions();
    double sum = 0;
    for (std::size_t corner = 0; corner < std::size_t{1} << axes; ++corner) {
        double weight = 1;
        std::size_t node = 0;
        for (std::size_t k = 0; k < axes; ++k) {
            const auto spot = grid.spot(k, point[k]);
            const auto& x = grid.axis(k).points();
            const double share = spot.offset / (x[spot.cell + 1] - x[spot.cell]);
            const bool upper = (corner >> k & 1U) != 0;
            weight *= upper ? share : 1 - share;
            node = node * x.size() + spot.cell + (upper ? 1 : 0);
        }
        sum += weight * grid.hermite()[node << axes];
    }
    return sum;
}

}  // namespace

const std::vector<ExportFormat>& export_formats() {
    static const std::vector<ExportFormat> formats = [] {
        std::vector<ExportFormat> list;
        for (const auto& exporter : exporters()) {
            list.push_back(exporter.format);
        }
        return list;
    }();
    return formats;
}

ExportResult export_table(const ForceTable& table, const std::string& format, const std::filesystem::path& path,
                          const ExportOptions& options, core::Progress& progress) {
    return export_tables({table}, format, path, options, progress);
}

core::Figure export_difference_figure(const ForceTable& table, const std::string& format, const ExportOptions& options,
                                      core::Progress& progress) {
    ExportOptions up = options;  // the size of a difference is that in every frame
    up.frame = Frame::up;
    up.name = "difference";
    const bool straight = exporter_of(format).straight || options.fixed_point;
    const ExportGrid grid = export_grid({table}, up, straight, progress);
    const CubicGrid& written = grid.first().surface;
    const auto place = [&](std::size_t k, double share) {
        const double low = grid.axes[k].lower, high = grid.axes[k].upper;
        return spans_decades(low, high) ? low * std::pow(high / low, share) : low + share * (high - low);
    };
    constexpr int along = 240, across = 9;
    std::size_t others = 1;
    for (std::size_t k = 1; k < grid.axes.size(); ++k) {
        others *= across;
    }
    core::Figure figure;
    const ExportAxis& first = grid.axes.front();
    figure.x = {first.name, shown_unit(table, first.name), 0, 0, spans_decades(first.lower, first.upper)};
    figure.y = {"file less table", shown_unit(table, table.quantity()), 0, 0, false};
    core::FigureCurve curve;
    curve.colour = core::palette(1);
    std::vector<double> point(grid.axes.size());
    for (int i = 0; i <= along; ++i) {
        progress.check();
        point[0] = place(0, static_cast<double>(i) / along);
        double largest = 0;
        for (std::size_t other = 0; other < others; ++other) {
            for (std::size_t k = 1, rest = other; k < grid.axes.size(); ++k, rest /= across) {
                point[k] = place(k, static_cast<double>(rest % across) / (across - 1));
            }
            const double value = straight ? straight_value(written, point) : written.value(point.data(), nullptr);
            const double difference = value - table.value(point.data());
            largest = std::abs(difference) > std::abs(largest) ? difference : largest;
        }
        curve.x.push_back(core::convert(point[0], first.unit, figure.x.unit));
        curve.y.push_back(core::convert(largest, table.unit(), figure.y.unit));
    }
    figure.curves.push_back(std::move(curve));
    return figure;
}

ExportResult export_tables(const std::vector<ForceTable>& tables, const std::string& format,
                           const std::filesystem::path& path, const ExportOptions& options, core::Progress& progress) {
    const Exporter* found = &exporter_of(format);
    const std::size_t axes = tables.front().axes().size();
    if (axes > found->most_axes) {
        throw core::UsageError("format",
                               "the format " + format + " takes at most " + std::to_string(found->most_axes) +
                                   " axes, this table has " + std::to_string(axes),
                               {}, "hold one of them: select rows with option 'where'");
    }
    for (const ForceTable& table : tables) {
        check_path(path, table, options.overwrite);
        if (found->beside != nullptr) {
            check_path(found->beside(path), table, options.overwrite);
        }
    }
    if (options.self_test && format != "c") {
        throw core::UsageError("format", "a self-test is written beside a C header, not beside " + format);
    }
    if (options.fixed_point && (format != "c" || options.single_precision)) {
        throw core::UsageError("format", format != "c" ? "whole numbers are written as C, not as " + format
                                                       : "numbers are float or whole numbers, not both");
    }
    if (options.self_test) {
        check_path(c_self_test(path), tables.front(), options.overwrite);
    }
    progress.report(0, "export");
    ExportOptions named = options;
    named.name = identifier(options.name.empty() ? path.stem().string() : options.name);
    const ExportGrid grid = export_grid(tables, named, found->straight || options.fixed_point, progress);
    ExportResult result;
    result.files.push_back(path);
    result.error = grid.first().difference;
    for (const auto& quantity : grid.quantities) {
        result.errors.emplace_back(quantity.name, quantity.difference);
    }
    result.remarks = grid.remarks;
    for (const auto& axis : grid.axes) {
        result.grid.push_back(axis.points.size());
    }
    found->write(grid, path, result);
    progress.report(1, "export");
    return result;
}

}  // namespace underbody::tables
