// underbody study run | list | compare | report | verify | add
#include "cases/study.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cases/why.h"
#include "core/file.h"
#include "core/name_pattern.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/toml.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

struct StudyArguments {
    std::string folder;
    std::string store;
    std::string report;
    bool no_pictures = false;
    std::string files;
    std::vector<std::string> conditions;
    std::string symmetry;
    std::string design_points;
    std::vector<std::string> parameters;
    std::string what;
    std::vector<std::string> zones;
};

cases::RunOptions run_options(const StudyArguments& arguments) {
    cases::RunOptions options;
    options.store = arguments.store;
    options.report = arguments.report;
    options.pictures = !arguments.no_pictures;
    options.renderer = [](const core::Figure& figure) { return render_png(figure); };
    return options;
}

void add_common(CLI::App* command, StudyArguments& arguments) {
    command->add_option("study", arguments.folder, "folder with study.toml")->required();
    command->add_option("--store", arguments.store, "SQLite file of results (default: STUDY/.underbody/store.sqlite)");
}

std::string in_unit(double value, const std::string& from, const std::string& to, int digits = 4) {
    return std::isfinite(value) ? core::format_number(core::convert(value, from, to), digits) : "-";
}

/// Text columns, padded so that they stand under each other.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()), 0);
        for (std::size_t i = 0; i < row.size(); ++i) {
            widths[i] = std::max(widths[i], row[i].size());
        }
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            line += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
        }
        line.resize(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    if (!text.empty()) {
        text.pop_back();
    }
    return text;
}

/// Warnings that change what the numbers mean stand beside them, on stdout.
void print_warnings(Shell& shell, const cases::StudyResults& results) {
    for (const auto& problem : results.gathered_warnings(shell.verbose)) {
        shell.print("warning: " + problem.place.file + ": " + problem.message);
    }
}

/// What was left out on opening the study stands where its numbers are read.
void show_notes(Shell& shell, const cases::Study& study) {
    for (const auto& note : study.notes) {
        shell.print((note.severity == core::Problem::Severity::note ? "note: " : "warning: ") + note.message);
    }
}

/// The same, and what there is to say about the run.
nlohmann::json json_of_notes(const cases::Study& study, const std::vector<std::string>& notes) {
    nlohmann::json json = notes;
    for (const auto& note : study.notes) {
        json.push_back(note.message);
    }
    return json;
}

/// What was done and what went wrong; the exit code.
int tell(Shell& shell, const cases::Study& study, const cases::StudyResults& results) {
    for (const auto& note : results.notes) {
        shell.info(note);
    }
    for (const auto& step : results.steps) {
        if (!step.error.empty()) {
            shell.warn(step.kind + " '" + step.name + "' failed: " + step.error);
        } else if (shell.verbose) {
            shell.detail(step.kind + " '" + step.name + "': " + to_string(step.state));
        }
    }
    if (shell.json) {
        nlohmann::json json;
        to_json(json, results);
        json["notes"] = json_of_notes(study, results.notes);
        json["not_settled"] = cases::not_settled(results.loads);
        shell.print_json(json);
    }
    show_notes(shell, study);
    print_warnings(shell, results);
    if (const auto names = cases::not_settled(results.loads); !names.empty()) {
        shell.print(std::to_string(names.size()) + " of " + std::to_string(results.loads.rows()) +
                    " solutions have not settled, the first '" + names.front() + "'");
    }
    shell.print(std::to_string(results.computed) + " results computed, " + std::to_string(results.reused) +
                " unchanged, " + std::to_string(results.failed) + " failed");
    return results.failed == 0 ? done : wrong_input;
}

/// The library knows no options; where a store cannot be used, one of them is the way out.
template <class Work>
auto with_store_hint(const Work& work) {
    try {
        return work();
    } catch (const core::SystemError& error) {
        if (error.kind() != "store") {
            throw;
        }
        throw core::SystemError(
            error.kind(), error.message(), error.place(),
            error.hint() + (error.hint().empty() ? "" : "; ") + "--store FILE puts the store elsewhere");
    }
}

cases::StudyResults results_of_run(Shell& shell, const cases::Study& study, const cases::RunOptions& options) {
    return with_store_hint([&] { return cases::run_study(study, options, shell.progress()); });
}

