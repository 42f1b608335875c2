// underbody control: holds a gap over the model with the estimated forces cancelled.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "core/file.h"
#include "core/hash.h"
#include "core/table.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/estimator/control/loop_region.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

namespace {

using namespace estimator;

struct ControlArguments {
    std::string model, hold, from, observer = "disturbance", conditions, out, plot, region, axes, limit, lag,
                                   step = "0.02 s", duration = "60 s", gap_noise, velocity_noise, disturbance,
                                   feedback = "measured", export_c;
    double pole1 = -1, pole2 = -1, observer_rate = 4;
    std::size_t columns = 60, rows = 40;
    std::uint64_t seed = 1;
    bool no_velocity = false, compare = false;
};

double quantity(const char* option, const std::string& text, const char* unit, double fallback) {
    return text.empty() ? fallback : option_value(option, text, unit);
}

LoopDesign design_for(const ControlArguments& a, const LoopOptions& o) {
    LoopDesign d;
    d.rate = a.observer_rate;
    d.step = o.step;
    d.gap_noise = o.gap_noise > 0 ? o.gap_noise : d.gap_noise;
    d.velocity_noise = o.velocity_noise > 0 ? o.velocity_noise : d.velocity_noise;
    d.velocity_measured = o.velocity_measured;
    return d;
}

/// Every estimator in the same loop.
nlohmann::json compare_estimators(const ControlArguments& a, const SeparatedPlant& plant, const ControlLaw& law,
                                  LoopOptions o, std::string& text) {
    nlohmann::json list = nlohmann::json::array();
    text += "estimator      held, mm  spread, mm  error of F_T, mN  at the limit, %\n";
    for (const std::string& name : loop_estimators()) {
        LoopOptions own = o;
        std::string remark;
        try {
            const LoopEstimator e = design_loop_estimator(name, plant, design_for(a, o));
            const bool gives =
                e.source == ForceSource::extended || name == "full" || name == "latent" || name == "kalman";
            if (!o.velocity_measured) {
                own.feedback = gives ? Feedback::estimated : own.feedback;
            }
            const LoopRun run = close_loop(plant, law, e, own);
            nlohmann::json item = run;
            item["estimator"] = name;
            list.push_back(item);
            char error[32] = "-", line[160];
            if (run.total_force_error) {
                std::snprintf(error, sizeof error, "%.4f", 1e3 * *run.total_force_error);
            }
            std::snprintf(line, sizeof line, "%-12s %10.4f  %10.4f  %16s  %15.2f%s\n", name.c_str(),
                          1e3 * (law.reference_gap + run.hold_error), 1e3 * run.hold_sigma, error, 100 * run.saturated,
                          run.touched  ? "  touched the ground"
                          : run.finite ? ""
                                       : "  escaped");
            text += line;
        } catch (const core::InputError& error) {
            list.push_back({{"estimator", name}, {"refused", error.what()}});
            text += name + ": " + error.what() + "\n";
        }
    }
    return list;
}

core::Figure figure_of(const LoopRun& run, double hold) {
    core::Figure f;
    f.title = "Holding the gap";
    f.x = {"time", "s", 0, 0, false};
    f.y = {"gap", "mm", 0, 0, false};
    core::FigureCurve curve;
    curve.name = "gap";
    curve.x = run.time;
    curve.y = run.gap;
    for (double& v : curve.y) {
        v *= 1e3;
    }
    curve.colour = core::palette(0);
    f.curves.push_back(curve);
    f.lines.push_back({false, 1e3 * hold, "asked for", {120, 120, 120, 255}, true});
    return f;
}

nlohmann::json draw_region(const ControlArguments& a, const SeparatedPlant& plant, const ControlLaw& law,
                           const LoopEstimator& estimator, const LoopOptions& o, Shell& shell, std::string& text) {
    LoopRegionOptions options;
    const double lower = std::max(plant.lower, plant.contact_gap);
    options.axes = a.axes.empty()
                       ? std::vector<core::NamedRange>{{"gap", lower, plant.upper}, {"heave_velocity", -0.1, 0.1}}
                       : core::parse_ranges(a.axes);
    options.columns = a.columns;
    options.rows = a.rows;
    const dynamics::StabilityRegion region = loop_region(plant, law, estimator, o, options, shell.progress());
    core::Figure figure = dynamics::region_figure(region);
    figure.title = "Where starts end with the loop closed";
    write_picture(figure, a.region);
    text = core::format_number(100 * region.fraction("held"), 4) + " % of the starts end at the gap asked for\n";
    return region;
}

/// What the controller in C is made of.
std::vector<std::string> made_from(const ControlArguments& a, const dynamics::Model& model) {
    std::vector<std::string> lines{std::filesystem::path(a.model).filename().string() + ", content " +
                                   core::content_hash_of_file(a.model).substr(0, 12)};
    if (!a.conditions.empty()) {
        lines.push_back("conditions " + a.conditions);
    }
    if (std::string reading = dynamics::reading_on_the_rig(model.records); !reading.empty()) {
        lines.push_back("WARNING: " + reading);
    }
    return lines;
}

LoopOptions loop_options(const ControlArguments& a, double reference_gap) {
    LoopOptions o;
    o.step = option_value("--step", a.step, "s");
    o.duration = option_value("--for", a.duration, "s");
    o.actuator_lag = quantity("--lag", a.lag, "s", 0);
    o.gap_noise = quantity("--gap-noise", a.gap_noise, "m", 0);
    o.velocity_noise = quantity("--velocity-noise", a.velocity_noise, "m/s", 0);
    o.seed = a.seed;
    o.velocity_measured = !a.no_velocity;
    o.feedback = a.feedback == "measured" && !a.no_velocity ? Feedback::measured : Feedback::estimated;
    if (a.feedback != "measured" && a.feedback != "estimated") {
        throw core::UsageError("name", "--feedback does not know '" + a.feedback + "'", {}, "measured or estimated");
    }
    if (!a.disturbance.empty()) {
        const double constant = option_value("--disturbance", a.disturbance, "N");
        o.disturbance = [constant](double) { return constant; };
    }
    o.gap = reference_gap;
    for (const core::NamedValue& v : core::parse_assignments(a.from)) {
        if (v.name != "gap" && v.name != "heave_velocity") {
            throw core::UsageError("name", "--from knows gap and heave_velocity, not '" + v.name + "'");
        }
        (v.name == "gap" ? o.gap : o.velocity) = v.value;
    }
    return o;
}

/// What cannot be held, or not by this limit.
void check(const ControlArguments& a, const SeparatedPlant& plant, const ControlLaw& law, const LoopOptions& o,
           std::vector<std::string>& warnings) {
    if (!(law.reference_gap > plant.contact_gap)) {
        throw core::UsageError("range", "--hold " + a.hold +
                                            " is no gap that can be held: the vehicle touches the ground at " +
                                            core::format_number(1e3 * plant.contact_gap, 4) + " mm");
    }
    if (o.gap < plant.contact_gap) {
        throw core::InputError("range", "the start lies inside the ground");
    }
    if (!(law.limit > 0)) {
        throw core::UsageError("range", "--limit " + a.limit + " is no largest force: it is to be above 0");
    }
    if (law.gap_gain <= 0 || law.velocity_gain <= 0) {
        throw core::UsageError("range", "the poles of the loop must lie left of zero");
    }
    double slope = 0;
    const double needed = std::abs(plant.ground_force(law.reference_gap, slope) + plant.bias);
    if (needed > law.limit) {
        warnings.push_back("the limit of " + core::format_number(1e3 * law.limit, 4) +
                           " mN cannot hold this gap: the balance there needs " + core::format_number(1e3 * needed, 4) +
                           " mN");
    }
    if (const double fastest = std::max(std::abs(a.pole1), std::abs(a.pole2)); o.step * fastest > 0.5) {
        warnings.push_back("a sample time of " + core::told(o.step, "s") +
                           " is long beside the loop, whose fastest pole decays within " +
                           core::told(1 / fastest, "s"));
    }
    const auto& known = loop_estimators();
    if (std::find(known.begin(), known.end(), a.observer) == known.end()) {
        throw core::UsageError("name", "--observer does not know '" + a.observer + "'", {},
                               core::did_you_mean(a.observer, known));
    }
}

nlohmann::json json_of(const LoopRun& loop, const SeparatedPlant& plant, const ControlLaw& law,
                       const ControlArguments& a, const nlohmann::json& notes) {
    nlohmann::json json = loop;
    json.update(notes);
    json["velocity_gain"] = law.velocity_gain;
    json["gap_gain"] = law.gap_gain;
    nlohmann::json points = nlohmann::json::array();
    for (const HoldPoint& p : hold_points_without_cancellation(plant, law)) {
        points.push_back({{"gap", p.gap}, {"stable", p.stable}});
    }
    json["hold_without_cancellation"] = points;
    json["observer"] = a.observer;
    return json;
}

void write_files(const ControlArguments& a, const dynamics::Model& model, const LoopRun& loop,
                 const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
                 const LoopOptions& o, Shell& shell) {
    if (!a.export_c.empty()) {
        const std::string name = tables::identifier(std::filesystem::path(a.export_c).stem().string());
        core::write_file(a.export_c, export_controller_c(plant, law, estimator, o, name, made_from(a, model)));
    }
    if (!a.out.empty()) {
        core::write_csv(std::filesystem::path(a.out), commented(shell, loop.table()));
    }
    if (!a.plot.empty()) {
        write_picture(figure_of(loop, law.reference_gap), a.plot);
    }
}

int run_compare(const ControlArguments& a, const SeparatedPlant& plant, const ControlLaw& law, const LoopOptions& o,
                const nlohmann::json& notes, Shell& shell) {
    if (!a.export_c.empty()) {
        throw core::UsageError("option", "--export-c writes one controller, --compare compares them all", {},
                               "leave one of them out");
    }
    std::string text;
    const nlohmann::json list = compare_estimators(a, plant, law, o, text);
    if (shell.json) {
        nlohmann::json json = notes;
        json["estimators"] = list;
        shell.print_json(json);
    }
    shell.print(text);
    return ExitCode::done;
}

/// What is said of gaps that the tables do not cover, each once.
std::vector<std::string> show_gaps_outside(Shell& shell, const dynamics::Model& model, dynamics::Conditions held,
                                           const std::set<double>& gaps) {
    std::vector<std::string> said;
    for (const double gap : gaps) {
        held[dynamics::Channel::gap] = gap;
        const core::Problems outside = dynamics::held_outside(model, held);
        shell.show(outside);
        for (const core::Problem& problem : outside) {
            said.push_back(problem.message);
        }
    }
    return said;
}

int run_control(const ControlArguments& a, Shell& shell) {
    for (const std::string& file : {a.out, a.plot, a.region, a.export_c}) {
        Shell::will_write(file);
    }
    const dynamics::Model model = dynamics::read_model(a.model);
    dynamics::Conditions held;
    for (const auto& v :
         a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        held.set(v.name, v.value);
    }
    std::vector<std::string> warnings = show_table_warnings(shell, model, held);
    const SeparatedPlant plant = separate(model, held);
    shell.show(plant.remarks);
    const double hold = option_value("--hold", a.hold, "m");
    ControlLaw law = hold_at(hold, plant.mass_at(hold), a.pole1, a.pole2);
    law.limit = quantity("--limit", a.limit, "N", INFINITY);
    const LoopOptions o = loop_options(a, law.reference_gap);
    std::vector<std::string> own;
    check(a, plant, law, o, own);
    if (std::string reading = dynamics::reading_on_the_rig(model.records); !reading.empty()) {
        own.push_back(std::move(reading));
    }
    for (const std::string& warning : own) {
        shell.show_warning(warning);
        warnings.push_back(warning);
    }
    const std::vector<std::string> outside = show_gaps_outside(shell, model, held, {law.reference_gap, o.gap});
    warnings.insert(warnings.end(), outside.begin(), outside.end());
    const nlohmann::json notes = {{"warnings", warnings},
                                  {"held_at_reference", show_held_at_reference(shell, model, held)}};
    if (a.compare) {
        return run_compare(a, plant, law, o, notes, shell);
    }
    const LoopEstimator estimator = design_loop_estimator(a.observer, plant, design_for(a, o));
    const LoopRun loop = close_loop(plant, law, estimator, o);
    if (loop.touched || !loop.finite) {
        shell.show_warning(loop.touched ? "the vehicle touched the ground: the loop does not hold this gap"
                                        : "the loop does not hold this gap: the motion runs away");
    }
    shell.hand_over("motion", [&] { return commented(shell, loop.table()); });
    write_files(a, model, loop, plant, law, estimator, o, shell);
    nlohmann::json json = json_of(loop, plant, law, a, notes);
    std::string region_text;
    if (!a.region.empty()) {
        json["region"] = draw_region(a, plant, law, estimator, o, shell, region_text);
    }
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print("gap at the end " + core::format_number(1e3 * loop.gap.back(), 6) + " mm, " +
                core::format_number(1e3 * law.reference_gap, 6) + " mm asked for; " +
                (loop.total_force_error
                     ? "error of the total force " + core::format_number(1e3 * *loop.total_force_error, 3) + " mN rms; "
                     : std::string("no force is estimated; ")) +
                "at the limit " + core::format_number(100 * loop.saturated, 3) + " % of the time\n" + region_text);
    return ExitCode::done;
}

}  // namespace

