// underbody info FILE: what a CFD file, a report of its solver, or a vehicle's log holds.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/counted.h"
#include "core/text.h"
#include "core/utf8.h"
#include "postproc/field/summary.h"
#include "postproc/importers/importer.h"
#include "postproc/loads/report_summary.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/shell.h"
#include "surrogates/dynamics/logs/log_summary.h"

namespace underbody::studio {

namespace {

std::string short_number(double value) { return std::isfinite(value) ? core::format_number(value, 5) : "-"; }

using Rows = std::vector<std::vector<std::string>>;

/// Every column as wide as its longest entry.
void print_columns(Shell& shell, const Rows& rows) {
    std::vector<std::size_t> widths(rows.front().size(), 0);
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            widths[i] = std::max(widths[i], row[i].size());
        }
    }
    std::string text;
    for (const auto& row : rows) {
        text += "\n";
        for (std::size_t i = 0; i < row.size(); ++i) {
            text += row[i] + (i + 1 < row.size() ? std::string(widths[i] - row[i].size() + 2, ' ') : "");
        }
    }
    shell.print(text);
}

void print(Shell& shell, const postproc::FieldSummary& summary) {
    shell.print(summary.file + ": " + summary.format +
                (summary.writer.empty() ? "" : ", written by " + summary.writer) +
                (summary.dimension == 2 ? ", two-dimensional" : ""));
    Rows zones = {{"zone", "kind", "points", "faces", "cells", "extent [m]"}};
    for (const auto& zone : summary.zones) {
        std::string extent;
        for (std::size_t k = 0; k < 3; ++k) {
            extent += std::string(k == 0 ? "" : "  ") + "xyz"[k] + " " + short_number(zone.lower[k]) + " .. " +
                      short_number(zone.upper[k]);
        }
        zones.push_back({zone.name, zone.kind, std::to_string(zone.points), std::to_string(zone.faces),
                         std::to_string(zone.cells), extent});
    }
    print_columns(shell, zones);
    if (summary.zones.size() > 1) {
        shell.print("\n" + core::counted(summary.points, "point") +
                    " zone by zone: those that zones share count in each");
    }
    Rows arrays = {{"array", "unit", "on", "min", "max", "in the file"}};
    for (const auto& array : summary.arrays) {
        arrays.push_back({array.name + (array.components > 1 ? " (" + std::to_string(array.components) + ")" : ""),
                          array.unit.empty() ? "?" : array.unit, array.on, short_number(array.min),
                          short_number(array.max),
                          array.original_name + (array.original_unit.empty() ? "" : " [" + array.original_unit + "]") +
                              (array.missing > 0 ? ", " + std::to_string(array.missing) + " missing" : "")});
    }
    print_columns(shell, arrays);
    shell.print("\npressure is " +
                (summary.pressure_reference == "unknown" ? std::string("gauge or absolute: the file does not say")
                                                         : summary.pressure_reference) +
                (summary.operating_pressure != 0
                     ? ", operating pressure " + short_number(summary.operating_pressure) + " Pa"
                     : ""));
    for (const auto& [key, value] : summary.metadata) {
        if (key != "time_values") {  // `times` says it shorter; all of them stand in the JSON
            shell.print(key + ": " + value);
        }
    }
}

void print(Shell& shell, const postproc::Monitor& monitor,
           const std::vector<std::optional<postproc::IterationScatter>>& scatter) {
    const auto& steps = monitor.values.front();
    shell.print("\n" + (monitor.title.empty() ? "" : monitor.title + ": ") + core::counted(steps.size(), "row") + ", " +
                monitor.columns.front() + " " + short_number(steps.front()) + " to " + short_number(steps.back()));
    Rows rows = {{"column", "last", "the last rows"}};
    for (std::size_t c = 1; c < monitor.columns.size(); ++c) {
        rows.push_back({core::as_utf8(monitor.columns[c]), short_number(monitor.values[c].back()),
                        scatter[c] ? scatter[c]->text : "too few to judge, or not all finite"});
    }
    print_columns(shell, rows);
}

void print(Shell& shell, const postproc::Plot& plot) {
    shell.print("\n" + (plot.title.empty() ? "plot" : plot.title) + ": " + plot.y_label + " over " + plot.x_label);
    Rows rows = {{"curve", "points", "x", "y"}};
    const auto range = [](const std::vector<double>& values) {
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        return values.empty() ? std::string("-") : short_number(*least) + " .. " + short_number(*most);
    };
    for (const auto& curve : plot.curves) {
        rows.push_back({core::as_utf8(curve.name), std::to_string(curve.x.size()), range(curve.x), range(curve.y)});
    }
    print_columns(shell, rows);
}

