#include "surrogates/discovery/heave_experiment.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/text.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr double process_floor = 1e-12;   ///< m^2/s^3: below it nothing changes any more
constexpr double process_ceiling = 1e-2;
constexpr double two_pi = 6.283185307179586;

double sum_of_squares(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) {
        sum += value * value;
    }
    return sum;
}

}  // namespace

const char* variable_name(FlexibleForce::Variable variable) {
    switch (variable) {
        case FlexibleForce::Variable::gap:
            return "gap";
        case FlexibleForce::Variable::heave_velocity:
            return "heave_velocity";
        case FlexibleForce::Variable::time:
            return "time";
        default:
            return "input_force";
    }
}

HeaveExperiment::HeaveExperiment(const dynamics::Model& model, const HeaveRecords& records, std::vector<std::size_t> chosen,
                                 std::optional<double> declared_gap_noise, std::optional<double> declared_velocity_noise)
    : model_(model), records_(records), chosen_(std::move(chosen)) {
    for (const HeaveRecord& record : records_.records) {
        dynamics::HeaveTerms terms = record.plant->terms;
        terms.sources.clear();
        bare_.push_back(std::move(terms));
    }
    const auto choose = [&](const char* channel, std::optional<double> declared, double estimated, std::string& from) {
        if (!declared || !(estimated > 0)) {
            from = declared ? "declared" : "estimated";
            return declared.value_or(estimated > 0 ? estimated : 1e-6);
        }
        const double ratio = estimated / *declared;
        if (ratio > 0.88 && ratio < 1.14) {
            from = "declared";
            return *declared;
        }
        from = "estimated: the scatter from reading to reading is " + core::format_number(ratio, 3) + " times the declared figure";
        problems_.push_back({core::Problem::Severity::warning,
                             std::string("the declared noise of ") + channel + " (" + core::format_number(*declared, 3) +
                                 ") disagrees with the scatter from reading to reading (" + core::format_number(estimated, 3) +
                                 "): the figure is wrong or the noise is coloured; the scatter is used",
                             {}});
        return estimated;
    };
    noise_.gap = choose("gap", declared_gap_noise, records_.gap_noise, gap_from_);
    if (records_.velocity_measured) {
        noise_.velocity = choose("heave_velocity", declared_velocity_noise, records_.velocity_noise, velocity_from_);
    }
    for (const dynamics::ForceSource& source : model_.forces) {
        if (source.quantity == "lift_force") {
            declared_factor_ = source.factor;
            break;
        }
    }
}

std::size_t HeaveExperiment::readings() const {
    std::size_t count = 0;
    for (const std::size_t r : chosen_) {
        for (const double value : records_.records[r].gap) {
            count += std::isfinite(value) ? 1 : 0;
        }
        for (const double value : records_.records[r].velocity) {
            count += std::isfinite(value) ? 1 : 0;
        }
    }
    return count;
}

HeaveExplanation HeaveExperiment::explanation(std::size_t record, const std::vector<dynamics::EffectUse>& uses,
                                              const FlexibleForce* flexible) const {
    HeaveExplanation result;
    result.terms = bare_[record];
    for (const dynamics::EffectUse& use : uses) {
        if (use.name == "declared_parameter") {
            result.lift_gain *= use.values[0] / declared_factor_;
        } else {
            dynamics::effect(use.name).add_to(result.terms, use, model_);
        }
    }
    result.flexible = flexible;
    result.hold = hold_;
    return result;
}

double HeaveExperiment::evaluate(const std::vector<dynamics::EffectUse>& uses, const FlexibleForce* flexible, const HeaveNoise& noise,
                                 std::vector<double>& innovations, std::vector<double>* by_record) const {
    innovations.clear();
    double cost = 0;
    for (const std::size_t r : chosen_) {
        const std::size_t begin = innovations.size();
        double own = filter_innovations(records_.records[r], explanation(r, uses, flexible), noise, innovations);
        for (std::size_t i = begin; i < innovations.size(); ++i) {
            own += innovations[i] * innovations[i];
        }
        if (by_record != nullptr) {
            by_record->push_back(own);
        }
        cost += own;
    }
    return std::isfinite(cost) ? cost : 1e300;
}

double HeaveExperiment::fit_process(const std::vector<dynamics::EffectUse>& uses, HeaveNoise& noise) const {
    std::vector<double> innovations;
    const auto at = [&](double log_process) {
        HeaveNoise trial = noise;
        trial.process = std::pow(10.0, log_process);
        return evaluate(uses, nullptr, trial, innovations);
    };
    double best = 1e300;
    double place = 0;
    for (double x = std::log10(process_floor); x <= std::log10(process_ceiling); x += 1) {
        const double cost = at(x);
        if (cost < best) {
            best = cost;
            place = x;
        }
    }
    for (double step = 0.5; step > 0.1; step *= 0.5) {
        for (const double x : {place - step, place + step}) {
            const double cost = x >= std::log10(process_floor) ? at(x) : 1e300;
            if (cost < best) {
                best = cost;
                place = x;
                break;
            }
        }
    }
    noise.process = std::pow(10.0, place);
    return best;
}