int run_and_report(Shell& shell, const StudyArguments& arguments) {
    Shell::will_write(arguments.report);
    const core::ReplacingAllowed report_and_exports;  // of the study's own folder, by whichever version
    const auto study = cases::Study::open(arguments.folder);
    const auto results = results_of_run(shell, study, run_options(arguments));
    const int code = tell(shell, study, results);
    shell.print("report: " + results.report.string());
    return code;
}

nlohmann::json json_of_case(const cases::Case& entry, const cases::CaseLoads& loads) {
    nlohmann::json item = {{"name", entry.name},
                           {"file", entry.file.string()},
                           {"conditions", nlohmann::json::object()},
                           {"state", to_string(loads.state)}};
    for (const auto& [name, value] : entry.conditions.numbers) {
        item["conditions"][name] = value;
    }
    for (const auto& [name, value] : entry.conditions.texts) {
        item["conditions"][name] = value;
    }
    for (const auto& value : loads.values) {
        if (value.name == "lift_force" || value.name == "drag_force" || value.name.ends_with("_sigma")) {
            item[value.name] = value.value;
        }
    }
    item["settled"] = {{"verdict", loads.settled}, {"why", loads.settled_why}};
    for (const auto& warning : loads.warnings) {
        item["warnings"].push_back(warning.message);
    }
    return item;
}

int list(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    const auto results = with_store_hint([&] { return cases::stored_loads(study, run_options(arguments)); });
    for (const auto& note : results.notes) {
        shell.info(note);
    }
    nlohmann::json json = nlohmann::json::array();
    std::vector<std::vector<std::string>> rows = {{"case", "conditions", "lift", "drag", "solution", "", "file"}};
    std::size_t changed = 0;
    for (const auto& loads : results.case_loads) {
        const cases::Case& entry = study.cases[loads.entry];
        changed += loads.state == cases::StepState::changed ? 1 : 0;
        if (shell.json) {
            json.push_back(json_of_case(entry, loads));
            continue;
        }
        const bool known = !loads.values.empty();
        const std::string remark = !known ? to_string(loads.state) : loads.warnings.empty() ? "" : "warning";
        rows.push_back({entry.name, entry.conditions.label(),
                        known ? in_unit(loads.value("lift_force"), "N", "N") + " N" : "-",
                        known ? in_unit(loads.value("drag_force"), "N", "N") + " N" : "-", known ? loads.settled : "-",
                        remark, entry.file.string()});
    }
    if (shell.json) {
        shell.print_json({{"title", study.title}, {"cases", json}, {"notes", json_of_notes(study, results.notes)}});
        return done;
    }
    shell.print(study.title + ": " + std::to_string(study.cases.size()) + " cases\n" + aligned(rows));
    show_notes(shell, study);
    print_warnings(shell, results);
    if (changed > 0) {
        shell.print("changed: for " + std::to_string(changed) +
                    " cases, files, options or code are no longer those of the stored loads; underbody study run "
                    "computes them again");
    }
    return done;
}

int compare(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    cases::RunOptions options = run_options(arguments);
    options.write_report = false;
    const auto results = results_of_run(shell, study, options);
    nlohmann::json json = nlohmann::json::object();
    std::vector<std::vector<std::string>> rows = {{"comparison", "table", "winner of", "value"}};
    std::string remarks;
    for (const auto& spec : study.comparisons) {
        const auto* document = results.document("compare/" + spec.name);
        if (document == nullptr) {
            continue;
        }
        json[spec.name] = nlohmann::json::parse(*document);
        for (const auto& row : json[spec.name].at("rows")) {
            rows.push_back({spec.name, row.at("table"), row.at("measure"), row.at("text")});
        }
        for (const auto& remark : json[spec.name].at("remarks")) {
            remarks += "\n" + spec.name + ": " + remark.get<std::string>();
        }
    }
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print(aligned(rows) + (remarks.empty() ? "" : "\n" + remarks));
    return results.failed == 0 ? done : wrong_input;
}

