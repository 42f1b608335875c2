// underbody estimate: separate forces from gap and velocity.
#include "surrogates/estimator/observe/estimate.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/estimator/observe/information.h"
#include "surrogates/estimator/observe/surface_bank.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

namespace {

struct EstimateArguments {
    std::string model, data, out, plot, poles, export_c, gap_noise, velocity_noise, blind, consistency, surface_plot;
    std::vector<std::string> surfaces;
    double switching = 0;
    estimator::EstimateOptions options;
};

estimator::Poles parse_poles(const std::string& text) {
    estimator::Poles poles;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        std::string item = text.substr(at, comma - at);
        while (!item.empty() && item.front() == ' ') {
            item.erase(item.begin());
        }
        double real = 0, imaginary = 0;
        const char* end = item.data() + item.size();
        auto result = std::from_chars(item.data(), end, real);
        if (result.ec == std::errc() && result.ptr != end) {
            const char* from = *result.ptr == '+' ? result.ptr + 1 : result.ptr;
            result = std::from_chars(from, end, imaginary);
            if (result.ec == std::errc() && result.ptr != end && *result.ptr == 'i') {
                ++result.ptr;
            }
        }
        if (result.ec != std::errc() || result.ptr != end) {
            throw core::UsageError("parse", "'" + item + "' is no pole", {},
                                   "for instance --poles -3,-4 or --poles -3+1i,-3-1i");
        }
        poles.emplace_back(real, imaginary);
        at = comma + 1;
    }
    return poles;
}

nlohmann::json identify(const EstimateArguments& a, const dynamics::Measurements& data,
                        const estimator::FilterNoise& noise, std::string& text, core::Figure& figure) {
    std::vector<std::pair<std::string, dynamics::Model>> models;
    for (const auto& item : a.surfaces) {
        const std::size_t sign = item.find('=');
        if (sign == std::string::npos || sign == 0) {
            throw core::UsageError("parse", "--surface wants NAME=MODEL.toml, not '" + item + "'");
        }
        models.emplace_back(item.substr(0, sign), dynamics::read_model(item.substr(sign + 1)));
    }
    const estimator::SurfaceReport report = estimator::identify_surfaces(models, data, noise, a.switching);
    text += report.text();
    figure = report.figure();
    return report;
}

/// What the sensors can know along the gap: bounds drawn, and the filter's own statements tried on simulated runs.
nlohmann::json along_gap(const EstimateArguments& a, const dynamics::Model& model, const dynamics::Measurements& data,
                         const estimator::Estimation& result, Shell& shell, std::string& text) {
    const estimator::SeparatedPlant plant = estimator::separate(model, dynamics::signals_of(data.runs.front()).held);
    estimator::InformationOptions o;
    o.noise = result.noise;
    o.drag_prior = a.options.drag_relative;
    const auto map = estimator::information_along_gap(plant, o, shell.progress());
    if (!a.blind.empty()) {
        write_picture(map.figure(), a.blind);
    }
    estimator::ConsistencyOptions c;
    c.noise = result.noise;
    const auto consistency = estimator::consistency_along_gap(plant, c, shell.progress());
    if (!a.consistency.empty()) {
        write_picture(consistency.figure(), a.consistency);
    }
    const auto observability = estimator::observability_along_gap(plant, map.gaps);
    const auto one = static_cast<std::size_t>(
        std::count(observability.separate_rank.begin(), observability.separate_rank.end(), 1U));
    text += "along the gap: the ground force is blind on " + core::format_number(100 * map.blind_share, 3) +
            " % of gaps and speeds; " + core::format_number(100 * consistency.inside, 3) +
            " % of mean NEES lie within " + core::format_number(consistency.lower, 3) + " to " +
            core::format_number(consistency.upper, 3) +
            " (95 % are right); the analytic model sees one of two forces apart at " + std::to_string(one) + " of " +
            core::counted(map.gaps.size(), "gap") + "\n";
    return {{"information", map}, {"consistency", consistency}, {"observability", observability}};
}

std::string text_of(const estimator::Estimation& result) {
    std::string text = result.explanation + "\n";
    for (const auto& [name, label] : result.labels) {
        text += "  " + name + ": " + label + "\n";
    }
    if (std::isfinite(result.separability.b_eff)) {
        text += "drag law that the model holds at slow drift: b_eff = " +
                core::format_number(result.separability.b_eff, 4) + " N s/m; observability determinant " +
                core::format_number(result.separability.determinant, 4) + "\n";
    }
    for (const auto& r : result.runs) {
        text += r.name + ": " + core::counted(r.samples, "sample");
        for (const auto& [count, what] : {std::pair(r.missing, " gaps missing"), std::pair(r.outliers, " outliers"),
                                          std::pair(r.gaps_in_time, " holes in time")}) {
            text += count > 0 ? ", " + std::to_string(count) + what : "";
        }
        if (std::isfinite(r.mean_squared_innovation)) {
            text += ", innovations " + core::format_number(std::sqrt(r.mean_squared_innovation), 3) +
                    " of what the filter states";
        }
        text += "\n";
    }
    return text;
}

estimator::EstimateOptions options_of(const EstimateArguments& a) {
    estimator::EstimateOptions options = a.options;
    if (!a.poles.empty()) {
        options.poles = parse_poles(a.poles);
    }
    options.gap_sigma = a.gap_noise.empty() ? 0 : option_value("--gap-noise", a.gap_noise, "m");
    options.velocity_sigma = a.velocity_noise.empty() ? 0 : option_value("--velocity-noise", a.velocity_noise, "m/s");
    return options;
}

