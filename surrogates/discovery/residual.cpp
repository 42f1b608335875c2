#include "surrogates/discovery/residual.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/heave/heave_filter.h"
#include "surrogates/discovery/motion/motion_experiment.h"
#include "surrogates/discovery/static/static_experiment.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/motion_predict.h"

namespace underbody::discovery {

namespace {

constexpr double least_noise = 1e-7;  ///< m, m/s: of a sensor; less makes weights that mean nothing

/// Bins of equal numbers of values. `correlated`: how many neighbouring values tell one story.
ResidualCurve binned(const std::string& variable, const std::vector<double>& x, const std::vector<double>& y,
                     std::size_t bins, double correlated) {
    ResidualCurve curve;
    curve.variable = variable;
    const core::QuantityName* quantity = core::find_quantity(variable);
    curve.unit = quantity != nullptr ? quantity->unit : "1";
    std::vector<std::size_t> order(x.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
    bins = std::max<std::size_t>(1, std::min(bins, x.size() / 4));
    for (std::size_t b = 0; b < bins; ++b) {
        const std::size_t begin = b * x.size() / bins;
        const std::size_t end = (b + 1) * x.size() / bins;
        double sum = 0;
        double square = 0;
        double place = 0;
        for (std::size_t k = begin; k < end; ++k) {
            sum += y[order[k]];
            square += y[order[k]] * y[order[k]];
            place += x[order[k]];
        }
        const double n = static_cast<double>(end - begin);
        const double mean_value = sum / n;
        const double spread = std::sqrt(std::max(0.0, square / n - mean_value * mean_value));
        curve.centre.push_back(place / n);
        curve.mean.push_back(mean_value);
        curve.spread.push_back(spread);
        curve.mean_sigma.push_back(spread / std::sqrt(std::max(1.0, n / correlated)));
        curve.count.push_back(end - begin);
    }
    return curve;
}

core::Figure picture(const Residual& residual, const ResidualCurve& curve) {
    core::Figure figure;
    const bool gap = curve.variable == "gap";
    const double factor = gap ? 1000 : 1;
    const bool turns = residual.quantity.ends_with("moment");
    figure.title = std::string(turns ? "Residual moment against " : "Residual force against ") + curve.variable;
    figure.x = {curve.variable, gap ? "mm" : curve.unit, 0, 0, false};
    figure.y = {turns ? "residual moment" : "residual force", turns ? "mN m" : "mN", 0, 0, false};
    core::FigureBand band;
    band.name = "spread";
    core::FigureCurve mean_curve;
    mean_curve.name = "mean";
    mean_curve.colour = core::palette(0);
    for (std::size_t k = 0; k < curve.centre.size(); ++k) {
        const double x = factor * curve.centre[k];
        band.x.push_back(x);
        band.lower.push_back(1000 * (curve.mean[k] - curve.spread[k]));
        band.upper.push_back(1000 * (curve.mean[k] + curve.spread[k]));
        mean_curve.x.push_back(x);
        mean_curve.y.push_back(1000 * curve.mean[k]);
    }
    figure.bands.push_back(std::move(band));
    figure.curves.push_back(std::move(mean_curve));
    figure.lines.push_back({false, 0, "", {120, 120, 120, 255}, true});
    figure.caption = "What must be added to the declared model for the measured " + residual.quantity +
                     ": mean and spread in bins of equal numbers. Zero: the model says it all.";
    return figure;
}

core::Figure over_time_figure(core::FigureCurve curve, double sigma) {
    core::Figure figure;
    figure.title = "Residual force over time, " + curve.name;
    figure.x = {"time", "s", 0, 0, false};
    figure.y = {"residual force", "mN", 0, 0, false};
    figure.caption = "Smoothed with the model inside the loop; one standard deviation of noise that gets through is " +
                     core::format_number(1000 * sigma, 2) + " mN.";
    curve.colour = core::palette(0);
    figure.curves.push_back(std::move(curve));
    return figure;
}

std::vector<Residual> heave_residual(const dynamics::Model& model, const dynamics::Measurements& data,
                                     core::Progress& progress) {
    const HeaveRecords records = prepare_heave_records(model, data);
    Residual residual;
    residual.quantity = "lift_force";
    residual.problems = records.problems;
    HeaveNoise noise;
    noise.gap = data.declared_noise("gap").value_or(std::max(records.gap_noise, least_noise));
    noise.velocity = data.declared_noise("heave_velocity").value_or(std::max(records.velocity_noise, least_noise));
    std::vector<double> gap, velocity, force;
    double variance = 0;
    core::FigureCurve over_time;
    for (const HeaveRecord& record : records.records) {
        progress.check();
        HeaveExplanation declared;
        declared.terms = record.plant->terms;
        const SmoothedRun run = smooth_with_force(record, declared, noise, 0.004 * record.plant->terms.mass / 4);
        if (over_time.x.empty()) {
            over_time.name = record.name;
            over_time.x = run.time;
            for (const double f : run.force) {
                over_time.y.push_back(1000 * f);
            }
        }
        for (std::size_t k = 0; k < run.time.size(); ++k) {
            gap.push_back(run.gap[k]);
            velocity.push_back(run.velocity[k]);
            force.push_back(run.force[k]);
            variance += run.force_sigma[k] * run.force_sigma[k];
        }
    }
    residual.mean = mean(force);
    residual.root_mean_square = root_mean_square(force);
    residual.sigma = std::sqrt(variance / static_cast<double>(force.size()));
    const double correlated = 2 / record_step;  // the smoothed force changes over seconds
    residual.curves.push_back(binned("gap", gap, force, 24, correlated));
    residual.curves.push_back(binned("heave_velocity", velocity, force, 24, correlated));
    for (const ResidualCurve& curve : residual.curves) {
        residual.figures.push_back(picture(residual, curve));
    }
    residual.figures.push_back(over_time_figure(std::move(over_time), residual.sigma));
    return {residual};
}

/// The loads of a coupled motion, smoothed together.
std::vector<Residual> motion_residual(const dynamics::Motion& motion, const dynamics::Model& model,
                                      const dynamics::Measurements& data, core::Progress& progress) {
    const dynamics::MotionShape& shape = motion.shape();
    std::vector<std::size_t> all(data.runs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    core::Problems problems;
    std::vector<std::vector<double>> states(shape.states.size()), loads(shape.loads.size()), sigmas(shape.loads.size());
    for (const MotionRecord& record : motion_records(motion, model, data, all, problems)) {
        progress.check();
        const auto run = motion.run(model, data.runs[record.run], model.records);
        MotionNoise noise;
        noise.white = dynamics::motion_noise(shape, data, data.runs[record.run]);
        walk_of_loads(*run, noise);
        const SmoothedMotion smoothed = smooth_motion(*run, record, noise);
        for (std::size_t k = 0; k < smoothed.time.size(); ++k) {
            for (std::size_t i = 0; i < states.size(); ++i) {
                states[i].push_back(smoothed.state[k][i]);
            }
            for (std::size_t l = 0; l < loads.size(); ++l) {
                loads[l].push_back(smoothed.load[k][l]);
                sigmas[l].push_back(smoothed.load_sigma[k][l]);
            }
        }
    }
    const std::vector<double>& time = data.runs.front().table.numbers("time");
    const double rate = static_cast<double>(time.size()) / std::max(time.back() - time.front(), 1e-9);
    std::vector<Residual> list(shape.loads.size());
    for (std::size_t l = 0; l < list.size(); ++l) {
        Residual& residual = list[l];
        residual.quantity = shape.loads[l].quantity;
        residual.problems = problems;
        residual.mean = mean(loads[l]);
        residual.root_mean_square = root_mean_square(loads[l]);
        residual.sigma = root_mean_square(sigmas[l]);
        for (const dynamics::MotionShape::Variable& one : shape.variables) {
            residual.curves.push_back(binned(one.quantity, states[one.state], loads[l], 24, 2 * rate));
            residual.figures.push_back(picture(residual, residual.curves.back()));
        }
    }
    return list;
}

std::vector<Residual> static_residual(const dynamics::Model& model, const dynamics::Measurements& data) {
    StaticExperiment experiment(model, data);
    experiment.estimate_noise();
    std::vector<Residual> list;
    for (std::size_t q = 0; q < experiment.quantities().size(); ++q) {
        Residual residual;
        residual.quantity = experiment.quantities()[q];
        residual.problems = experiment.problems();
        std::vector<double> force;
        std::vector<const Observation*> own;
        for (const Observation& one : experiment.observations()) {
            if (one.quantity == q) {
                own.push_back(&one);
                force.push_back(one.value - experiment.predict(one, {}));
                residual.sigma = experiment.sigma(one);
            }
        }
        residual.mean = mean(force);
        residual.root_mean_square = root_mean_square(force);
        for (const dynamics::Channel channel : experiment.varying()) {
            std::vector<double> x;
            for (const Observation* one : own) {
                x.push_back(one->at[channel]);
            }
            residual.curves.push_back(binned(dynamics::channel_name(channel), x, force, 12, 1));
            residual.figures.push_back(picture(residual, residual.curves.back()));
        }
        list.push_back(std::move(residual));
    }
    return list;
}

}  // namespace

std::vector<Residual> measured_residual(const dynamics::Model& model, const dynamics::Measurements& data,
                                        core::Progress& progress) {
    const dynamics::Motion* const motion = dynamics::motion_of(model, data);
    return data.kind == dynamics::MeasurementKind::steady ? static_residual(model, data)
           : motion != nullptr                            ? motion_residual(*motion, model, data, progress)
                                                          : heave_residual(model, data, progress);
}

nlohmann::json json_of(const core::Problems& problems) {
    nlohmann::json all = nlohmann::json::array();
    for (const core::Problem& problem : problems) {
        const bool note = problem.severity == core::Problem::Severity::note;
        all.push_back(
            {{"severity", note ? "note" : "warning"}, {"message", problem.message}, {"place", problem.place.text()}});
    }
    return all;
}

nlohmann::json to_json(const Residual& residual) {
    nlohmann::json curves = nlohmann::json::array();
    for (const ResidualCurve& curve : residual.curves) {
        curves.push_back({{"variable", curve.variable},
                          {"unit", curve.unit},
                          {"centre", curve.centre},
                          {"mean", curve.mean},
                          {"spread", curve.spread},
                          {"mean_sigma", curve.mean_sigma},
                          {"count", curve.count}});
    }
    return {{"quantity", residual.quantity}, {"mean", residual.mean}, {"rms", residual.root_mean_square},
            {"sigma", residual.sigma},       {"curves", curves},      {"problems", json_of(residual.problems)}};
}

}  // namespace underbody::discovery
