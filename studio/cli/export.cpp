// underbody export: force tables for controllers.
#include "surrogates/tables/exports/export.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cases/percent.h"
#include "cases/prove_export.h"
#include "core/error.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/motion_start.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/cli/table_options.h"
#include "surrogates/dynamics/exports/motion_fmu.h"
#include "surrogates/dynamics/model/model.h"

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
    std::string base_centre;
    bool overwrite = false;
    bool self_test = false;
    bool prove = false;
    std::string motion;
    std::string from;
};

tables::ExportOptions options_of(const ExportCommand& command) {
    tables::ExportOptions options;
    options.name = command.name;
    options.overwrite = command.overwrite;
    options.self_test = command.self_test;
    if (command.number != "double" && command.number != "float" && command.number != "fixed") {
        throw core::UsageError("number", "numbers are double, float or fixed, not '" + command.number + "'");
    }
    options.single_precision = command.number == "float";
    options.fixed_point = command.number == "fixed";
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
        const auto count =
            equals == std::string_view::npos ? std::nullopt : core::parse_integer(part.substr(equals + 1));
        if (!count || *count < 2) {
            throw core::UsageError("parse", "'" + std::string(core::trimmed(part)) + "' is not of the form axis=COUNT",
                                   {}, "such as --points gap=40,pitch=9");
        }
        const std::string axis(core::trimmed(part.substr(0, equals)));
        if (std::any_of(options.points.begin(), options.points.end(),
                        [&](const auto& other) { return other.first == axis; })) {
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
        if ((", " + endings + ",").find(", " + format.ending + ",") == std::string::npos) {  // two formats share one
            endings += (endings.empty() ? "" : ", ") + format.ending;
        }
    }
    throw core::UsageError("format", "'" + command.out + "' ends like no export", {},
                           "say --format, or end it in " + endings);
}

/// "x,y,z"
std::array<double, 3> read_place(const std::string& text) {
    const auto parts = core::split(text, ',');
    if (parts.size() != 3) {
        throw core::UsageError("parse", "--base-centre: '" + text + "' is not x,y,z", {},
                               "such as --base-centre \"0,0,50 mm\"");
    }
    std::array<double, 3> place{};
    for (std::size_t k = 0; k < 3; ++k) {
        place[k] = option_value("--base-centre", std::string(core::trimmed(parts[k])), "m");
    }
    return place;
}

/// Where the forces act: as the option says, or the model.
std::optional<std::array<double, 3>> lever_of(const ExportCommand& command) {
    if (!command.base_centre.empty()) {
        return read_place(command.base_centre);
    }
    if (!command.table.is_model()) {
        return std::nullopt;
    }
    const auto centre = dynamics::read_model(command.table.file).vehicle.base_centre();
    return std::isnan(centre[2]) ? std::nullopt : std::optional(centre);
}

dynamics::MotionFmuOptions motion_options(Shell& shell, const ExportCommand& command, const dynamics::Model& model) {
    const auto& motions = dynamics::fmu_motions();
    const auto motion = std::find(motions.begin(), motions.end(), command.motion);
    if (motion == motions.end()) {
        throw core::UsageError("name", "motions are heave, heave-pitch and body, not '" + command.motion + "'", {},
                               core::did_you_mean(command.motion, motions));
    }
    dynamics::MotionFmuOptions options;
    options.motion = static_cast<dynamics::FmuMotion>(motion - motions.begin());
    options.name = command.name;
    options.overwrite = command.overwrite;
    for (const auto& [name, value] : read_assignments(command.table.where)) {
        options.held.set(name, value);
    }
    const MotionStart start = command.from.empty() ? MotionStart{} : motion_start(command.from, options.held);
    shell.show(start.not_used_in(command.motion));
    const auto held = options.held.over(model.conditions);
    if (options.motion == dynamics::FmuMotion::heave) {
        options.start = {start.needed_gap(), start.heave_velocity.value_or(0)};
    } else if (options.motion == dynamics::FmuMotion::heave_pitch) {
        const auto of = start.of_pitch();
        options.start.assign(of.begin(), of.end());
    } else {
        const auto of = start.of_body(dynamics::RigidBody(model, held), held);
        options.start.assign(of.begin(), of.end());
    }
    return options;
}