bool HeaveExperiment::fit_noise(const std::vector<dynamics::EffectUse>& uses, HeaveNoise& noise) const {
    std::vector<double> innovations;
    HeaveNoise best_noise = noise;
    best_noise.slow = 0;
    const double white_only = evaluate(uses, nullptr, best_noise, innovations);
    double best = white_only;
    const auto attempt = [&](const HeaveNoise& trial) {
        const double cost = evaluate(uses, nullptr, trial, innovations);
        if (cost < best) {
            best = cost;
            best_noise = trial;
            return true;
        }
        return false;
    };
    for (const double time : {0.08, 0.3, 1.0}) {
        for (const double size : {0.4, 1.0, 2.0}) {
            HeaveNoise trial = noise;
            trial.slow = size * noise.gap;
            trial.slow_time = time;
            for (const double share : {1.0, 1e-2, 1e-4, 1e-7}) {
                trial.process = std::max(process_floor, noise.process * share);
                attempt(trial);
            }
        }
    }
    if (white_only - best < 25) {
        noise.slow = 0;
        return false;
    }
    for (double factor = 3; factor > 1.1; factor = std::sqrt(factor)) {
        for (int round = 0; round < 2; ++round) {
            for (double HeaveNoise::*number : {&HeaveNoise::slow, &HeaveNoise::slow_time, &HeaveNoise::process, &HeaveNoise::gap}) {
                for (const double f : {factor, 1 / factor}) {
                    HeaveNoise trial = best_noise;
                    trial.*number *= f;
                    trial.slow_time = std::clamp(trial.slow_time, 0.02, 2.0);
                    trial.process = std::max(trial.process, process_floor);
                    if (attempt(trial)) {
                        break;
                    }
                }
            }
        }
    }
    noise = best_noise;
    return true;
}

HeaveExperiment::Result HeaveExperiment::fit(const Hypothesis& hypothesis, const HeaveNoise& begin) const {
    HeaveNoise noise = begin;
    const WhitenedResiduals residuals = [&](std::span<const double> p, std::vector<double>& r) {
        const double cost = evaluate(hypothesis.with(p), nullptr, noise, r);
        return cost - sum_of_squares(r);
    };
    std::vector<std::vector<double>> starts = hypothesis.starts;
    if (starts.empty()) {
        starts.emplace_back();
        for (const FitParameter& parameter : hypothesis.parameters) {
            starts.back().push_back(parameter.start);
        }
    }
    std::vector<FitParameter> parameters = hypothesis.parameters;
    const auto run = [&](const std::vector<double>& start, int iterations) {
        for (std::size_t j = 0; j < parameters.size(); ++j) {
            parameters[j].start = start[j];
        }
        return least_squares(parameters, residuals, {iterations, 0.05, 0});
    };
    Fit best;
    HeaveNoise best_noise = noise;
    bool first = true;
    for (const std::vector<double>& start : starts) {
        Fit fit = run(start, 4);
        if (first || fit.cost < best.cost) {
            best = std::move(fit);
            first = false;
        }
    }
    for (double factor = 0.1; noise.process > process_floor;) {
        noise.process = std::max(process_floor, noise.process * factor);
        Fit fit = run(best.parameters, 5);
        if (!(fit.cost < best.cost)) {
            if (factor < 0.2) {
                factor = 0.32;   // once more with half the step before giving up
                noise.process = best_noise.process;
                continue;
            }
            break;
        }
        const bool slow = best.cost - fit.cost < 0.2;
        best = std::move(fit);
        best_noise = noise;
        if (slow) {
            break;
        }
    }
    noise = best_noise;
    if (noise.process == begin.process) {
        best = run(best.parameters, 8);
    }
    Result result;
    result.noise = best_noise;
    result.fitted.hypothesis = hypothesis;
    result.fitted.fit = std::move(best);
    result.fitted.cost = result.fitted.fit.cost;
    result.fitted.occam = occam_factor(hypothesis, readings());
    std::vector<double> innovations;
    evaluate(hypothesis.with(result.fitted.fit.parameters), nullptr, best_noise, innovations, &result.fitted.cost_of_group);
    return result;
}