int verify(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    if (study.verifications.empty()) {
        throw core::InputError("missing", "the study has no [[verify]]",
                               {(study.folder() / "study.toml").string(), {}, {}, {}},
                               "name a table of the solver's own forces: [[verify]] table = \"forces.csv\"");
    }
    cases::RunOptions options = run_options(arguments);
    options.write_report = false;
    const auto results = results_of_run(shell, study, options);
    nlohmann::json json = nlohmann::json::object();
    std::size_t failed = 0;
    for (const auto& spec : study.verifications) {
        const std::string& name = spec.name;
        const auto* document = results.document("verify/" + name);
        if (document == nullptr) {
            ++failed;
            continue;
        }
        json[name] = nlohmann::json::parse(*document);
        const auto& check = json[name];
        failed += check.at("failed").get<std::size_t>();
        shell.print(name + ": " + std::to_string(check.at("rows").size()) + " values compared, worst " +
                    core::format_number(100 * check.at("worst").get<double>(), 3) + " % of the force's size (" +
                    check.at("worst_case").get<std::string>() + "), allowed " +
                    core::format_number(100 * check.at("tolerance").get<double>(), 3) + " %, " +
                    std::to_string(check.at("failed").get<std::size_t>()) + " beyond it");
    }
    if (shell.json) {
        shell.print_json(json);
    }
    return failed == 0 && results.failed == 0 ? done : check_failed;
}

/// Files that the pattern passes over though they look as if they were meant, each with the reason.
nlohmann::json left_out(const StudyArguments& arguments, Shell& shell) {
    constexpr std::size_t most = 8;
    const core::NamePattern pattern(arguments.files);
    const auto missed = pattern.near_misses(arguments.folder);
    nlohmann::json list = nlohmann::json::array();
    std::string text = missed.empty() ? ""
                                      : std::to_string(missed.size()) +
                                            (missed.size() == 1 ? " file is" : " files are") + " left out:";
    for (std::size_t i = 0; i < missed.size(); ++i) {
        const std::string why = pattern.why_not(missed[i], arguments.folder);
        list.push_back({{"file", missed[i].string()}, {"why", why}});
        text += i < most ? "\n  " + missed[i].string() + ": " + why : "";
    }
    text += missed.size() > most ? "\n  and " + std::to_string(missed.size() - most) + " more" : "";
    if (!missed.empty()) {
        shell.print(text);
    }
    return list;
}

std::string lines_of(const char* title, const std::vector<std::pair<std::string, std::string>>& pairs) {
    std::string text;
    for (const auto& [key, value] : pairs) {
        text += (text.empty() ? std::string("  ") + title + "\n" : "") + "    " + key +
                (value.empty() ? "" : ": " + value) + "\n";
    }
    return text;
}

int why(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    const auto all = with_store_hint([&] { return cases::origins(study, run_options(arguments), arguments.what); });
    if (shell.json) {
        shell.print_json({{"study", study.title}, {"origins", all}});
        return done;
    }
    for (const auto& origin : all) {
        std::string text = origin.kind + " '" + origin.name + "'" +
                           (origin.made.empty() ? ": " + to_string(origin.state) : ", made " + origin.made + " UTC") +
                           "\n";
        text += lines_of("says", origin.facts) + lines_of("made with", origin.options);
        std::vector<std::pair<std::string, std::string>> read;
        for (const auto& file : origin.files) {
            const bool missing = file.state == "absent";
            if (!missing || shell.verbose) {
                read.emplace_back(file.path + (file.pattern.empty() ? "" : " (names like " + file.pattern + ")"),
                                  file.state);
            }
        }
        std::vector<std::pair<std::string, std::string>> from;
        for (const auto& [kind, name] : origin.from) {
            from.emplace_back(kind + " '" + name + "'", "");
        }
        text += lines_of("read, with the hash of the content", read) + lines_of("made of", from) +
                lines_of("by code", origin.code);
        shell.print(text);
    }
    return done;
}

/// The text with `symmetry` under [frame]. Throws core::UsageError when it says another plane already.
std::string with_symmetry(std::string text, const std::string& symmetry, const cases::Study* before) {
    if (symmetry.empty() || (before != nullptr && before->symmetry == symmetry)) {
        return text;
    }
    if (before != nullptr && !before->symmetry.empty()) {
        throw core::UsageError("range",
                               "the study's half models have their plane across " + before->symmetry + " already", {},
                               "all cases of a study have one; a study of its own for the others");
    }
    if (before != nullptr && !before->cases.empty()) {
        throw core::UsageError("range",
                               "the cases that the study has already are whole bodies: with a symmetry plane they "
                               "would be taken for halves",
                               {},
                               "a study of its own for the half models, or symmetry = " + core::toml_string(symmetry) +
                                   " under [frame] by hand");
    }
    const std::string line = "symmetry = " + core::toml_string(symmetry) + "\n";
    const std::size_t frame = ("\n" + text).find("\n[frame]");
    if (frame == std::string::npos) {
        return text + "\n[frame]\n" + line;
    }
    const std::size_t end = text.find('\n', frame);
    return end == std::string::npos ? text + "\n" + line : text.insert(end + 1, line);
}