nlohmann::json motion_json(const dynamics::MotionFmu& fmu, const std::string& motion) {
    nlohmann::json document{{"format", "fmu"}, {"motion", motion}, {"files", {fmu.file.string()}}};
    document["bytes"] = std::filesystem::file_size(fmu.file);
    for (const auto& [key, variables] :
         {std::pair{"inputs", &fmu.inputs}, std::pair{"states", &fmu.states}, std::pair{"outputs", &fmu.outputs}}) {
        document[key] = nlohmann::json::array();
        for (const auto& one : *variables) {
            document[key].push_back({{"name", one.name}, {"unit", one.unit}});
            if (variables != &fmu.outputs) {
                document[key].back()["start"] = one.start;
            }
        }
    }
    document["warnings"] = nlohmann::json::array();
    for (const auto& remark : fmu.remarks) {
        document["warnings"].push_back(remark.message);
    }
    return document;
}

/// The motion of a model, not only its forces.
int run_motion(Shell& shell, const ExportCommand& command) {
    if (!command.table.is_model()) {
        throw core::UsageError(
            "range", "--motion writes the motion of a model (model.toml), '" + command.table.file + "' is none");
    }
    if (format_of(command) != "fmu") {
        throw core::UsageError("format", "a motion is written as an FMU (--format fmu), not as " + format_of(command));
    }
    if (!command.max_error.empty() || !command.points.empty() || command.number != "double" || command.self_test ||
        command.prove || command.frame != "up") {
        throw core::UsageError("range",
                               "--max-error, --points, --number, --frame, --self-test and --prove are of tables: a "
                               "motion is written as it is simulated");
    }
    const auto model = dynamics::read_model(command.table.file);
    auto options = motion_options(shell, command, model);
    options.overwrite = options.overwrite || shell.force;
    const core::ReplacingAllowed by_the_export_itself;
    const auto fmu = dynamics::export_motion_fmu(model, command.out, options);
    shell.print(fmu.file.string());
    shell.show(fmu.remarks);
    const auto names = [](const std::vector<dynamics::MotionFmuVariable>& variables) {
        std::string list;
        for (const auto& one : variables) {
            list += (list.empty() ? "" : ", ") + one.name;
        }
        return list;
    };
    shell.info("inputs " + names(fmu.inputs) + "; states " + names(fmu.states));
    if (shell.json) {
        shell.print_json(motion_json(fmu, command.motion));
    }
    return done;
}

/// The first folder on the way to the file that is not there yet; empty when all are.
std::filesystem::path missing_folder(const std::filesystem::path& file) {
    std::filesystem::path missing;
    std::error_code error;
    for (auto folder = file.parent_path(); !folder.empty() && !std::filesystem::exists(folder, error);
         folder = folder.parent_path()) {
        missing = folder;
    }
    return missing;
}

/// How large the files are; a warning where that is more than most consumers take.
core::Problems size_remarks(Shell& shell, std::uintmax_t bytes, bool thinned) {
    core::Problems large;
    if (bytes > 20'000'000) {
        large.push_back({core::Problem::Severity::warning,
                         "the export has " + core::format_number(static_cast<double>(bytes) / 1e6, 3) +
                             " MB, more than most compilers and controllers take" +
                             (thinned ? "" : ": --max-error 0.5% or --points make it smaller"),
                         {}});
        shell.show(large);
    }
    shell.info(core::format_number(static_cast<double>(bytes) / 1000, 3) + " kB" +
               (bytes > 50000 && !thinned
                    ? ": every set point and every cell of the table; --max-error 0.5% or --points "
                      "make it smaller"
                    : ""));
    return large;
}