void write_files(const EstimateArguments& a, const dynamics::Model& model, const estimator::Estimation& result,
                 Shell& shell) {
    if (!a.out.empty()) {
        core::write_csv(std::filesystem::path(a.out), commented(shell, result.table));
    }
    if (!a.export_c.empty()) {
        const std::string name = tables::identifier(std::filesystem::path(a.export_c).stem().string());
        std::vector<std::string> made_from = {a.model};
        if (std::string reading = dynamics::reading_on_the_rig(model.records); !reading.empty()) {
            made_from.push_back("WARNING: " + reading);
        }
        core::write_file(a.export_c, estimator::export_c(result.design.front().filter, name, made_from));
    }
    if (!a.plot.empty()) {
        write_picture(result.figure, a.plot);
    }
}

nlohmann::json json_of(const estimator::Estimation& result, const nlohmann::json& surfaces, const nlohmann::json& along,
                       const std::vector<std::string>& warnings) {
    nlohmann::json json = result;
    json["warnings"] = warnings;
    if (!surfaces.is_null()) {
        json["surfaces"] = surfaces;
    }
    if (!along.is_null()) {
        json["along_gap"] = along;
    }
    return json;
}

int run_estimate(const EstimateArguments& a, Shell& shell) {
    for (const std::string& file : {a.out, a.plot, a.surface_plot, a.blind, a.consistency, a.export_c}) {
        Shell::will_write(file);
    }
    const dynamics::Model model = dynamics::read_model(a.model);
    const dynamics::Measurements data = dynamics::read_measurements(a.data);
    std::vector<std::string> warnings = show_table_warnings(shell, model, data);
    shell.show(data.problems);
    const estimator::EstimateOptions options = options_of(a);
    const estimator::Estimation result = estimator::estimate(model, data, options, shell.progress());
    shell.show(result.remarks);
    std::string surfaces_text;
    nlohmann::json surfaces;
    if (!a.surfaces.empty()) {
        core::Figure figure;
        surfaces = identify(a, data, result.noise, surfaces_text, figure);
        if (!a.surface_plot.empty()) {
            write_picture(figure, a.surface_plot);
        }
    }
    nlohmann::json along;
    if (!a.blind.empty() || !a.consistency.empty()) {
        along = along_gap(a, model, data, result, shell, surfaces_text);
    }
    if (!a.export_c.empty() && result.design.empty()) {
        throw core::UsageError("missing", "the extended filter has no linear form to export", {},
                               "choose --observer kalman, reduced, full, latent or disturbance");
    }
    if (!a.export_c.empty()) {
        if (const std::string reading = dynamics::reading_on_the_rig(model.records); !reading.empty()) {
            shell.show_warning(reading);
            warnings.push_back(reading);
        }
    }
    shell.hand_over("estimates", [&] { return commented(shell, result.table); });
    write_files(a, model, result, shell);
    if (shell.json) {
        shell.print_json(json_of(result, surfaces, along, warnings));
    }
    shell.print(text_of(result) + surfaces_text);
    return ExitCode::done;
}

}  // namespace

void add_estimate_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("estimate", "forces of ground and drag from measured gap and velocity");
    auto a = std::make_shared<EstimateArguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--data", a->data, "folder of measurements (with dataset.toml, time series)")->required();
    command->add_option("--out", a->out, "estimates with their sigmas as a table (CSV)");
    command->add_option("--plot", a->plot, "forces of the first run (.png, .pdf)");
    command->add_option("--observer", a->options.observer,
                        "extended (default), kalman, reduced, full, latent or disturbance");
    command->add_option("--poles", a->poles, "poles of the error, 1/s (default -3,-4)");
    command->add_option("--order", a->options.order,
                        "order of the learned linear model (default: least squares with known rows)");
    command->add_option("--gap-noise", a->gap_noise,
                        "one standard deviation of the gap sensor (default: declared, else from the data)");
    command->add_option("--velocity-noise", a->velocity_noise, "likewise of measured heave velocity");
    command->add_option("--force-density", a->options.force_density,
                        "how fast the force may depart from its table, N^2/s (default: the likeliest)");
    command->add_option("--drag-error", a->options.drag_relative,
                        "relative deviation of the declared drag law (default 0.2)");
    command->add_flag("--smooth", a->options.smooth, "use the whole run for each moment");
    command->add_option("--surface", a->surfaces, "NAME=MODEL.toml, twice or more: which surface is under the vehicle");
    command->add_option("--surface-plot", a->surface_plot, "probability of each surface over the runs (.png, .pdf)");
    command->add_option("--switching", a->switching,
                        "chance per second that the surface changes within a run (default 0)");
    command->add_option("--blind-zones", a->blind,
                        "picture of what the sensors can know against gap and speed (.png, .pdf)");
    command->add_option("--consistency", a->consistency,
                        "picture of the filter's own statements tried on simulated runs: NEES against gap and speed");
    command->add_option("--export-c", a->export_c, "the linear observer as a C99 header");
    command->footer(
        "Examples:\n"
        "  underbody estimate model.toml --data runs --out est.csv\n"
        "  underbody estimate model.toml --data runs --observer kalman --export-c observer.h --json\n"
        "  underbody estimate model.toml --data runs --surface smooth=model.toml --surface rough=rough.toml\n"
        "What can be separated is said: the total force is observed; ground and drag force are told apart by the drag "
        "law\n"
        "that the model holds, and are labelled model-dependent.");
    shell.on(command, [a, &shell] { return run_estimate(*a, shell); });
}

}  // namespace underbody::studio
