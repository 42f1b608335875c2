// underbody info FILE: what a CFD file holds.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "postproc/summary.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

std::string padded(const std::string& text, std::size_t width) {
    return text.size() >= width ? text + " " : text + std::string(width - text.size(), ' ');
}

std::string number(double value) { return std::isfinite(value) ? core::format_number(value, 5) : "-"; }

void print(Shell& shell, const postproc::FieldSummary& summary) {
    shell.print(summary.file + ": " + summary.format + (summary.writer.empty() ? "" : ", written by " + summary.writer) +
                (summary.dimension == 2 ? ", two-dimensional" : ""));
    shell.print("\n" + padded("zone", 26) + padded("kind", 12) + padded("points", 10) + padded("faces", 10) + padded("cells", 10) + "extent [m]");
    for (const auto& zone : summary.zones) {
        std::string extent;
        for (std::size_t k = 0; k < 3; ++k) {
            extent += std::string(k == 0 ? "" : "  ") + "xyz"[k] + " " + number(zone.lower[k]) + " .. " + number(zone.upper[k]);
        }
        shell.print(padded(zone.name, 26) + padded(zone.kind, 12) + padded(std::to_string(zone.points), 10) + padded(std::to_string(zone.faces), 10) +
                    padded(std::to_string(zone.cells), 10) + extent);
    }
    shell.print("\n" + padded("array", 26) + padded("unit", 12) + padded("on", 10) + padded("min", 14) + padded("max", 14) + "in the file");
    for (const auto& array : summary.arrays) {
        shell.print(padded(array.name + (array.components > 1 ? " (" + std::to_string(array.components) + ")" : ""), 26) + padded(array.unit.empty() ? "?" : array.unit, 12) +
                    padded(array.on, 10) + padded(number(array.min), 14) + padded(number(array.max), 14) + array.original_name +
                    (array.original_unit.empty() ? "" : " [" + array.original_unit + "]") + (array.missing > 0 ? ", " + std::to_string(array.missing) + " missing" : ""));
    }
    shell.print("\npressure is " + (summary.pressure_reference == "unknown" ? std::string("gauge or absolute: the file does not say") : summary.pressure_reference) +
                (summary.operating_pressure != 0 ? ", operating pressure " + number(summary.operating_pressure) + " Pa" : ""));
    for (const auto& [key, value] : summary.metadata) {
        shell.print(key + ": " + value);
    }
}

}  // namespace

void add_info_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("info", "what a CFD file holds: format, zones, arrays with units and ranges");
    struct Options {
        std::string file;
        FieldOptions field;
    };
    auto options = std::make_shared<Options>();
    command->add_option("file", options->file, "a CFD-Post CSV, Fluent, EnSight, CGNS, OpenFOAM or VTK file")->required();
    options->field.add_to(*command);
    command->footer(
        "Examples:\n"
        "  underbody info body.csv\n"
        "  underbody info case.cas.h5 --json\n"
        "  underbody info mesh.msh --length-unit mm");
    shell.on(command, [&shell, options] {
        postproc::ReadOptions read = options->field.read_options();
        read.zones = options->field.zones;
        const auto summary = postproc::summarise(postproc::read_field(options->file, read, shell.progress()));
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