HeaveExperiment::Smooth HeaveExperiment::fit_smooth(const std::vector<FlexibleForce::Variable>& variables,
                                                    const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& begin,
                                                    double base_cost) const {
    Smooth result;
    FlexibleForce& force = result.force;
    force.variables = variables;
    std::vector<std::vector<double>> values(variables.size());
    std::vector<double> innovations;
    for (const std::size_t r : chosen_) {
        const HeaveRecord& record = records_.records[r];
        const HeaveExplanation declared = explanation(r, uses);
        std::vector<double> states;
        filter_innovations(record, declared, begin, innovations, &states);
        std::vector<double> input;
        transform_input(record, declared, input);
        for (std::size_t k = 5; k < record.time.size(); k += 5) {
            for (std::size_t v = 0; v < variables.size(); ++v) {
                values[v].push_back(variables[v] == FlexibleForce::Variable::gap              ? states[2 * k]
                                    : variables[v] == FlexibleForce::Variable::heave_velocity ? states[2 * k + 1]
                                    : variables[v] == FlexibleForce::Variable::time           ? record.time[k]
                                                                                              : input[k]);
            }
        }
    }
    for (std::vector<double>& variable : values) {
        const double low = quantile(variable, 0.002);
        const double high = quantile(variable, 0.998);
        for (double& value : variable) {
            value = std::clamp(value, low, high);
        }
        force.lower.push_back(low);
        force.upper.push_back(high);
        result.fit.variables.emplace_back();
    }
    for (std::size_t v = 0; v < variables.size(); ++v) {
        result.fit.variables[v] = variable_name(variables[v]);
    }
    force.basis = FlexibleBasis(values, variables.size() == 1 ? 6 : 3);
    force.coefficients.assign(force.basis.columns(), 0);
    std::vector<FitParameter> parameters;
    for (std::size_t k = 0; k < force.coefficients.size(); ++k) {
        parameters.push_back({"c" + std::to_string(k), "N", -10, 10, 0, 0.003});
    }
    HeaveNoise noise = begin;
    FlexibleForce trial = force;
    const WhitenedResiduals residuals = [&](std::span<const double> p, std::vector<double>& r) {
        trial.coefficients.assign(p.begin(), p.end());
        return evaluate(uses, &trial, noise, r) - sum_of_squares(r);
    };
    Fit best = least_squares(parameters, residuals, {3, 0.5, 0.05});
    HeaveNoise best_noise = noise;
    while (noise.process > process_floor) {
        noise.process = std::max(process_floor, noise.process * 0.1);
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            parameters[k].start = best.parameters[k];
        }
        Fit fit = least_squares(parameters, residuals, {2, 0.5, 0.05});
        if (!(fit.cost < best.cost - 0.5)) {
            break;
        }
        best = std::move(fit);
        best_noise = noise;
    }
    force.coefficients = best.parameters;
    result.noise = best_noise;
    result.fit.gain = base_cost - best.cost;
    result.fit.degrees = static_cast<double>(force.coefficients.size());
    result.fit.p = chi_squared_tail(result.fit.gain, result.fit.degrees);
    return result;
}

std::vector<std::vector<double>> HeaveExperiment::periodic_starts(const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise,
                                                                  std::size_t count) const {
    // The innovations answer a small force as a linear system: one run each for sine and cosine at every frequency.
    std::vector<double> base;
    evaluate(uses, nullptr, noise, base);
    struct Line {
        double frequency, gain, amplitude, phase;
    };
    std::vector<Line> lines;
    std::vector<double> moved;
    constexpr double small = 1e-4;
    for (double frequency = 0.03; frequency < 4; frequency *= 1.045) {
        std::vector<double> answer[2];
        for (int part = 0; part < 2; ++part) {
            std::vector<dynamics::EffectUse> with = uses;
            with.push_back(dynamics::make_use("periodic_disturbance", {{"amplitude", small, 0},
                                                                       {"frequency", frequency, 0},
                                                                       {"phase", part == 0 ? 0.0 : 0.25 * two_pi, 0}}));
            evaluate(with, nullptr, noise, moved);
            answer[part].resize(base.size());
            for (std::size_t i = 0; i < base.size(); ++i) {
                answer[part][i] = (base[i] - moved[i]) / small;
            }
        }
        double ss = 0, sc = 0, cc = 0, s = 0, c = 0;
        for (std::size_t i = 0; i < base.size(); ++i) {
            ss += answer[0][i] * answer[0][i];
            sc += answer[0][i] * answer[1][i];
            cc += answer[1][i] * answer[1][i];
            s += answer[0][i] * base[i];
            c += answer[1][i] * base[i];
        }
        const double determinant = ss * cc - sc * sc;
        if (determinant > 1e-12 * ss * cc) {
            const double a = (cc * s - sc * c) / determinant;   // of the sine
            const double b = (ss * c - sc * s) / determinant;   // of the cosine
            lines.push_back({frequency, a * s + b * c, std::hypot(a, b), std::atan2(b, a)});
        }
    }
    std::vector<Line> peaks;
    for (std::size_t k = 0; k < lines.size(); ++k) {
        if ((k == 0 || lines[k].gain >= lines[k - 1].gain) && (k + 1 == lines.size() || lines[k].gain > lines[k + 1].gain)) {
            peaks.push_back(lines[k]);
        }
    }
    std::sort(peaks.begin(), peaks.end(), [](const Line& a, const Line& b) { return a.gain > b.gain; });
    std::vector<std::vector<double>> starts;
    for (std::size_t k = 0; k < peaks.size() && k < count; ++k) {
        starts.push_back({std::clamp(peaks[k].amplitude, 1e-4, 1.0), peaks[k].frequency, peaks[k].phase});
    }
    return starts;
}

}  // namespace underbody::discovery