void add_control_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("control", "hold a gap with the estimated forces cancelled");
    auto a = std::make_shared<ControlArguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--hold", a->hold, "the gap to hold, for instance 20mm")->required();
    command->add_option("--from", a->from, "start: gap=..., heave_velocity=...")->required();
    command->add_option(
        "--observer", a->observer,
        "disturbance (default), reduced, full, latent, kalman, extended, truth, or none: no cancellation");
    command->add_option("--pole1", a->pole1, "of the loop, 1/s (default -1)");
    command->add_option("--pole2", a->pole2, "of the loop, 1/s (default -1)");
    command->add_option("--rate", a->observer_rate, "of the observer, 1/s (default 4)");
    command->add_option("--limit", a->limit, "largest control force, for instance 30mN");
    command->add_option("--lag", a->lag, "time constant of the actuator");
    command->add_option("--step", a->step, "sample time (default 0.02 s)");
    command->add_option("--for", a->duration, "how long (default 60 s)");
    command->add_option("--gap-noise", a->gap_noise, "one standard deviation of the gap sensor");
    command->add_option("--velocity-noise", a->velocity_noise, "likewise of the velocity sensor");
    command->add_option("--conditions", a->conditions, "what is held: speed=0.5m/s,jet_voltage=8V");
    command->add_flag("--no-velocity", a->no_velocity, "the gap alone is measured: feedback on the estimated velocity");
    command->add_option("--feedback", a->feedback, "measured (default) or estimated gap and velocity");
    command->add_option("--disturbance", a->disturbance, "a constant force that no model knows, up, for instance 3mN");
    command->add_flag("--compare", a->compare, "every estimator in the same loop, as a table");
    command->add_option("--seed", a->seed, "seed of the noise (default 1)");
    command->add_option("--out", a->out, "the motion as a table (CSV)");
    command->add_option("--plot", a->plot, "the gap against time (.png, .pdf)");
    command->add_option("--region", a->region, "where starts end with the loop closed (.png, .pdf)");
    command->add_option(
        "--export-c", a->export_c,
        "the controller (law, linear observer, actuator) as a C99 header; its name is that of the file");
    command->add_option("--axes", a->axes,
                        "of the region: gap=0:0.5,heave_velocity=-0.1:0.1 (default: the force table, 100 mm/s)");
    command->add_option("--columns", a->columns, "of the region (default 60)");
    command->add_option("--rows", a->rows, "of the region (default 40)");
    command->footer(
        "Examples:\n"
        "  underbody control model.toml --hold 20mm --from gap=0.25 --out loop.csv\n"
        "  underbody control model.toml --hold 20mm --from gap=0.25 --observer none --json\n"
        "  underbody control model.toml --hold 20mm --from gap=0.25 --gap-noise 0.2mm --velocity-noise 0.2mm/s "
        "--compare\n"
        "  underbody control model.toml --hold 50mm --from gap=0.1 --observer extended --no-velocity --disturbance "
        "3mN\n"
        "  underbody control model.toml --hold 50mm --from gap=0.1 --limit 30mN --lag 0.2s --gap-noise 0.2mm --region "
        "loop.png\n"
        "  underbody control model.toml --hold 20mm --from gap=0.25 --export-c hold.h      the controller for a "
        "microcontroller\n"
        "u = -k_w w - k_h (gap - hold) - total_force_estimate - bias, gains from the two poles and the virtual mass.");
    shell.on(command, [a, &shell] { return run_control(*a, shell); });
}

}  // namespace underbody::studio
