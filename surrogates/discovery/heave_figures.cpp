#include "surrogates/discovery/heave_figures.h"

#include <algorithm>
#include <cmath>

#include "surrogates/discovery/static_figures.h"

namespace underbody::discovery {

namespace {

/// Mean of y in bins of x, as a curve.
core::FigureCurve binned_mean(std::vector<std::pair<double, double>> points, const std::string& name, core::Colour colour) {
    std::sort(points.begin(), points.end());
    core::FigureCurve curve;
    curve.name = name;
    curve.colour = colour;
    constexpr std::size_t bins = 30;
    for (std::size_t b = 0; b < bins; ++b) {
        const std::size_t begin = b * points.size() / bins;
        const std::size_t end = (b + 1) * points.size() / bins;
        double x = 0;
        double y = 0;
        for (std::size_t k = begin; k < end; ++k) {
            x += points[k].first;
            y += points[k].second;
        }
        if (end > begin) {
            curve.x.push_back(x / static_cast<double>(end - begin));
            curve.y.push_back(y / static_cast<double>(end - begin));
        }
    }
    return curve;
}

}  // namespace

std::vector<core::Figure> heave_figures(const HeaveExperiment& experiment, const HeaveNoise& noise,
                                        const std::vector<dynamics::EffectUse>& uses, const Discovery& result) {
    core::Figure over_gap;
    over_gap.title = "Residual force against gap";
    over_gap.x = {"gap", "mm", 0, 0, false};
    over_gap.y = {"residual force", "mN", 0, 0, false};
    over_gap.caption = "Force that must be added for the measured motion, smoothed with the model inside the loop; means in bins.";
    core::Figure over_velocity = over_gap;
    over_velocity.title = "Residual force against heave velocity";
    over_velocity.x = {"heave velocity", "mm/s", 0, 0, false};
    core::Figure over_time;
    over_time.title = "Residual force over time, first run";
    over_time.x = {"time", "s", 0, 0, false};
    over_time.y = {"residual force", "mN", 0, 0, false};
    over_time.caption = "The same over time. With what was found it should wander about zero.";
    HeaveNoise calm = noise;
    calm.process = 1e-9;
    for (const bool after : {false, true}) {
        if (after && uses.empty()) {
            continue;
        }
        std::vector<std::pair<double, double>> gap, velocity;
        const core::Colour colour = after ? core::palette(0) : core::Colour{170, 170, 170, 255};
        const std::string name = after ? "with what was found" : "as declared";
        for (const std::size_t r : experiment.chosen()) {
            const HeaveRecord& record = experiment.records().records[r];
            const SmoothedRun run = smooth_with_force(record, experiment.explanation(r, after ? uses : std::vector<dynamics::EffectUse>{}), calm,
                                                      0.001 * record.plant->terms.mass);
            for (std::size_t k = 10; k + 10 < run.time.size(); ++k) {
                gap.emplace_back(1000 * run.gap[k], 1000 * run.force[k]);
                velocity.emplace_back(1000 * run.velocity[k], 1000 * run.force[k]);
            }
            if (r == experiment.chosen().front()) {
                core::FigureCurve curve;
                curve.name = name;
                curve.colour = colour;
                curve.x = run.time;
                for (const double force : run.force) {
                    curve.y.push_back(1000 * force);
                }
                over_time.curves.push_back(std::move(curve));
            }
        }
        over_gap.curves.push_back(binned_mean(std::move(gap), name, colour));
        over_velocity.curves.push_back(binned_mean(std::move(velocity), name, colour));
    }
    return {over_gap, over_velocity, over_time, probability_figure(result), error_figure(result)};
}

}  // namespace underbody::discovery
