// underbody discover: what does the model lack?
#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cases/measured/studies.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/made_again.h"
#include "surrogates/discovery/static/load_cell.h"
#include "surrogates/discovery/wording.h"
#include "surrogates/estimator/observe/exported_again.h"

namespace underbody::studio {

namespace {

struct DiscoverArguments {
    std::string model;
    std::string data;
    std::string out;
    std::string horizon = "2 s";
    std::uint64_t seed = 1;
    std::size_t placebo = discovery::usual_placebo_twins;
    std::string measured;
    std::string log;
    std::string settle = "0 s";
    bool without_thrust = false;
    std::vector<std::string> candidates;
    std::vector<std::string> exports;
};

/// The smallest effects that would have been seen, one a line.
std::string limits_text(const discovery::Discovery& found) {
    const discovery::LimitsText limits = discovery::limits_text(found.limits);
    std::string text = limits.lines.empty() ? "" : "\n" + limits.heading + "\n";
    for (const std::string& line : limits.lines) {
        text += "  " + line + "\n";
    }
    return text;
}

void print(Shell& shell, const discovery::Discovery& found, const std::filesystem::path& folder) {
    const bool missing = found.verdict != "none", changed = missing || !found.mended.empty();
    std::string text = found.sentence + "\n";
    for (const discovery::FoundEffect& effect : found.effects) {
        text += "\n" + effect.name + ", probability " + discovery::probability_text(effect.probability) + "\n";
        for (const discovery::FoundParameter& parameter : effect.parameters) {
            text += "  " + discovery::number_name(effect, parameter) + " = " + discovery::value_text(parameter) + "\n";
        }
    }
    if (missing && !found.alternatives.empty()) {
        text += "\nWhat else it could be:\n";
        for (const discovery::FoundEffect& rival : found.alternatives) {
            text += "  " + rival.name + ", probability " + discovery::probability_text(rival.probability) +
                    (rival.told_apart_by.empty() ? "" : ": " + rival.told_apart_by) + "\n";
        }
    }
    text += missing ? "" : limits_text(found);
    for (const discovery::ErrorChange& change : found.error) {
        text += "\nError of " + change.channel + discovery::horizon_text(change.horizon) +
                discovery::error_is_on(found) + ": " +
                (changed ? core::told(change.before.rmse, change.unit, 3) + " -> " +
                               core::told(change.after.rmse, change.unit, 3)
                         : core::told(change.before.rmse, change.unit, 3)) +
                " (noise " + core::told(change.noise, change.unit, 3) + ")";
    }
    for (const discovery::AxisResidual& axis : found.axes) {
        text += "\n" + discovery::axis_text(axis);
    }
    text += "\n\nNext experiment: " + found.next_experiment + "\n";
    text += changed ? "New model: " + (folder / "model.toml").string() +
                          (found.motion == "surface" ? " (predict and linear take it)\n"
                           : found.motion == "body"  ? " (predict and simulate take it)\n"
                                                     : " (simulate, predict, region and export take it)\n")
                    : "";
    text += "Report: " + (folder / "report.html").string() + "\n";
    shell.print(text);
}

/// The studies that ship, one report each and an overview.
int study_measurements(Shell& shell, const DiscoverArguments& arguments, const discovery::FigureRenderer& renderer) {
    const std::vector<cases::MeasuredStudy> studies = cases::measured_studies(arguments.measured, shell.progress());
    if (studies.empty()) {
        throw core::InputError("missing", "none of the measurements of cases/measured is in this folder",
                               core::Place{arguments.measured, {}, {}, {}}, "cases/measured/README.md names them");
    }
    cases::write_measured_reports(studies, arguments.out, renderer);
    nlohmann::json all = nlohmann::json::array();
    for (const cases::MeasuredStudy& study : studies) {
        nlohmann::json one = discovery::to_json(study.found);
        one["study"] = study.name;
        one["known"] = study.known;
        all.push_back(one);
        shell.print(study.name + ": " + study.found.sentence + "\n  known: " + study.known + "\n");
    }
    shell.print("Report: " + (std::filesystem::path(arguments.out) / "index.html").string());
    if (shell.json) {
        shell.print_json({{"studies", all}});
    }
    return static_cast<int>(ExitCode::done);
}

/// A raw log to forces at set points.
int reduce(Shell& shell, const DiscoverArguments& arguments) {
    discovery::LoadCellOptions options;
    options.settle = option_value("--settle", arguments.settle, "s");
    options.without_thrust = arguments.without_thrust;
    const discovery::LoadCellReduction reduction =
        discovery::reduce_load_cell(core::read_csv(std::filesystem::path(arguments.log)), options);
    shell.show(reduction.problems);
    core::write_csv(arguments.out, reduction.table);
    if (shell.json) {
        shell.print_json({{"rows", reduction.table.rows()},
                          {"drift_rate", std::isfinite(reduction.drift_rate) ? nlohmann::json(reduction.drift_rate)
                                                                             : nlohmann::json(nullptr)},
                          {"hysteresis", reduction.hysteresis},
                          {"friction", reduction.friction},
                          {"noise", reduction.noise}});
    }
    shell.print(arguments.out + ": " + discovery::reduction_text(reduction));
    return static_cast<int>(ExitCode::done);
}

/// Separation along the gap and stability map with the new model beside those with the old one: figures for the report,
/// keys of `consequence`, and a few words.
std::string make_again(discovery::Discovery& found, const dynamics::Model& model, const dynamics::Measurements& data,
                       Shell& shell) {
    const auto made = discovery::make_again(found, model, data, shell.progress());
    if (!made) {
        return {};
    }
    const estimator::MadeAgain& again = *made;
    std::string text;
    if (again.separation_before && again.separation_after) {
        const auto millinewton = [](double force) { return core::format_number(1e3 * force, 3); };
        text += "Separation along the gap made again: what departs from the model's forces " +
                millinewton(again.separation_before->departure) + " -> " +
                millinewton(again.separation_after->departure) + " mN rms\n";
    }
    if (again.map_before && again.map_after) {
        const auto safe = [](const dynamics::StabilityRegion& map) {
            double share = 0;
            for (const dynamics::EndClass& end : map.classes) {
                share += end.kind == dynamics::EndKind::attractor ? end.fraction : 0;
            }
            return core::format_number(100 * share, 3) + " %";
        };
        text += "Stability map made again: starts that end at an attractor " + safe(*again.map_before) + " -> " +
                safe(*again.map_after) + "\n";
    }
    for (const std::string& reason : again.left_out) {
        text += "Not made again: " + reason + "\n";
    }
    return text;
}

/// The end of the chain: files for controllers with the model as declared and as found, and what changed in them.
std::string export_again(discovery::Discovery& found, const dynamics::Model& model, const DiscoverArguments& arguments,
                         Shell& shell) {
    const std::filesystem::path folder(arguments.out);
    nlohmann::json all = nlohmann::json::array();
    std::string text;
    const core::ReplacingAllowed by_the_export_itself;  // it knows its own files by what is in them
    for (const std::string& name : arguments.exports) {
        const estimator::ExportedAgain again =
            estimator::export_again(model, found.model, folder, name, shell.force, shell.progress());
        shell.show(again.remarks);
        all.push_back(again);
        for (const core::ReportTable& table : again.tables()) {
            found.made_again_tables.push_back(table);
            text += name + ", " + table.title + ": " + table.note + "\n";
        }
        text += "Exported: " + again.before.front().string() + " (as declared), " + again.after.front().string() +
                " (as found)\n";
    }
    nlohmann::json keys = found.made_again ? *found.made_again : nlohmann::json::object();
    if (!all.empty()) {
        keys["exports"] = all;
        found.made_again = std::make_shared<const nlohmann::json>(keys);
    }
    return text;
}

/// The files that are written: before the work.
void check_files(const DiscoverArguments& arguments) {
    for (const char* file : {"model.toml", "report.html", "discovery.json", "next-experiment.csv"}) {
        Shell::will_write((std::filesystem::path(arguments.out) / file).string());
    }
    for (const std::string& name : arguments.exports) {
        if (std::filesystem::path(name).has_parent_path()) {
            throw core::UsageError("path", "'" + name + "' is more than the name of a file", {},
                                   "it is written into --out: --export lift.h");
        }
        (void)estimator::export_format_of(name);
    }
}

int discover_effects(Shell& shell, const DiscoverArguments& arguments, const discovery::FigureRenderer& renderer) {
    if (arguments.model.empty() || arguments.data.empty()) {
        throw core::UsageError("missing", "discover needs the declared model and --data FOLDER", {},
                               "underbody discover model.toml --data runs --out found");
    }
    check_files(arguments);
    const dynamics::Model model = dynamics::read_model(arguments.model);
    const dynamics::Measurements data = dynamics::read_measurements(arguments.data);
    std::vector<std::string> warnings = show_table_warnings(shell, model, data);
    discovery::DiscoverOptions options;
    options.horizon = option_value("--horizon", arguments.horizon, "s");
    options.seed = arguments.seed;
    options.placebo_twins = arguments.placebo;
    options.candidates = arguments.candidates;
    for (const std::string& name : options.candidates) {
        (void)dynamics::effect(name);  // says the nearest name where there is none
    }
    discovery::Discovery found = discovery::discover(model, data, options, shell.progress());
    shell.show(found.problems);
    for (const core::Problem& problem : found.problems) {
        if (problem.severity != core::Problem::Severity::note) {
            warnings.push_back(problem.message);
        }
    }
    std::string again = make_again(found, model, data, shell);
    again += export_again(found, model, arguments, shell);
    discovery::write_discovery(found, model, data, arguments.out, renderer);
    if (shell.json) {
        nlohmann::json json = discovery::to_json(found);
        json["warnings"] = warnings;
        shell.print_json(json);
    }
    print(shell, found, arguments.out);
    shell.print(again);
    return ExitCode::done;
}

void add_options(CLI::App* command, const std::shared_ptr<DiscoverArguments>& arguments) {
    command->add_option("model", arguments->model, "the declared model (model.toml)");
    command->add_option("--data", arguments->data, "folder of measurements (with dataset.toml)");
    command->add_option("--out", arguments->out, "folder for model.toml, report.html and discovery.json")->required();
    command->add_option("--horizon", arguments->horizon, "length of the prediction windows of a time series");
    command->add_option("--seed", arguments->seed, "seed of all random draws");
    command->add_option("--placebo", arguments->placebo,
                        "simulated twins with nothing missing that go through the same procedure (0: none)");
    command->add_option("--measured-studies", arguments->measured,
                        "instead of a model and data: the folder of third-party measurements that the shipped studies "
                        "(cases/measured) read");
    command->add_option("--reduce", arguments->log,
                        "instead of a model and data: the raw log of a load cell (time, gap, jet_voltage, one force); "
                        "--out is then the table of forces");
    command->add_option("--settle", arguments->settle, "with --reduce: left out at the beginning of each block");
    command->add_flag("--without-thrust", arguments->without_thrust,
                      "with --reduce: take the force at the largest gap of each voltage off");
    command
        ->add_option("--candidates", arguments->candidates,
                     "effects to consider, by name, comma separated (default: all that such data can show)")
        ->delimiter(',');
    command->add_option("--export", arguments->exports,
                        "file for a controller (its ending says the format, such as lift.h), written into --out with "
                        "the model as found and into --out/declared with the model as declared, and compared in the "
                        "report; may be given again");
}

}  // namespace

void add_discover_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand(
        "discover", "find what the model lacks: from measured data to the effect, and the error before and after");
    auto arguments = std::make_shared<DiscoverArguments>();
    add_options(command, arguments);
    command->footer(
        "Examples:\n"
        "  underbody discover model.toml --data runs --out found        report, new model and discovery.json in "
        "found/\n"
        "  underbody discover model.toml --data runs --out found --json   the same, discovery.json on stdout as well\n"
        "  underbody discover model.toml --data runs --out found --candidates coulomb_friction,linear_damping\n"
        "  underbody discover model.toml --data runs --out found --export lift.h   and the header before and after\n"
        "  underbody predict found/model.toml --data other-runs         the new model on data it has not seen\n"
        "  underbody discover --reduce log.csv --out bench.csv          raw log of a load cell to forces, by its "
        "pump-off blocks\n"
        "  underbody discover --measured-studies ../shared/measured --out studies   the shipped studies of "
        "measurements by others\n"
        "The verdict is 'none', 'effect' (named, with its numbers) or 'unknown' (a smooth correction takes its "
        "place).");
    shell.on(command, [arguments, &shell] {
        const auto renderer = [](const core::Figure& figure) { return render_png(figure); };
        if (!arguments->measured.empty()) {
            return study_measurements(shell, *arguments, renderer);
        }
        if (!arguments->log.empty()) {
            return reduce(shell, *arguments);
        }
        return discover_effects(shell, *arguments, renderer);
    });
}

}  // namespace underbody::studio
