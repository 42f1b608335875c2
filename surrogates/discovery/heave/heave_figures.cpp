#include "surrogates/discovery/heave/heave_figures.h"

#include <algorithm>
#include <cmath>

#include "surrogates/discovery/static/static_figures.h"

namespace underbody::discovery {

namespace {

/// Mean of y in bins of x, as a curve.
core::FigureCurve binned_mean(std::vector<std::pair<double, double>> points, const std::string& name,
                              core::Colour colour) {
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

/// Amplitude of a force at some frequencies (Hann window over each run, mean square over runs), mN.
class Spectrum {
public:
    Spectrum() : power_(frequencies().size(), 0) {}

    static const std::vector<double>& frequencies() {
        static const std::vector<double> list = [] {
            std::vector<double> made;
            for (double f = 0.04; f < 5; f *= 1.09) {
                made.push_back(f);
            }
            return made;
        }();
        return list;
    }

    void add(const std::vector<double>& time, const std::vector<double>& force) {
        constexpr double two_pi = 6.283185307179586;
        const double begin = time.front();
        const double length = time.back() - begin;
        for (std::size_t f = 0; f < power_.size(); ++f) {
            double s = 0;
            double c = 0;
            double weight = 0;
            for (std::size_t k = 0; k < time.size(); ++k) {
                const double window = 1 - std::cos(two_pi * (time[k] - begin) / length);
                s += window * force[k] * std::sin(two_pi * frequencies()[f] * time[k]);
                c += window * force[k] * std::cos(two_pi * frequencies()[f] * time[k]);
                weight += window;
            }
            power_[f] += 4e6 * (s * s + c * c) / (weight * weight);
        }
        ++runs_;
    }

    [[nodiscard]] core::FigureCurve curve(const std::string& name, core::Colour colour) const {
        core::FigureCurve result;
        result.name = name;
        result.colour = colour;
        result.x = frequencies();
        for (const double power : power_) {
            result.y.push_back(std::sqrt(power / std::max(runs_, 1)));
        }
        return result;
    }

private:
    std::vector<double> power_;
    int runs_ = 0;
};

}  // namespace

std::vector<core::Figure> heave_figures(const HeaveExperiment& experiment, const HeaveNoise& noise,
                                        const std::vector<dynamics::EffectUse>& uses, const Discovery& result) {
    core::Figure over_gap;
    over_gap.title = "Residual force against gap";
    over_gap.x = {"gap", "mm", 0, 0, false};
    over_gap.y = {"residual force", "mN", 0, 0, false};
    over_gap.caption =
        "Force that must be added for the measured motion, smoothed with the model inside the loop; means in bins.";
    core::Figure over_velocity = over_gap;
    over_velocity.title = "Residual force against heave velocity";
    over_velocity.x = {"heave velocity", "mm/s", 0, 0, false};
    core::Figure over_time;
    over_time.title = "Residual force over time, first run";
    over_time.x = {"time", "s", 0, 0, false};
    over_time.y = {"residual force", "mN", 0, 0, false};
    over_time.caption = "The same over time. With what was found it should wander about zero.";
    core::Figure over_frequency;
    over_frequency.title = "Residual force over frequency";
    over_frequency.x = {"frequency", "Hz", 0, 0, true};
    over_frequency.y = {"amplitude", "mN", 0, 0, false};
    over_frequency.caption =
        "Amplitude of the smoothed residual force, root of the mean square over the runs. A peak is a periodic force, "
        "much at the "
        "left a slow or constant one.";
    HeaveNoise calm = noise;
    calm.process = 1e-9;
    for (const bool after : {false, true}) {
        if (after && uses.empty()) {
            continue;
        }
        std::vector<std::pair<double, double>> gap, velocity;
        Spectrum spectrum;
        const core::Colour colour = after ? core::palette(0) : core::Colour{170, 170, 170, 255};
        const std::string name = after ? "with what was found" : "as declared";
        for (const std::size_t r : experiment.chosen()) {
            const HeaveRecord& record = experiment.records().records[r];
            const SmoothedRun run =
                smooth_with_force(record, experiment.explanation(r, after ? uses : std::vector<dynamics::EffectUse>{}),
                                  calm, 0.001 * record.plant->terms.mass);
            spectrum.add(run.time, run.force);
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
        over_frequency.curves.push_back(spectrum.curve(name, colour));
        over_gap.curves.push_back(binned_mean(std::move(gap), name, colour));
        over_velocity.curves.push_back(binned_mean(std::move(velocity), name, colour));
    }
    return {over_gap, over_velocity, over_time, over_frequency, probability_figure(result), error_figure(result)};
}

}  // namespace underbody::discovery