/// Says and returns the error of each table.
nlohmann::json errors_of(Shell& shell, const ExportCommand& command, const std::vector<tables::ForceTable>& all,
                         const tables::ExportResult& result, double max_error) {
    std::string grid;
    for (const auto points : result.grid) {
        grid += (grid.empty() ? "" : " x ") + std::to_string(points);
    }
    nlohmann::json errors = nlohmann::json::array();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& table = all[i];
        const double error = result.errors[i].second;
        const auto [low, high] = tables::range_of_points(table);
        shell.info(table.quantity() + " on a grid of " + grid +
                   (error > 0 ? ", within " + core::format_number(error, 3) + " " + table.unit() +
                                    (command.table.is_model() ? " of the forces of the model" : " of the full table")
                              : "") +
                   (max_error > 0
                        ? "; allowed are " + cases::percent(max_error) + " of the range of its points, " +
                              core::format_number(low, 3) + " to " + core::format_number(high, 3) + " " + table.unit()
                        : ""));
        errors.push_back({{"quantity", result.errors[i].first},
                          {"unit", table.unit()},
                          {"max_error", error},
                          {"range", {low, high}}});
    }
    return errors;
}

nlohmann::json json_of(const tables::ExportResult& result, const std::string& format, const std::string& quantity,
                       const nlohmann::json& errors, std::uintmax_t bytes) {
    nlohmann::json document{{"format", format},
                            {"grid", result.grid},
                            {"error", result.error},
                            {"quantity", quantity},
                            {"quantities", errors}};
    document["files"] = nlohmann::json::array();
    document["bytes"] = bytes;
    for (const auto& file : result.files) {
        document["files"].push_back(file.string());
    }
    return document;
}

/// Compiled and compared before it is written; throws where it differs.
void prove(Shell& shell, const std::string& format, const std::vector<tables::ForceTable>& all,
           const tables::ExportOptions& options, nlohmann::json& document) {
    if (format != "c") {
        throw core::UsageError("format", "a C header is proved, not " + format);
    }
    const auto proof = cases::prove_export(all, options, shell.progress());
    if (!proof.equal) {
        throw core::SystemError("proof", proof.sentence);
    }
    shell.info(proof.sentence);
    document["proof"] = {{"equal", proof.equal}, {"points", proof.points}, {"sentence", proof.sentence}};
}

int run_export(Shell& shell, const ExportCommand& command) {
    shell.list_on_stdout = true;
    if (!command.motion.empty()) {
        return run_motion(shell, command);
    }
    if (!command.from.empty()) {
        throw core::UsageError("range", "--from says where a motion starts: say --motion too");
    }
    const std::string format = format_of(command);
    auto options = options_of(command);
    if (const std::string missing = cases::percent_sign_missing("--max-error " + command.max_error, options.max_error,
                                                                0.1, "the range of the points");
        !missing.empty() && command.max_error.find('%') == std::string::npos) {
        shell.show_warning(missing);
    }
    options.overwrite = options.overwrite || shell.force;
    const core::ReplacingAllowed by_the_export_itself;  // it knows its own files by what is in them
    options.lever = lever_of(command);
    const bool several = command.table.quantity.find(',') != std::string::npos || command.table.quantity == "all";
    const auto all = several ? command.table.fit_all(shell) : std::vector<tables::ForceTable>{command.table.fit(shell)};
    nlohmann::json proved;
    if (command.prove) {
        prove(shell, format, all, options, proved);
    }
    const auto folder = missing_folder(command.out);
    const auto result = tables::export_tables(all, format, command.out, options, shell.progress());
    shell.show(result.remarks);
    std::uintmax_t bytes = 0;
    for (const auto& file : result.files) {
        shell.print(file.string());
        bytes += std::filesystem::file_size(file);
    }
    if (!folder.empty()) {
        shell.info("made the folder " + folder.string());
    }
    const core::Problems large = size_remarks(shell, bytes, options.max_error > 0 || !options.points.empty());
    const nlohmann::json errors = errors_of(shell, command, all, result, options.max_error);
    if (shell.json) {
        nlohmann::json document = json_of(result, format, all.front().quantity(), errors, bytes);
        if (command.prove) {
            document.update(proved);
        }
        if (!folder.empty()) {
            document["made_folder"] = folder.string();
        }
        command.table.describe(document);
        for (const auto& problem : large) {
            document["warnings"].push_back(problem.message);
        }
        shell.print_json(document);
    }
    return done;
}

}  // namespace

