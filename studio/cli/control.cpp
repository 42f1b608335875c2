// underbody control: holds a gap over the model with the estimated forces cancelled.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/model.h"
#include "surrogates/estimator/closed_loop.h"

namespace underbody::studio {

namespace {

using namespace estimator;

struct Arguments {
    std::string model, hold, from = "gap=0", observer = "disturbance", conditions, out, plot, region, limit, lag, step = "0.02 s", duration = "60 s",
                       gap_noise, velocity_noise;
    double pole1 = -1, pole2 = -1, observer_rate = 4;
    std::uint64_t seed = 1;
};

double quantity(const std::string& text, const char* unit, double fallback) {
    return text.empty() ? fallback : core::parse_in(text, unit);
}

/// The estimator that the loop cancels with; none for `truth` and `none`.
std::optional<LinearFilter> filter_for(const Arguments& a, const SeparatedPlant& plant, double step) {
    if (a.observer == "none" || a.observer == "truth") {
        return {};
    }
    if (a.observer == "disturbance") {
        return disturbance_observer(plant.virtual_mass, plant.bias, a.observer_rate, step).filter;
    }
    TrainingOptions t;
    t.gap_lower = std::max(plant.lower, plant.contact_gap);
    t.gap_upper = plant.upper;
    t.samples = 20000;
    const TrainingSet set = training_set(plant, t);
    const AugmentedModel model =
        corrected(learn(moments(set.view()), set.layout), Correction::p2, heave_rows(set.layout, plant.virtual_mass, plant.bias));
    const double r = a.observer_rate;
    const std::vector<std::string> sensors{"heave_velocity", "gap"};
    if (a.observer == "reduced") {
        return reduced_observer(model, reduced_gain(model, {{-r, 0}, {-1.3 * r, 0}}), step).filter;
    }
    if (a.observer == "full") {
        return full_observer(model, sensors, full_gain(model, sensors, {-r, -1.2 * r, -1.4 * r, -1.6 * r}), step).filter;
    }
    if (a.observer == "kalman") {
        const double rate = model.sigma[7] * model.sigma[7] + model.sigma[8] * model.sigma[8];
        return kalman_observer(model, sensors, {0, 0, rate, rate},
                               {quantity(a.velocity_noise, "m/s", 1e-4), quantity(a.gap_noise, "m", 2e-4)}, step)
            .filter;
    }
    throw core::UsageError("name", "--observer does not know '" + a.observer + "'", {},
                           core::did_you_mean(a.observer, {"disturbance", "reduced", "full", "kalman", "truth", "none"}));
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

int run(const Arguments& a, Shell& shell) {
    const dynamics::Model model = dynamics::read_model(a.model);
    dynamics::Conditions held;
    for (const auto& v : a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        held.set(v.name, v.value);
    }
    const SeparatedPlant plant = separate(model, held);
    shell.show(plant.remarks);
    ControlLaw law = hold_at(core::parse_in(a.hold, "m"), plant.virtual_mass, a.pole1, a.pole2);
    law.limit = quantity(a.limit, "N", INFINITY);
    LoopOptions o;
    o.step = core::parse_in(a.step, "s");
    o.duration = core::parse_in(a.duration, "s");
    o.actuator_lag = quantity(a.lag, "s", 0);
    o.gap_noise = quantity(a.gap_noise, "m", 0);
    o.velocity_noise = quantity(a.velocity_noise, "m/s", 0);
    o.seed = a.seed;
    o.gap = law.reference_gap;
    for (const core::NamedValue& v : core::parse_assignments(a.from)) {
        if (v.name != "gap" && v.name != "heave_velocity") {
            throw core::UsageError("name", "--from knows gap and heave_velocity, not '" + v.name + "'");
        }
        (v.name == "gap" ? o.gap : o.velocity) = v.value;
    }
    if (o.gap < plant.contact_gap) {
        throw core::InputError("range", "the start lies inside the ground");
    }
    if (law.gap_gain <= 0 || law.velocity_gain <= 0) {
        throw core::UsageError("range", "the poles of the loop must lie left of zero");
    }
    const auto filter = filter_for(a, plant, o.step);
    const ForceSource source = filter ? ForceSource::filter : a.observer == "truth" ? ForceSource::truth : ForceSource::none;
    const LoopRun loop = close_loop(plant, law, source, filter, o);
    if (!a.out.empty()) {
        core::write_csv(std::filesystem::path(a.out), loop.table());
    }
    if (!a.plot.empty()) {
        write_picture(figure_of(loop, law.reference_gap), a.plot);
    }
    nlohmann::json json = loop;
    json["velocity_gain"] = law.velocity_gain;
    json["gap_gain"] = law.gap_gain;
    nlohmann::json points = nlohmann::json::array();
    for (const HoldPoint& p : hold_points_without_cancellation(plant, law)) {
        points.push_back({{"gap", p.gap}, {"stable", p.stable}});
    }
    json["hold_without_cancellation"] = points;
    if (!a.region.empty()) {
        const double upper = plant.upper, lower = std::max(plant.lower, plant.contact_gap);
        LoopOptions map = o;
        map.gap_noise = map.velocity_noise = 0;
        const LoopRegion region = loop_region(plant, law, source, filter, map, 120, 80, lower, upper, -0.1, 0.1, shell.progress());
        write_picture(region.figure("Where starts end with the loop closed"), a.region);
        json["holds_fraction"] = region.holds;
    }
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print("gap at the end " + core::format_number(1e3 * loop.gap.back(), 6) + " mm, " + core::format_number(1e3 * law.reference_gap, 6) +
                " mm asked for; error of the total force " + core::format_number(1e3 * loop.total_force_error, 3) + " mN rms; at the limit " +
                core::format_number(100 * loop.saturated, 3) + " % of the time\n");
    return ExitCode::done;
}

}  // namespace

void add_control_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("control", "hold a gap with the estimated forces cancelled");
    auto a = std::make_shared<Arguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--hold", a->hold, "the gap to hold, for instance 20mm")->required();
    command->add_option("--from", a->from, "start: gap=..., heave_velocity=...")->required();
    command->add_option("--observer", a->observer, "disturbance (default), reduced, full, kalman, truth, or none: no cancellation");
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
    command->add_option("--seed", a->seed, "seed of the noise (default 1)");
    command->add_option("--out", a->out, "the motion as a table (CSV)");
    command->add_option("--plot", a->plot, "the gap against time (.png, .pdf)");
    command->add_option("--region", a->region, "where starts end with the loop closed (.png, .pdf)");
    command->footer(
        "Examples:\n"
        "  underbody control model.toml --hold 20mm --from gap=0.25 --out loop.csv\n"
        "  underbody control model.toml --hold 20mm --from gap=0.25 --observer none --json\n"
        "  underbody control model.toml --hold 50mm --from gap=0.1 --limit 30mN --lag 0.2s --gap-noise 0.2mm --region loop.png\n"
        "u = -k_w w - k_h (gap - hold) - total_force_estimate - bias, gains from the two poles and the virtual mass.");
    shell.on(command, [a, &shell] { return run(*a, shell); });
}

}  // namespace underbody::studio
