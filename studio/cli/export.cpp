// underbody export: force tables for controllers.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/cli/table_options.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

namespace {

struct ExportCommand {
    TableOptions table;
    std::string format;
    std::string out;
    std::string name;
    std::string frame = "up";
    std::string max_error;
    std::string points;
    std::string number = "double";
    bool overwrite = false;
};

tables::ExportOptions options_of(const ExportCommand& command) {
    tables::ExportOptions options;
    options.name = command.name;
    options.overwrite = command.overwrite;
    if (command.number != "double" && command.number != "float") {
        throw core::UsageError("number", "numbers are double or float, not '" + command.number + "'");
    }
    options.single_precision = command.number == "float";
    if (command.frame != "up" && command.frame != "ned") {
        throw core::UsageError("frame", "the frame is up or ned, not '" + command.frame + "'");
    }
    options.frame = command.frame == "ned" ? tables::Frame::ned : tables::Frame::up;
    if (!command.max_error.empty()) {
        options.max_error = option_value("--max-error", command.max_error, "1");
    }
    for (const auto part : core::split(command.points, ',')) {
        if (core::trimmed(part).empty()) {
            continue;
        }
        const std::size_t equals = part.find('=');
        const auto count = equals == std::string_view::npos ? std::nullopt : core::parse_integer(part.substr(equals + 1));
        if (!count || *count < 2) {
            throw core::UsageError("parse", "'" + std::string(core::trimmed(part)) + "' is not of the form axis=COUNT", {}, "such as --points gap=40,pitch=9");
        }
        const std::string axis(core::trimmed(part.substr(0, equals)));
        if (std::any_of(options.points.begin(), options.points.end(), [&](const auto& other) { return other.first == axis; })) {
            throw core::UsageError("parse", "--points: '" + axis + "' is given twice");
        }
        options.points.emplace_back(axis, static_cast<std::size_t>(*count));
    }
    return options;
}

/// The format asked for, or the one whose files end like this one.
std::string format_of(const ExportCommand& command) {
    if (!command.format.empty()) {
        return command.format;
    }
    std::string endings;
    for (const auto& format : tables::export_formats()) {
        if (std::filesystem::path(command.out).extension() == format.ending) {
            return format.name;
        }
        endings += (endings.empty() ? "" : ", ") + format.ending;
    }
    throw core::UsageError("format", "'" + command.out + "' ends like no export", {}, "say --format, or end it in " + endings);
}

int run_export(Shell& shell, const ExportCommand& command) {
    const std::string format = format_of(command);
    auto options = options_of(command);
    options.overwrite = options.overwrite || shell.force;
    const core::ReplacingAllowed by_the_export_itself;  // it knows its own files by what is in them
    const auto table = command.table.fit(shell);
    const auto result = tables::export_table(table, format, command.out, options, shell.progress());
    shell.show(result.remarks);
    std::string grid;
    for (const auto points : result.grid) {
        grid += (grid.empty() ? "" : " x ") + std::to_string(points);
    }
    for (const auto& file : result.files) {
        shell.print(file.string());
    }
    shell.info(table.quantity() + " on a grid of " + grid +
               (result.error > 0 ? ", within " + core::format_number(result.error, 3) + " " + table.unit() + " of the full table" : ""));
    if (shell.json) {
        nlohmann::json document{{"format", format}, {"grid", result.grid}, {"error", result.error}, {"quantity", table.quantity()}};
        document["files"] = nlohmann::json::array();
        for (const auto& file : result.files) {
            document["files"].push_back(file.string());
        }
        shell.print_json(document);
    }
    return done;
}

}  // namespace

void add_export_command(CLI::App& app, Shell& shell) {
    auto command = std::make_shared<ExportCommand>();
    CLI::App* sub = app.add_subcommand("export", "writes a force table for a controller");
    command->table.add_to(*sub);
    std::string formats;
    for (const auto& format : tables::export_formats()) {
        formats += (formats.empty() ? "" : " | ") + format.name;
    }
    sub->add_option("--format", command->format, formats + " (default: by the ending of --out)");
    sub->add_option("--out", command->out, "file to write")->required();
    sub->add_option("--name", command->name, "prefix of identifiers (default: the quantity)");
    sub->add_option("--frame", command->frame, "up: lift positive up | ned: body axes, z down")->capture_default_str();
    sub->add_option("--max-error", command->max_error, "thins the grid to the smallest that stays within this share of the force's range, such as 0.5%");
    sub->add_option("--points", command->points, "evenly spaced points an axis, such as gap=40,pitch=9");
    sub->add_option("--number", command->number, "double | float (C)")->capture_default_str();
    sub->add_flag("--overwrite", command->overwrite, "replace a file that this program did not write");
    std::string text = "Formats:\n";
    for (const auto& format : tables::export_formats()) {
        text += "  " + format.name + std::string(format.name.size() < 10 ? 10 - format.name.size() : 1, ' ') + format.description + "\n";
    }
    sub->footer(text +
                "Examples:\n"
                "  underbody export lift.csv --format c --out lift.h --max-error 0.5%\n"
                "  underbody export found/model.toml --format c --out lift.h      the force of a model, with what discover added to it\n"
                "  underbody export loads.csv --quantity pitch_moment --format json --out moment.json --frame ned");
    shell.on(sub, [&shell, command] { return run_export(shell, *command); });
}

}  // namespace underbody::studio
