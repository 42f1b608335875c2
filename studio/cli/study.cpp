// underbody study run | list | compare | report | verify | add
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cases/study.h"
#include "core/file.h"
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
    bool strict = false;
    std::string files;
    std::vector<std::string> conditions;
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

/// What was done and what went wrong; the exit code.
int tell(Shell& shell, const cases::StudyResults& results) {
    for (const auto& step : results.steps) {
        if (!step.error.empty()) {
            shell.warn(step.kind + " '" + step.name + "' failed: " + step.error);
        } else {
            shell.detail(step.kind + " '" + step.name + (step.reused ? "': unchanged" : "': computed"));
        }
    }
    if (shell.json) {
        nlohmann::json json;
        to_json(json, results);
        shell.print_json(json);
    }
    shell.print(std::to_string(results.computed) + " results computed, " + std::to_string(results.reused) + " unchanged, " +
                std::to_string(results.failed) + " failed");
    return results.failed == 0 ? done : wrong_input;
}

int run_study(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    const auto results = cases::run_study(study, run_options(arguments), shell.progress());
    const int code = tell(shell, results);
    shell.print("report: " + results.report.string());
    return code;
}

int list(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    const auto results = cases::stored_results(study, run_options(arguments));
    nlohmann::json json = nlohmann::json::array();
    std::vector<std::vector<std::string>> rows = {{"case", "conditions", "lift", "drag", "file"}};
    for (const auto& entry : study.cases) {
        std::string lift = "-";
        std::string drag = "-";
        nlohmann::json item = {{"name", entry.name}, {"file", entry.file.string()}, {"conditions", nlohmann::json::object()}};
        for (const auto& [name, value] : entry.conditions.numbers) {
            item["conditions"][name] = value;
        }
        for (const auto& [name, value] : entry.conditions.texts) {
            item["conditions"][name] = value;
        }
        if (const auto* document = results.document("loads/" + entry.name)) {
            const auto loads = nlohmann::json::parse(*document);
            item["lift_force"] = loads.at("lift_force");
            item["drag_force"] = loads.at("drag_force");
            lift = in_unit(loads.at("lift_force").get<double>(), "N", "N") + " N";
            drag = in_unit(loads.at("drag_force").get<double>(), "N", "N") + " N";
        }
        json.push_back(std::move(item));
        rows.push_back({entry.name, entry.conditions.label(), lift, drag, entry.file.string()});
    }
    if (shell.json) {
        shell.print_json({{"title", study.title}, {"cases", json}});
    }
    shell.print(study.title + ": " + std::to_string(study.cases.size()) + " cases\n" + aligned(rows));
    return done;
}

int compare(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    cases::RunOptions options = run_options(arguments);
    options.write_report = false;
    const auto results = cases::run_study(study, options, shell.progress());
    nlohmann::json json = nlohmann::json::object();
    std::vector<std::vector<std::string>> rows = {{"comparison", "table", "winner of", "value"}};
    for (const auto& spec : study.comparisons) {
        const auto* document = results.document("compare/" + spec.name);
        if (document == nullptr) {
            continue;
        }
        json[spec.name] = nlohmann::json::parse(*document);
        for (const auto& row : json[spec.name].at("rows")) {
            rows.push_back({spec.name, row.at("table"), row.at("measure"), row.at("text")});
        }
    }
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print(aligned(rows));
    return results.failed == 0 ? done : wrong_input;
}