void add_export_command(CLI::App& app, Shell& shell) {
    auto command = std::make_shared<ExportCommand>();
    command->table.print_held = false;  // stdout lists the files
    CLI::App* sub = app.add_subcommand("export", "writes a force table for a controller");
    command->table.add_to(*sub);
    std::string formats;
    for (const auto& format : tables::export_formats()) {
        formats += (formats.empty() ? "" : " | ") + format.name;
    }
    sub->add_option("--format", command->format, formats + " (default: by the ending of --out)");
    sub->add_option("--out", command->out, "file to write")->required();
    sub->add_option("--name", command->name, "prefix of identifiers, model name (default: that of the file)");
    sub->add_option("--frame", command->frame, "up: lift positive up | ned: body axes, z down")->capture_default_str();
    sub->add_option(
        "--max-error", command->max_error,
        "thins the grid to the smallest that stays within this share of the range of the force over all points, such "
        "as 0.5% (of a film that sucks 10 N at 1 mm that is 50 mN everywhere)");
    sub->add_option("--points", command->points, "evenly spaced points an axis, such as gap=40,pitch=9");
    sub->add_option("--number", command->number,
                    "C: double | float | fixed (whole numbers of 32 bits, no floating point)")
        ->capture_default_str();
    sub->add_option("--base-centre", command->base_centre,
                    "JSBSim: from the centre of gravity to the centre of the base, x forward, y starboard, z down, "
                    "such as \"0,0,50 mm\" (default: the model's)");
    sub->add_flag(
        "--self-test", command->self_test,
        "C: beside the header NAME_test.c, a program that compares it with what this program says at 200 points, few "
        "enough for a controller");
    sub->add_flag(
        "--prove", command->prove,
        "C: compiles the header by cc and compares it at 10,000 points; nothing is written where they differ");
    sub->add_option("--motion", command->motion,
                    "FMU of a model: its motion in heave | heave-pitch | body, with states, contact and inputs");
    sub->add_option("--from", command->from,
                    "where that motion starts, as simulate has it, such as gap=20mm,pitch=1deg");
    sub->add_flag("--overwrite", command->overwrite, "replace a file that this program did not write");
    std::string text = "Formats:\n";
    for (const auto& format : tables::export_formats()) {
        text += "  " + format.name + std::string(format.name.size() < 10 ? 10 - format.name.size() : 1, ' ') +
                format.description + "\n";
    }
    sub->footer(
        text +
        "Examples:\n"
        "  underbody export lift.csv --format c --out lift.h --max-error 0.5%\n"
        "  underbody export found/model.toml --format c --out lift.h      the force of a model, with what "
        "discover added to it\n"
        "  underbody export model.toml --quantity lift_force,drag_force,pitch_moment --axes "
        "gap,pitch,speed=0:0.8,jet_voltage=0:12 --out body.h\n"
        "      all forces of a model over all its axes, in one header and one call\n"
        "  underbody export model.toml --motion body --from gap=20mm,speed=0.35m/s --format fmu --out body.fmu\n"
        "      the motion itself: what simulate integrates, for Simulink, OpenModelica and others\n"
        "  underbody export loads.csv --quantity pitch_moment --format json --out moment.json --frame ned");
    shell.on(sub, [&shell, command] { return run_export(shell, *command); });
}

}  // namespace underbody::studio
