#include "surrogates/discovery/heave/heave_figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
        constexpr double two_pi = 2 * std::numbers::pi;
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

core::Figure frame(const std::string& title, const core::FigureAxis& x, const std::string& y,
                   const std::string& caption) {
    core::Figure figure;
    figure.title = title;
    figure.x = x;
    figure.y = {y, "mN", 0, 0, false};
    figure.caption = caption;
    return figure;
}

/// The residual force against what it may hang on.
class ForceFigures {
public:
    ForceFigures(const HeaveExperiment& experiment, const HeaveNoise& noise) : experiment_(experiment), calm_(noise) {
        calm_.process = 1e-9;
    }

    /// Of a model with these effects.
    void add(const std::vector<dynamics::EffectUse>& uses, const std::string& name, core::Colour colour) {
        std::vector<std::pair<double, double>> gap, velocity;
        Spectrum spectrum;
        for (const std::size_t r : experiment_.chosen()) {
            const HeaveRecord& record = experiment_.records().records[r];
            const SmoothedRun run = smooth_with_force(record, experiment_.explanation(r, uses), calm_,
                                                      usual_force_walk * record.plant->terms.mass);
            spectrum.add(run.time, run.force);
            for (std::size_t k = 10; k + 10 < run.time.size(); ++k) {
                gap.emplace_back(1000 * run.gap[k], 1000 * run.force[k]);
                velocity.emplace_back(1000 * run.velocity[k], 1000 * run.force[k]);
            }
            if (r == experiment_.chosen().front()) {
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

    core::Figure over_gap = frame("Residual force against gap", {"gap", "mm", 0, 0, false}, "residual force", smoothed);
    core::Figure over_velocity = frame("Residual force against heave velocity", {"heave velocity", "mm/s", 0, 0, false},
                                       "residual force", smoothed);
    core::Figure over_time = frame("Residual force over time, first run", {"time", "s", 0, 0, false}, "residual force",
                                   "The same over time. With what was found it should wander about zero.");
    core::Figure over_frequency =
        frame("Residual force over frequency", {"frequency", "Hz", 0, 0, true}, "amplitude",
              "Amplitude of the smoothed residual force, root of the mean square over the runs. A peak is a periodic "
              "force, much at the left a slow or constant one.");

private:
    static constexpr const char* smoothed =
        "Force that must be added for the measured motion, smoothed with the model inside the loop; means in bins.";
    const HeaveExperiment& experiment_;
    HeaveNoise calm_;
};

}  // namespace

std::vector<core::Figure> heave_figures(const HeaveExperiment& experiment, const HeaveNoise& noise,
                                        const std::vector<dynamics::EffectUse>& uses, const Discovery& result) {
    ForceFigures force(experiment, noise);
    force.add({}, "as declared", {170, 170, 170, 255});
    if (!uses.empty()) {
        force.add(uses, "with what was found", core::palette(0));
    }
    return {force.over_gap,       force.over_velocity,        force.over_time,
            force.over_frequency, probability_figure(result), error_figure(result)};
}

}  // namespace underbody::discovery