/// The lines of a [[case]] whose conditions stand in a table of design points.
std::string design_points_of(const StudyArguments& arguments) {
    if (arguments.design_points.empty() && arguments.parameters.empty()) {
        return {};
    }
    if (arguments.design_points.empty()) {
        throw core::UsageError("usage", "--parameter belongs to --design-points", {},
                               "--design-points points.csv --parameter P1=gap");
    }
    const std::filesystem::path table =
        std::filesystem::absolute(arguments.design_points)
            .lexically_relative(std::filesystem::absolute(arguments.folder).lexically_normal());
    std::string text = "design_points = " + core::toml_string(table.string()) + "\n";
    for (const auto& parameter : arguments.parameters) {
        const std::size_t equal = parameter.find('=');
        if (equal == std::string::npos) {
            throw core::UsageError("parse", "'" + parameter + "' is not of the form PARAMETER=quantity", {},
                                   "--parameter \"P1=gap [mm]\", or --parameter P2= for none");
        }
        text += "parameters." + core::toml_string(core::trimmed(std::string_view(parameter).substr(0, equal))) + " = " +
                core::toml_string(core::trimmed(std::string_view(parameter).substr(equal + 1))) + "\n";
    }
    return text;
}

std::string case_text(const StudyArguments& arguments) {
    std::string text = "\n[[case]]\nfiles = " + core::toml_string(arguments.files) + "\n";
    std::string zones;
    for (const auto& zone : arguments.zones) {
        zones += (zones.empty() ? "" : ", ") + core::toml_string(zone);
    }
    text += zones.empty() ? "" : "zones = [" + zones + "]\n";
    for (const auto& condition : arguments.conditions) {
        const std::size_t equal = condition.find('=');
        if (equal == std::string::npos) {
            throw core::UsageError("parse", "'" + condition + "' is not of the form name=value", {},
                                   "--condition speed=0.5m/s");
        }
        text +=
            "conditions." + condition.substr(0, equal) + " = " + core::toml_string(condition.substr(equal + 1)) + "\n";
    }
    return text + design_points_of(arguments);
}

/// What is wrong stands in the lines to be added, which nobody has seen yet: says it without their place.
void say_of_new_lines(const core::InputError& error, const StudyArguments& arguments, const std::filesystem::path& file,
                      std::ptrdiff_t old_lines) {
    if (error.place().file != file.string() || error.place().line.value_or(0) <= old_lines) {
        return;
    }
    std::string hint = error.hint();
    if (error.kind() == "missing") {
        const core::NamePattern pattern(arguments.files);
        if (const auto missed = pattern.near_misses(arguments.folder); !missed.empty()) {
            hint = std::to_string(missed.size()) + " come near, such as " + missed.front().string() + ": " +
                   pattern.why_not(missed.front(), arguments.folder);
        }
    }
    const std::string message = error.message() + "; nothing was added to " + file.string();
    if (error.kind() == "missing" || error.kind() == "duplicate") {
        throw core::InputError(error.kind(), message, {}, hint);
    }
    throw core::UsageError(error.kind(), message, {}, hint);
}

/// Appends a [[case]] to study.toml (or starts one), checked before anything is written.
int add(Shell& shell, const StudyArguments& arguments) {
    const std::filesystem::path folder = arguments.folder;
    const std::filesystem::path file = folder / "study.toml";
    std::optional<cases::Study> before;
    std::string text =
        "title = " +
        core::toml_string(
            std::filesystem::absolute(folder / ".").lexically_normal().parent_path().filename().string()) +
        "\n";
    if (std::filesystem::exists(file)) {
        text = core::read_file(file);
        before = cases::Study::from_text(text, file);
    }
    const auto old_lines = std::count(text.begin(), text.end(), '\n');
    text = with_symmetry(std::move(text), arguments.symmetry, before ? &*before : nullptr) + case_text(arguments);
    std::size_t count = 0;
    nlohmann::json notes = nlohmann::json::array();
    try {
        const auto after = cases::Study::from_text(text, file);
        count = after.cases.size() - (before ? before->cases.size() : 0);
        show_notes(shell, after);
        notes = json_of_notes(after, {});
    } catch (const core::InputError& error) {
        say_of_new_lines(error, arguments, file, old_lines);
        throw;
    }
    const core::ReplacingAllowed of_the_user;  // who asked for it
    core::write_file(file, text);
    const nlohmann::json passed_over = left_out(arguments, shell);
    shell.print(std::to_string(count) + " cases added to " + file.string());
    if (shell.json) {
        shell.print_json({{"added", count}, {"study", file.string()}, {"left_out", passed_over}, {"notes", notes}});
    }
    return done;
}

}  // namespace

