// underbody study add: cases for a study, or the beginning of one.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cases/add_cases.h"
#include "cases/add_measurement.h"
#include "cases/add_table.h"
#include "core/counted.h"
#include "core/text.h"
#include "studio/cli/study_parts.h"

namespace underbody::studio {

namespace {

nlohmann::json show_left_out(const cases::AddedCases& added, Shell& shell) {
    constexpr std::size_t most = 8;
    const auto& missed = added.left_out;
    nlohmann::json list = nlohmann::json::array();
    std::string text = missed.empty() ? ""
                                      : std::to_string(missed.size()) +
                                            (missed.size() == 1 ? " file is" : " files are") + " left out:";
    for (std::size_t i = 0; i < missed.size(); ++i) {
        list.push_back({{"file", missed[i].first.string()}, {"why", missed[i].second}});
        text += i < most ? "\n  " + missed[i].first.string() + ": " + missed[i].second : "";
    }
    text += missed.size() > most ? "\n  and " + std::to_string(missed.size() - most) + " more" : "";
    if (!missed.empty()) {
        shell.print(text);
    }
    return list;
}

/// "NAME=VALUE" of an option in two.
std::pair<std::string, std::string> in_two(const std::string& text, const char* form, const char* hint) {
    const std::size_t equal = text.find('=');
    if (equal == std::string::npos) {
        throw core::UsageError("parse", "'" + text + "' is not of the form " + form, {}, hint);
    }
    return {std::string(core::trimmed(std::string_view(text).substr(0, equal))),
            std::string(core::trimmed(std::string_view(text).substr(equal + 1)))};
}

cases::NewCases new_cases(const StudyArguments& arguments) {
    cases::NewCases cases;
    cases.files = arguments.files;
    cases.zones = arguments.zones;
    cases.symmetry = arguments.symmetry;
    cases.length_unit = arguments.length_unit;
    cases.design_points = arguments.design_points;
    for (const auto& conditions : arguments.conditions) {
        std::string one;  // commas part conditions as in --where: what has no '=' goes on with the value before
        for (const auto part : core::split(conditions, ',')) {
            if (part.find('=') != std::string_view::npos && !one.empty()) {
                cases.conditions.push_back(in_two(one, "name=value", "--condition speed=0.5m/s"));
                one.clear();
            }
            one += (one.empty() ? "" : ",") + std::string(part);
        }
        cases.conditions.push_back(in_two(one, "name=value", "--condition speed=0.5m/s"));
    }
    for (const auto& unit : arguments.units) {
        cases.units.push_back(in_two(unit, "NAME=UNIT", "--unit Pressure=Pa"));
    }
    if (arguments.design_points.empty() && !arguments.parameters.empty()) {
        throw core::UsageError("usage", "--parameter belongs to --design-points", {},
                               "--design-points points.csv --parameter P1=gap");
    }
    for (const auto& parameter : arguments.parameters) {
        cases.parameters.push_back(
            in_two(parameter, "PARAMETER=quantity", "--parameter \"P1=gap [mm]\", or --parameter P2= for none"));
    }
    return cases;
}

/// Appends a [[measurement]] to study.toml, and writes its data set where there is none.
int add_measurement(Shell& shell, const StudyArguments& arguments) {
    cases::NewMeasurement measurement;
    measurement.data.assign(arguments.data.begin(), arguments.data.end());
    measurement.model = arguments.model;
    const std::filesystem::path first = std::filesystem::absolute(measurement.data.front() / "x").lexically_normal();
    measurement.name = arguments.name.empty() ? first.parent_path().stem().string() : arguments.name;
    for (const auto& channel : arguments.channels) {
        measurement.channels.push_back(cases::measured_channel(channel));
    }
    const auto colon = arguments.clock.rfind(':');
    measurement.clock = arguments.clock.substr(0, colon);
    measurement.clock_unit = colon == std::string::npos ? "" : arguments.clock.substr(colon + 1);
    const auto added = cases::with_new_measurement(arguments.folder, measurement);
    cases::write_added(added);
    shell.print("measurement '" + measurement.name + "' added to " + added.file.string() + ": " + added.said);
    if (shell.json) {
        shell.print_json(
            {{"added", 1},
             {"study", added.file.string()},
             {"measurement", measurement.name},
             {"dataset", added.dataset.empty() ? nlohmann::json() : nlohmann::json(added.dataset.string())},
             {"data", added.said}});
    }
    return done;
}

int add_table(Shell& shell, const StudyArguments& arguments) {
    const auto where = arguments.where.empty() ? cases::Conditions() : cases::conditions_from(arguments.where);
    const auto added =
        cases::with_new_table(arguments.folder, {arguments.table, arguments.name, arguments.axes, where,
                                                 arguments.net_weight, arguments.virtual_mass, arguments.exports});
    show_notes(shell, added.study);
    cases::write_added(added);
    const auto& table = added.planned;
    std::string axes;
    for (const auto& axis : table.axes) {
        axes += (axes.empty() ? "" : " and ") + axis;
    }
    shell.print("table '" + table.name + "' of " + core::counted(table.cases, "case") + " over " + axes + " added to " +
                added.file.string());
    if (shell.json) {
        shell.print_json({{"added", 1},
                          {"study", added.file.string()},
                          {"table", table.name},
                          {"axes", table.axes},
                          {"cases", table.cases},
                          {"notes", json_of_notes(added.study, {})}});
    }
    return done;
}

/// Appends a [[case]] to study.toml (or starts one), checked before anything is written.
int add(Shell& shell, const StudyArguments& arguments) {
    if (int(!arguments.files.empty()) + int(!arguments.data.empty()) + int(!arguments.table.empty()) != 1) {
        throw core::UsageError(
            "usage", "study add takes one of --files (cases), --data (a measurement) and --table (a table of forces)",
            {}, "--files 'fields/{variant}-h{gap:mm}.csv', --data runs --model model.toml, or --table lift_force");
    }
    if (arguments.table.empty() && !(arguments.axes.empty() && arguments.where.empty() && arguments.exports.empty() &&
                                     arguments.net_weight.empty() && arguments.virtual_mass.empty())) {
        throw core::UsageError("usage", "--axes, --where, --net-weight, --virtual-mass and --export are of --table");
    }
    if (!arguments.data.empty()) {
        return add_measurement(shell, arguments);
    }
    if (!(arguments.model.empty() && arguments.channels.empty() && arguments.clock.empty() &&
          (arguments.name.empty() || !arguments.table.empty()))) {
        throw core::UsageError("usage", "--model, --name, --channel and --clock are of a measurement (--data)");
    }
    if (!arguments.table.empty()) {
        return add_table(shell, arguments);
    }
    const auto added = cases::with_new_cases(arguments.folder, new_cases(arguments));
    show_notes(shell, added.study);
    cases::write_added(added);
    const nlohmann::json passed_over = show_left_out(added, shell);
    shell.print(core::counted(added.count, "case") + " added to " + added.file.string());
    if (shell.json) {
        shell.print_json({{"added", added.count},
                          {"study", added.file.string()},
                          {"left_out", passed_over},
                          {"notes", json_of_notes(added.study, {})}});
    }
    return done;
}

}  // namespace

void add_study_add(CLI::App* study, std::shared_ptr<StudyArguments> arguments, Shell& shell) {
    auto* command = study->add_subcommand("add", "add cases to a study, or start one");
    command->add_option("study", arguments->folder, "folder of the study")->required();
    command->add_option("--files", arguments->files, "pattern of the files, relative to the study");
    command->add_option("--data", arguments->data,
                        "a measurement in place of cases: a folder with dataset.toml, or logs and tables of runs");
    command->add_option("--model", arguments->model, "of --data: the model that it is judged by");
    command->add_option("--name", arguments->name,
                        "of the measurement (default: of the first file) or table (default: its quantity in words)");
    command->add_option("--channel", arguments->channels,
                        "of --data: where a quantity stands: gap=rng_cm:cm, of a log gap=RFND/Dist (repeatable)");
    command->add_option("--clock", arguments->clock,
                        "of --data: field that says when, with its unit: t_us:us (default: the log's own time)");
    command->add_option("--condition", arguments->conditions,
                        "name=value,name=value held for all of them (repeatable)");
    command->add_option("--symmetry", arguments->symmetry,
                        "half models: normal axis of their plane (y), written to [frame]");
    command
        ->add_option("--zones", arguments->zones,
                     "zones that are the body: names, * and ? allowed; several with commas in one word")
        ->delimiter(',');
    command->add_option("--length-unit", arguments->length_unit,
                        "unit of coordinates that the files do not say (mm, inch ...)");
    command->add_option("--unit", arguments->units,
                        "unit of a variable that the files do not say: \"Pressure=Pa\" (repeatable)");
    command->add_option("--design-points", arguments->design_points,
                        "Workbench's table of design points (CSV): the conditions of the files; {design_point} in "
                        "--files is the number behind dp");
    command->add_option("--parameter", arguments->parameters,
                        "of that table: P1=gap, \"P1=gap [mm]\", or P2= for no condition (repeatable)");
    command->add_option("--table", arguments->table,
                        "a table of forces of the cases: lift_force, drag_force, pitch_moment ...");
    command->add_option("--axes", arguments->axes, "of --table: gap,pitch (default: what varies among its cases)")
        ->delimiter(',');
    command->add_option("--where", arguments->where, "of --table: its cases, such as variant=ellipse,pitch=0deg");
    command->add_option("--net-weight", arguments->net_weight, "of --table: equilibria are found for it, 0.3N");
    command->add_option("--virtual-mass", arguments->virtual_mass, "of --table: for frequency and kick, 3.954kg");
    command->add_option("--export", arguments->exports, "of --table: formats written with the report: c,csv,json")
        ->delimiter(',');
    shell.on(command, [arguments, &shell] { return add(shell, *arguments); });
}

}  // namespace underbody::studio
