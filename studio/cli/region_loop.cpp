#include "studio/cli/region_loop.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/estimator/control/loop_region.h"

namespace underbody::studio {

namespace {

using namespace estimator;

/// Do its estimates hold gap and heave velocity, or the force alone?
bool gives_the_state(const LoopEstimator& e) {
    const auto has = [&](const char* name) {
        return e.filter &&
               std::find(e.filter->estimates.begin(), e.filter->estimates.end(), name) != e.filter->estimates.end();
    };
    return e.source == ForceSource::extended || (has("gap") && has("heave_velocity"));
}

struct ClosedLoop {
    SeparatedPlant plant;
    ControlLaw law;
    LoopEstimator estimator;
    LoopOptions options;
};

ClosedLoop loop_of(const RegionLoopOptions& a, const dynamics::Model& model, const dynamics::RegionOptions& options,
                   std::uint64_t seed) {
    if (!options.feedback) {
        throw core::UsageError("missing", "--observer estimates for a feedback in heave, and none is given", {},
                               "add --feedback gap_gain=10,velocity_gain=9,reference=20mm, or --lqr");
    }
    ClosedLoop loop{separate(model, options.held), {}, {}, {}};
    const dynamics::HeaveFeedback& gains = *options.feedback;
    loop.law = {gains.velocity_gain,
                gains.gap_gain,
                gains.reference,
                a.cancel,
                a.cancel,
                gains.limit > 0 ? gains.limit : INFINITY};
    LoopOptions& o = loop.options;
    o.duration = options.duration;
    o.step = a.step.empty() ? 0.02 : option_value("--step", a.step, "s");
    o.gap_noise = a.gap_noise.empty() ? 0 : option_value("--gap-noise", a.gap_noise, "m");
    o.velocity_noise = a.velocity_noise.empty() ? 0 : option_value("--velocity-noise", a.velocity_noise, "m/s");
    o.seed = seed;
    o.velocity_measured = !a.no_velocity;
    o.feedback = a.feedback_on == "measured" ? Feedback::measured : Feedback::estimated;
    if (!(o.step > 0) || o.gap_noise < 0 || o.velocity_noise < 0) {
        throw core::UsageError("range", "the sample time is positive, noises are not negative");
    }
    loop.estimator = design_loop_estimator(a.observer, loop.plant, estimator::design_for(o, a.rate));
    if (o.feedback == Feedback::estimated && !gives_the_state(loop.estimator)) {
        if (!a.cancel || a.no_velocity) {
            throw core::UsageError(
                "conflict",
                "the " + a.observer +
                    " observer estimates no gap and heave velocity: without cancelled forces the loop "
                    "would not know of it",
                {}, "take extended, kalman, full or latent, or add --cancel with measured velocity");
        }
        o.feedback = Feedback::measured;
    }
    return loop;
}

nlohmann::json loop_json(const RegionLoopOptions& a, const ClosedLoop& loop) {
    const LoopOptions& o = loop.options;
    return {{"observer", a.observer},
            {"sample_time", o.step},
            {"gap_noise", o.gap_noise},
            {"velocity_noise", o.velocity_noise},
            {"velocity_measured", o.velocity_measured},
            {"feedback_on", o.feedback == Feedback::estimated ? "estimated" : "measured"},
            {"cancels_forces", loop.law.cancel},
            {"gap_gain", loop.law.gap_gain},
            {"velocity_gain", loop.law.velocity_gain},
            {"reference", loop.law.reference_gap},
            {"limit", std::isfinite(loop.law.limit) ? nlohmann::json(loop.law.limit) : nlohmann::json()}};
}

}  // namespace

void RegionLoopOptions::add_to(CLI::App& command) {
    command.add_option(
        "--observer", observer,
        "with --feedback or --lqr: the estimator in the loop, which sees the sensors at the sample time: "
        "extended, kalman, full, latent, or with --cancel also reduced, disturbance; truth, none");
    command.add_option("--step", step, "sample time of sensors, estimator and law (default 0.02 s)");
    command.add_option("--gap-noise", gap_noise, "one standard deviation of the gap sensor per sample, such as 0.2mm");
    command.add_option("--velocity-noise", velocity_noise, "likewise of the velocity sensor");
    command.add_flag("--no-velocity", no_velocity, "the gap alone is measured");
    command.add_option("--use", feedback_on, "gap and velocity that the law takes: estimated (default) or measured")
        ->check(CLI::IsMember({"estimated", "measured"}));
    command.add_flag("--cancel", cancel, "the law cancels the estimated total force and the net weight as well");
    command.add_option("--rate", rate, "slowest pole of the estimator's error, 1/s (default 4)");
}

void RegionLoopOptions::check() const {
    if (!given() && (!step.empty() || !gap_noise.empty() || !velocity_noise.empty() || cancel || no_velocity)) {
        throw core::UsageError("missing",
                               "sample time, sensor noise and cancelled forces need an estimator in the loop", {},
                               "add --observer extended");
    }
}

core::Table commented_map(const dynamics::StabilityRegion& region, Shell& shell) {
    return commented(shell, dynamics::region_table(region));
}

std::string text_of(const dynamics::StabilityRegion& region) {
    std::string text = region.rule + "\n";
    for (const dynamics::EndClass& end : region.classes) {
        text +=
            std::string(dynamics::end_kind_name(end.kind)) +
            (end.name == dynamics::end_kind_name(end.kind) ? "" : " " + end.name) +
            (std::isnan(end.gap) ? "" : " at " + core::format_number(1e3 * end.gap, 5) + " mm") + ": " +
            core::format_number(100 * end.fraction, 4) + " %" +
            (end.outside > 0 ? " (" + core::format_number(100 * end.outside, 4) + " % by motions beyond a force table)"
                             : "") +
            "\n";
    }
    return text;
}

int run_region_with_estimator(const RegionLoopOptions& a, const dynamics::Model& model,
                              const dynamics::RegionOptions& options, std::size_t draws, std::uint64_t seed,
                              const std::string& picture, const std::string& table, Shell& shell) {
    const ClosedLoop loop = loop_of(a, model, options, seed);
    LoopRegionOptions grid;
    grid.axes = options.axes;
    grid.columns = options.columns;
    grid.rows = options.rows;
    nlohmann::json json;
    std::string text;
    core::Figure figure;
    nlohmann::json forces;
    show_forces(shell, model, options.held, forces);
    if (draws > 0) {
        const dynamics::ProbabilityMap map =
            loop_probability(loop.plant, loop.law, loop.estimator, loop.options, grid, draws, shell.progress());
        shell.show(map.remarks);
        dynamics::to_json(json, map);
        figure = dynamics::probability_figure(map);
        figure.title = "Chance that the loop holds the gap";
        text = "held from " + core::format_number(100 * map.area_mean, 4) + " % +- " +
               core::format_number(100 * map.area_sigma, 3) + " % of the starts, over " +
               core::counted(map.draws, "draw") + " of the sensors' noise\n";
    } else {
        const dynamics::StabilityRegion region =
            loop_region(loop.plant, loop.law, loop.estimator, loop.options, grid, shell.progress());
        shell.show(region.remarks);
        dynamics::to_json(json, region);
        figure = dynamics::region_figure(region);
        figure.title = "Where starts end with the loop and its estimator";
        if (!table.empty()) {
            core::write_csv(std::filesystem::path(table), commented_map(region, shell));
        }
        text = text_of(region);
    }
    if (!picture.empty()) {
        write_picture(figure, picture);
    }
    json["loop"] = loop_json(a, loop);
    json.update(forces);
    shell.print(text);
    if (shell.json) {
        shell.print_json(json);
    }
    return ExitCode::done;
}

}  // namespace underbody::studio