void print(Shell& shell, const postproc::ForceReport& report) {
    const auto triple = [](const std::array<double, 3>& v) {
        return "(" + short_number(v[0]) + " " + short_number(v[1]) + " " + short_number(v[2]) + ")";
    };
    shell.print(std::string("\n") +
                (report.moments ? "moments [N m] about " + triple(report.centre) + ", axis " : "forces [N] along ") +
                triple(report.direction));
    Rows rows = {{"zone", "pressure", "viscous", "total"}};
    for (const auto& row : report.rows) {
        rows.push_back(
            {core::as_utf8(row.zone), short_number(row.pressure), short_number(row.viscous), short_number(row.total)});
    }
    print_columns(shell, rows);
}

void print(Shell& shell, const postproc::ReportSummary& summary) {
    shell.print(summary.file + ": a report of the solver");
    if (summary.monitor) {
        print(shell, *summary.monitor, summary.scatter);
    }
    if (summary.plot) {
        print(shell, *summary.plot);
    }
    for (const auto& report : summary.forces) {
        print(shell, report);
    }
}

/// A report that is no field: true when the file is one.
bool show_report(Shell& shell, const std::string& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error) || postproc::importer_for(file) != nullptr) {
        return false;
    }
    const auto summary = postproc::summarise_report(file);
    if (!summary) {
        return false;
    }
    if (shell.json) {
        shell.print_json(*summary);
    } else {
        print(shell, *summary);
    }
    shell.show(summary->problems);
    return true;
}

void print(Shell& shell, const dynamics::LogSummary& summary) {
    shell.print(summary.file + ": " + summary.end.format + ", " + core::format_number(summary.duration, 6) +
                " s; times are s since its start, by its clock: " + summary.end.clock);
    Rows messages = {{"message", "type", "rows", "1/s", "from [s]", "to [s]", "gaps in time"}};
    Rows fields = {{"field", "unit", "min", "max"}};
    for (const auto& one : summary.series) {
        std::string gaps = one.silence_count == 0 ? "" : std::to_string(one.silence_count) + ", longest ";
        gaps += one.silence_count == 0 ? ""
                                       : short_number(one.silences[0].to - one.silences[0].from) + " s at " +
                                             short_number(one.silences[0].from);
        messages.push_back({core::as_utf8(one.name), core::as_utf8(one.type), std::to_string(one.count),
                            short_number(one.rate), short_number(one.first), short_number(one.last), gaps});
        for (const auto& field : one.fields) {
            fields.push_back({core::as_utf8(one.name + "." + field.name), field.unit.empty() ? "?" : field.unit,
                              short_number(field.min), short_number(field.max)});
        }
    }
    print_columns(shell, messages);
    print_columns(shell, fields);
    for (const auto& unread : summary.end.unread) {
        shell.print("not read: " + core::counted(unread.count, "message") + " " + core::as_utf8(unread.name) +
                    (unread.type.empty() ? "" : " (" + core::as_utf8(unread.type) + ")") + ": " +
                    core::as_utf8(unread.reason));
    }
}

/// A vehicle's log: true when the file is one.
bool show_log(Shell& shell, const std::string& file) {
    if (dynamics::log_format(std::filesystem::path(file)).empty()) {
        return false;
    }
    const dynamics::LogSummary summary = dynamics::summarise_log(file, shell.progress());
    if (shell.json) {
        shell.print_json(summary);
    } else {
        print(shell, summary);
    }
    shell.show(summary.end.problems);
    return true;
}

}  // namespace

void add_info_command(CLI::App& app, Shell& shell) {
    auto* command =
        app.add_subcommand("info",
                           "what a CFD file, a report of its solver or a vehicle's log holds: format, zones, "
                           "arrays with units and ranges, histories, forces, messages");
    struct Options {
        std::string file;
        FieldOptions field;
    };
    auto options = std::make_shared<Options>();
    command
        ->add_option("file", options->file,
                     "a CFD-Post CSV, Fluent, EnSight, CGNS, OpenFOAM or VTK file; or a monitor (.out, OpenFOAM's "
                     ".dat), transcript, .xy plot or force report; or a vehicle's log (PX4 ULog, ArduPilot DataFlash, "
                     "ROS 2 bag)")
        ->required();
    options->field.add_to(*command);
    command->footer(
        "Examples:\n"
        "  underbody info body.csv\n"
        "  underbody info case.cas.h5 --json\n"
        "  underbody info mesh.msh --length-unit mm\n"
        "  underbody info lift-rfile.out                histories and how settled they are\n"
        "  underbody info pressure.xy --json            the curves of a plot, point by point\n"
        "  underbody info log.ulg                       a vehicle's log: messages, fields, rates, gaps in time");
    shell.on(command, [&shell, options] {
        if (show_log(shell, options->file) || show_report(shell, options->file)) {
            return static_cast<int>(done);
        }
        postproc::ReadOptions read = options->field.read_options();
        read.zones = options->field.zones;
        const auto summary = postproc::summarise(shell.read_field(options->file, read));
        if (shell.json) {
            shell.print_json(summary);
        } else {
            print(shell, summary);
        }
        shell.show(summary.problems);
        return static_cast<int>(done);
    });
}

}  // namespace underbody::studio