void add_study_command(CLI::App& app, Shell& shell) {
    auto arguments = std::make_shared<StudyArguments>();
    auto* study =
        app.add_subcommand("study", "a folder of cases: import, loads, tables, stability, comparison, report");
    study->require_subcommand(1);
    study->footer(
        "Examples:\n"
        "  underbody study run cases/evie                       what changed is computed, the report written\n"
        "  underbody study run cases/evie --report out/r.html   the report elsewhere\n"
        "  underbody study list cases/evie                      the cases with their conditions and loads\n"
        "  underbody study verify cases/evie                    our loads against the solver's own (exit 4 when "
        "beyond)\n"
        "  underbody study why cases/evie region/glide          from a number back to the files, settings and code "
        "that made it\n"
        "  underbody study add mystudy --files 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv' --condition speed=0.5m/s\n"
        "  underbody study add mystudy --files 'runs/{variant}-h{gap:mm}/case.foam' --symmetry y --zones hull,base\n"
        "  underbody study add mystudy --files 'hull_files/dp{design_point}/FFF/Fluent/*.dat.h5' --design-points "
        "points.csv --parameter P3=gap");

    auto* run_command = study->add_subcommand("run", "compute what changed, write the report");
    add_common(run_command, *arguments);
    run_command->add_option("--report", arguments->report, "HTML file (default: STUDY/report/index.html)");
    run_command->add_flag("--no-pictures", arguments->no_pictures, "leave the 3D pictures out (they need Xvfb)");
    shell.on(run_command, [arguments, &shell] { return run_and_report(shell, *arguments); });

    auto* report_command = study->add_subcommand("report", "the same as run: the report is part of it");
    add_common(report_command, *arguments);
    report_command->add_option("--report,--out", arguments->report, "HTML file (default: STUDY/report/index.html)");
    report_command->add_flag("--no-pictures", arguments->no_pictures, "leave the 3D pictures out (they need Xvfb)");
    shell.on(report_command, [arguments, &shell] { return run_and_report(shell, *arguments); });

    auto* list_command = study->add_subcommand("list", "the cases, their conditions and what is known of them");
    add_common(list_command, *arguments);
    shell.on(list_command, [arguments, &shell] { return list(shell, *arguments); });

    auto* compare_command = study->add_subcommand("compare", "the study's [[compare]]: variants side by side");
    add_common(compare_command, *arguments);
    shell.on(compare_command, [arguments, &shell] { return compare(shell, *arguments); });

    auto* verify_command = study->add_subcommand("verify", "our loads against the solver's own report ([[verify]])");
    add_common(verify_command, *arguments);
    shell.on(verify_command, [arguments, &shell] { return verify(shell, *arguments); });

    auto* why_command = study->add_subcommand(
        "why", "where a number comes from: loads, faces, files with their hashes, settings and code");
    add_common(why_command, *arguments);
    why_command
        ->add_option(
            "result", arguments->what,
            "of the report, a table or an exported file: table/lift, \"lift_force of cube-h2\", exports/lift.h")
        ->required();
    shell.on(why_command, [arguments, &shell] { return why(shell, *arguments); });

    auto* add_command = study->add_subcommand("add", "add cases to a study, or start one");
    add_command->add_option("study", arguments->folder, "folder of the study")->required();
    add_command->add_option("--files", arguments->files, "pattern of the files, relative to the study")->required();
    add_command->add_option("--condition", arguments->conditions, "name=value held for all of them (repeatable)");
    add_command->add_option("--symmetry", arguments->symmetry,
                            "half models: normal axis of their plane (y), written to [frame]");
    add_command
        ->add_option("--zones", arguments->zones,
                     "zones that are the body: names, * and ? allowed; several with commas")
        ->delimiter(',');
    add_command->add_option("--design-points", arguments->design_points,
                            "Workbench's table of design points (CSV): the conditions of the files; {design_point} in "
                            "--files is the number behind dp");
    add_command->add_option("--parameter", arguments->parameters,
                            "of that table: P1=gap, \"P1=gap [mm]\", or P2= for no condition (repeatable)");
    shell.on(add_command, [arguments, &shell] { return add(shell, *arguments); });
}

}  // namespace underbody::studio
