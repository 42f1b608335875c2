// underbody study run | list | report | verify; the others have files of their own (study_parts.h).
#include "cases/study.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cases/doubts.h"
#include "cases/excused.h"
#include "cases/percent.h"
#include "core/counted.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/cli/study_parts.h"
#include "studio/cli/study_set.h"
#include "studio/figures/render.h"
#include "surrogates/tables/points/settled.h"

namespace underbody::studio {

cases::RunOptions run_options(const StudyArguments& arguments) {
    cases::RunOptions options;
    options.store = arguments.store;
    options.report = arguments.report;
    options.pictures = !arguments.no_pictures;
    options.renderer = [](const core::Figure& figure) { return render_png(figure); };
    return options;
}

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

void print_warnings(Shell& shell, const cases::StudyResults& results) {
    for (const auto& problem : results.gathered_warnings(shell.verbose)) {
        shell.show({{core::Problem::Severity::warning, problem.message, {problem.place.file, {}, {}, {}}}});
    }
}

void show_notes(Shell& shell, const cases::Study& study) {
    for (const auto& note : study.notes) {
        if (note.severity == core::Problem::Severity::note) {
            shell.print("note: " + note.message);
        } else {
            shell.show_warning(note.message);
        }
    }
}

nlohmann::json json_of_notes(const cases::Study& study, const std::vector<std::string>& notes) {
    nlohmann::json json = notes;
    for (const auto& note : study.notes) {
        json.push_back(note.message);
    }
    return json;
}

cases::StudyResults results_of_run(Shell& shell, const cases::Study& study, const cases::RunOptions& options) {
    return with_store_hint([&] { return cases::run_study(study, options, shell.progress()); });
}

void add_common(CLI::App* command, StudyArguments& arguments) {
    command->add_option("study", arguments.folder, "folder with study.toml")->required();
    command->add_option("--store", arguments.store, "SQLite file of results (default: STUDY/.underbody/store.sqlite)");
}

namespace {

std::string in_unit(double value, const std::string& from, const std::string& to, int digits = 4) {
    return std::isfinite(value) ? core::format_number(core::convert(value, from, to), digits) : "-";
}

/// What the warnings of the loads do not hold: checks that failed, maps of models that the runs find incomplete.
void warn_of_checks(Shell& shell, const cases::Study& study, const cases::StudyResults& results) {
    for (const auto& check : results.verifications) {
        if (check.failed > 0) {
            shell.show_warning("check '" + check.name +
                               "': " + core::counted_of(check.failed, check.values, "value", "lies", "lie") +
                               " beyond its tolerance, the worst " + core::format_number(100 * check.worst, 3) +
                               " % (" + check.worst_case + ")");
        }
    }
    for (const auto& region : study.regions) {
        for (const auto& doubt : cases::doubts_of_model(study, results, region)) {
            shell.show_warning("map '" + region.name + "': " + doubt);
        }
        for (const auto& warning : cases::warnings_of(region, results)) {
            shell.show_warning("map '" + region.name + "': " + warning);
        }
    }
    for (const auto& measurement : study.measurements) {
        for (const auto& warning : cases::warnings_of(measurement, results)) {
            shell.show_warning("measurement '" + measurement.name + "': " + warning);
        }
    }
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
        warn_of_checks(shell, study, results);
        nlohmann::json json;
        to_json(json, results);
        json["notes"] = json_of_notes(study, results.notes);
        json["not_settled"] = tables::not_settled(results.loads);
        shell.print_json(json);
        return results.failed == 0 ? done : wrong_input;
    }
    show_notes(shell, study);
    print_warnings(shell, results);
    warn_of_checks(shell, study, results);
    if (const auto names = tables::not_settled(results.loads); !names.empty()) {
        shell.print(core::counted_of(names.size(), results.loads.rows(), "solution", "has", "have") + " not settled" +
                    (names.size() == 1 ? ", '" : ", the first '") + names.front() + "'");
    }
    shell.print(core::counted(results.computed, "result") + " computed, " + std::to_string(results.reused) +
                " unchanged, " + std::to_string(results.failed) + " failed");
    return results.failed == 0 ? done : wrong_input;
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
    for (const auto& own : entry.conditions.own_units) {
        item["condition_units"][own.name] = own.si;
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
    const auto [study, results] =
        with_store_hint([&] { return cases::listed(arguments.folder, run_options(arguments)); });
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
    shell.print(study.title + ": " + core::counted(study.cases.size(), "case") + "\n" + aligned(rows));
    show_notes(shell, study);
    print_warnings(shell, results);
    if (changed > 0) {
        shell.print("changed: for " + core::counted(changed, "case") +
                    ", files, options or code are no longer those of the stored loads; underbody study run "
                    "computes them again");
    }
    return done;
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
        const auto* check = cases::find_result(results.verifications, spec.name);
        if (check == nullptr) {
            ++failed;
            continue;
        }
        json[spec.name] = nlohmann::json::parse(*results.document("verify/" + spec.name));
        failed += check->failed;
        shell.print(spec.name + ": " + core::counted(check->values, "value") + " compared, worst " +
                    cases::percent_of(check->worst, "the force's size") + " (" + check->worst_case + "), allowed " +
                    cases::percent(check->tolerance) + ", " + std::to_string(check->failed) + " beyond it" +
                    cases::excused(json[spec.name]));
    }
    if (shell.json) {
        shell.print_json(json);
    }
    return failed == 0 && results.failed == 0 ? done : check_failed;
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
        "  underbody study why cases/evie \"2.83 mm\"            the same of a number as the report prints it\n"
        "  underbody study compare cases/evie                   the study's own [[compare]]\n"
        "  underbody study compare before after                 two campaigns: what moved beyond its error\n"
        "  underbody study compare cases/evie --where-a mesh=coarse --where-b mesh=fine\n"
        "  underbody study add mystudy --files 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv' --condition speed=0.5m/s\n"
        "  underbody study add mystudy --files 'runs/{variant}-h{gap:mm}/case.foam' --symmetry y --zones hull,base\n"
        "  underbody study add mystudy --table lift_force --where variant=ellipse,pitch=0deg --net-weight 0.3N\n"
        "  underbody study add mystudy --data flight.ulg --model glide.toml --channel "
        "gap=distance_sensor/current_distance\n"
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

    add_study_compare(study, arguments, shell);

    auto* verify_command = study->add_subcommand("verify", "our loads against the solver's own report ([[verify]])");
    add_common(verify_command, *arguments);
    shell.on(verify_command, [arguments, &shell] { return verify(shell, *arguments); });

    add_study_why(study, arguments, shell);
    add_study_add(study, arguments, shell);
    add_study_set(*study, shell);
    add_study_accept(*study, shell);
}

}  // namespace underbody::studio