int verify(Shell& shell, const StudyArguments& arguments) {
    const auto study = cases::Study::open(arguments.folder);
    if (study.verifications.empty()) {
        throw core::InputError("missing", "the study has no [[verify]]", {(study.folder() / "study.toml").string(), {}, {}, {}},
                               "name a table of the solver's own forces: [[verify]] table = \"forces.csv\"");
    }
    cases::RunOptions options = run_options(arguments);
    options.write_report = false;
    const auto results = cases::run_study(study, options, shell.progress());
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

/// Appends a [[case]] to study.toml (or starts one), checked before anything is written.
int add(Shell& shell, const StudyArguments& arguments) {
    const std::filesystem::path file = std::filesystem::path(arguments.folder) / "study.toml";
    std::string text;
    if (std::filesystem::exists(file)) {
        text = core::read_file(file);
    } else {
        text = "title = " + core::toml_string(std::filesystem::path(arguments.folder).lexically_normal().filename().string()) + "\n";
    }
    text += "\n[[case]]\nfiles = " + core::toml_string(arguments.files) + "\n";
    for (const auto& condition : arguments.conditions) {
        const std::size_t equal = condition.find('=');
        if (equal == std::string::npos) {
            throw core::UsageError("parse", "'" + condition + "' is not of the form name=value", {}, "--condition speed=0.5m/s");
        }
        const std::string value = condition.substr(equal + 1);
        text += "conditions." + condition.substr(0, equal) + " = " + core::toml_string(value) + "\n";
    }
    // Checked in the folder itself, under a name that a crash may leave without harm.
    core::PendingFile pending(file);
    core::write_file(pending.path(), text);
    std::size_t count = 0;
    {
        const auto before = std::filesystem::exists(file) ? cases::Study::open(arguments.folder).cases.size() : 0;
        const auto study = cases::Study::open(pending.path());
        count = study.cases.size() - before;
    }
    pending.commit();
    shell.print(std::to_string(count) + " cases added to " + file.string());
    if (shell.json) {
        shell.print_json({{"added", count}, {"study", file.string()}});
    }
    return done;
}

}  // namespace

void add_study_command(CLI::App& app, Shell& shell) {
    auto arguments = std::make_shared<StudyArguments>();
    auto* study = app.add_subcommand("study", "a folder of cases: import, loads, tables, stability, comparison, report");
    study->require_subcommand(1);
    study->footer(
        "Examples:\n"
        "  underbody study run cases/evie                       what changed is computed, the report written\n"
        "  underbody study run cases/evie --report out/r.html   the report elsewhere\n"
        "  underbody study list cases/evie                      the cases with their conditions and loads\n"
        "  underbody study verify cases/evie                    our loads against the solver's own (exit 4 when beyond)\n"
        "  underbody study add mystudy --files 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv' --condition speed=0.5m/s");

    auto* run_command = study->add_subcommand("run", "compute what changed, write the report");
    add_common(run_command, *arguments);
    run_command->add_option("--report", arguments->report, "HTML file (default: STUDY/report/index.html)");
    run_command->add_flag("--no-pictures", arguments->no_pictures, "leave the 3D pictures out (they need Xvfb)");
    shell.on(run_command, [arguments, &shell] { return run_study(shell, *arguments); });

    auto* report_command = study->add_subcommand("report", "the same as run: the report is part of it");
    add_common(report_command, *arguments);
    report_command->add_option("--report,--out", arguments->report, "HTML file (default: STUDY/report/index.html)");
    report_command->add_flag("--no-pictures", arguments->no_pictures, "leave the 3D pictures out (they need Xvfb)");
    shell.on(report_command, [arguments, &shell] { return run_study(shell, *arguments); });

    auto* list_command = study->add_subcommand("list", "the cases, their conditions and what is known of them");
    add_common(list_command, *arguments);
    shell.on(list_command, [arguments, &shell] { return list(shell, *arguments); });

    auto* compare_command = study->add_subcommand("compare", "the study's [[compare]]: variants side by side");
    add_common(compare_command, *arguments);
    shell.on(compare_command, [arguments, &shell] { return compare(shell, *arguments); });

    auto* verify_command = study->add_subcommand("verify", "our loads against the solver's own report ([[verify]])");
    add_common(verify_command, *arguments);
    shell.on(verify_command, [arguments, &shell] { return verify(shell, *arguments); });

    auto* add_command = study->add_subcommand("add", "add cases to a study, or start one");
    add_command->add_option("study", arguments->folder, "folder of the study")->required();
    add_command->add_option("--files", arguments->files, "pattern of the files, relative to the study")->required();
    add_command->add_option("--condition", arguments->conditions, "name=value held for all of them (repeatable)");
    shell.on(add_command, [arguments, &shell] { return add(shell, *arguments); });
}

}  // namespace underbody::studio
