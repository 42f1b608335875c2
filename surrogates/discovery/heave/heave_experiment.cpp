#include "surrogates/discovery/heave/heave_experiment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/text.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::discovery {

namespace {

constexpr double process_floor = 1e-12;  ///< m^2/s^3: below it nothing changes any more
constexpr double process_ceiling = 1e-2;
constexpr double small_force = 0.003;  ///< N, of a smooth correction: scale of its coefficients
constexpr double not_seen = 0.002;     ///< share of the states at either end beyond which a correction is constant
constexpr double smooth_ridge = 0.5;   ///< their prior: a standard deviation of 1.4 times that scale

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

HeaveExperiment::HeaveExperiment(const dynamics::Model& model, const HeaveRecords& records,
                                 std::vector<std::size_t> chosen, std::optional<double> declared_gap_noise,
                                 std::optional<double> declared_velocity_noise)
    : model_(model), records_(records), chosen_(std::move(chosen)) {
    for (const HeaveRecord& record : records_.records) {
        bare_.push_back(record.plant->terms);
    }
    const auto choose = [&](const char* channel, std::optional<double> declared, double estimated, std::string& from) {
        const dynamics::JudgedNoise judged = dynamics::judged_noise(channel, declared, estimated);
        from = judged.from;
        if (!judged.doubt.empty()) {
            problems_.push_back({core::Problem::Severity::warning, judged.doubt, {}});
        }
        return judged.value;
    };
    noise_.gap = choose("gap", declared_gap_noise, records_.gap_noise, gap_from_);
    if (records_.velocity_measured) {
        noise_.velocity = choose("heave_velocity", declared_velocity_noise, records_.velocity_noise, velocity_from_);
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
        if (!use.parameter.empty()) {
            result.lift_gain *= lift_gain_of(use, record);
        } else {
            dynamics::effect(use.name).add_to(result.terms, use, model_);
        }
    }
    result.flexible = flexible;
    result.hold = hold_;
    return result;
}

double HeaveExperiment::lift_gain_of(const dynamics::EffectUse& use, std::size_t record) const {
    for (std::size_t k = 0; k < model_.forces.size(); ++k) {
        const dynamics::ForceSource& source = model_.forces[k];
        const std::string prefix = "force." + std::to_string(k + 1) + ".";
        if (use.parameter == prefix + "factor") {
            return use.values[0] / source.factor;
        }
        for (const dynamics::ForceScale& scale : source.scales) {
            if (use.parameter == prefix + "scale." + dynamics::channel_name(scale.channel) + ".exponent") {
                const double held = records_.records[record].plant->held().get(scale.channel, scale.reference);
                return dynamics::scale_factor(scale.reference, use.values[0] - scale.exponent, scale.dead_band, held);
            }
        }
    }
    return 1;
}

double HeaveExperiment::cost_of(std::size_t record, const std::vector<dynamics::EffectUse>& uses,
                                const FlexibleForce* flexible, const HeaveNoise& noise,
                                std::vector<double>& innovations) const {
    const std::size_t begin = innovations.size();
    double cost = filter_innovations(records_.records[record], explanation(record, uses, flexible), noise, innovations);
    for (std::size_t i = begin; i < innovations.size(); ++i) {
        cost += innovations[i] * innovations[i];
    }
    return cost;
}

double HeaveExperiment::evaluate(const std::vector<dynamics::EffectUse>& uses, const FlexibleForce* flexible,
                                 const HeaveNoise& noise, std::vector<double>& innovations,
                                 std::vector<double>* by_record) const {
    innovations.clear();
    double cost = 0;
    for (const std::size_t r : chosen_) {
        const double own = cost_of(r, uses, flexible, noise, innovations);
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

bool HeaveExperiment::fit_noise(const std::vector<dynamics::EffectUse>& uses, HeaveNoise& noise,
                                double colour_gain) const {
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
    // A noise that was fitted before stands for choice too: its white part may be next to nothing, and the sizes below
    // are shares of that.
    if (noise.slow > 0) {
        attempt(noise);
    }
    // coloured noise leaves little scatter from reading to reading: it may be several times as large as that
    for (const double time : {0.08, 0.3, 1.0}) {
        for (const double size : {0.4, 1.0, 2.0, 4.0}) {
            for (const double white : {1.0, 0.3}) {
                HeaveNoise trial = noise;
                trial.slow = size * noise.gap;
                trial.slow_time = time;
                trial.gap = white * noise.gap;
                for (const double share : {1.0, 1e-2, 1e-4, 1e-7}) {
                    trial.process = std::max(process_floor, noise.process * share);
                    attempt(trial);
                }
            }
        }
    }
    if (white_only - best < colour_gain) {
        noise.slow = 0;
        return false;
    }
    for (double factor = 3; factor > 1.1; factor = std::sqrt(factor)) {
        for (int round = 0; round < 2; ++round) {
            for (double HeaveNoise::*number :
                 {&HeaveNoise::slow, &HeaveNoise::slow_time, &HeaveNoise::process, &HeaveNoise::gap}) {
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
        starts.push_back(hypothesis.start());
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
                factor = 0.32;  // once more with half the step before giving up
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
    evaluate(hypothesis.with(result.fitted.fit.parameters), nullptr, best_noise, innovations,
             &result.fitted.cost_of_group);
    const DesignMatrix columns = answers_inside(hypothesis, result.fitted.fit.parameters, best_noise, innovations);
    const std::vector<double>& numbers = result.fitted.fit.parameters;
    const Left left{
        hypothesis.parameters, numbers, 0,
        [&](std::size_t record, const std::vector<double>& p, const HeaveNoise& n, std::vector<double>& r) {
            return cost_of(record, hypothesis.with(p), nullptr, n, r);
        },
        [&](const HeaveNoise& n, const std::vector<double>& r) { return answers_inside(hypothesis, numbers, n, r); }};
    result.fitted.held_out = held_out_cost(left, best_noise, std::max(begin.process, best_noise.process));
    const std::vector<double> variances = grouped_variances(columns, innovations, begins());
    for (std::size_t j = 0; j < variances.size(); ++j) {
        if (variances[j] > 0) {
            result.fitted.fit.sigma[j] = std::sqrt(variances[j]) * hypothesis.parameters[j].typical;
        }
    }
    for (const dynamics::EffectUse& use : hypothesis.uses) {
        if (const auto other = dynamics::effect(use.name).info().search.other_form) {
            widen_for_form(result, other, columns, innovations);
        }
    }
    return result;
}

/// A law may have another form as well: what the numbers would be for it goes into their errors.
void HeaveExperiment::widen_for_form(Result& result, void (*other_form)(dynamics::HeaveTerms&),
                                     const DesignMatrix& columns, const std::vector<double>& innovations) const {
    const Hypothesis& hypothesis = result.fitted.hypothesis;
    std::vector<double> wider;
    for (const std::size_t r : chosen_) {
        HeaveExplanation other = explanation(r, hypothesis.with(result.fitted.fit.parameters));
        other_form(other.terms);
        filter_innovations(records_.records[r], other, result.noise, wider);
    }
    for (std::size_t i = 0; i < wider.size(); ++i) {
        wider[i] = innovations[i] - wider[i];
    }
    const std::vector<double> shift = ridge_fit(columns, wider).coefficients;
    for (std::size_t j = 0; j < shift.size(); ++j) {
        double& sigma = result.fitted.fit.sigma[j];
        sigma = std::hypot(sigma, shift[j] * hypothesis.parameters[j].typical);
    }
}

FlexibleForce HeaveExperiment::flat_force(const SmoothSet& set, const std::vector<dynamics::EffectUse>& uses,
                                          const HeaveNoise& noise) const {
    const std::vector<FlexibleForce::Variable>& variables = set.variables;
    FlexibleForce force;
    force.variables = variables;
    std::vector<std::vector<double>> values(variables.size());
    std::vector<double> innovations, states, input;
    for (const std::size_t r : chosen_) {
        const HeaveRecord& record = records_.records[r];
        const HeaveExplanation declared = explanation(r, uses);
        innovations.clear();
        states.clear();
        filter_innovations(record, declared, noise, innovations, &states);
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
        double low = quantile(variable, not_seen);
        double high = quantile(variable, 1 - not_seen);
        for (double& value : variable) {
            value = std::clamp(value, low, high);
        }
        if (!(high > low)) {  // it stood still: its table needs a range all the same
            const double range = 1e-3 * std::max(1.0, std::abs(low));
            low -= range;
            high += range;
        }
        force.lower.push_back(low);
        force.upper.push_back(high);
    }
    force.basis = FlexibleBasis(values, set.columns);
    force.coefficients.assign(force.basis.columns(), 0);
    DesignMatrix columns;
    columns.rows = values.empty() ? 1 : values.front().size();
    columns.columns = force.basis.columns();
    columns.values.resize(columns.rows * columns.columns);
    std::vector<double> point(values.size()), row(columns.columns);
    for (std::size_t i = 0; i < columns.rows; ++i) {
        for (std::size_t v = 0; v < values.size(); ++v) {
            point[v] = values[v][i];
        }
        force.basis.evaluate(point.data(), row.data());
        for (std::size_t k = 0; k < row.size(); ++k) {
            columns.at(i, k) = row[k];
        }
    }
    force.mix = orthonormal_mix(columns);
    // a law of the input goes on as a straight line where another controller asks for more, and so does a damping that
    // the gap changes; the others nobody knows there
    for (std::size_t v = 0; v < variables.size(); ++v) {
        if (variables[v] == FlexibleForce::Variable::input_force ||
            (variables[v] == FlexibleForce::Variable::heave_velocity &&
             variables.front() == FlexibleForce::Variable::gap)) {
            const double more = 0.5 * (force.upper[v] - force.lower[v]);
            force.lower[v] -= more;
            force.upper[v] += more;
        }
    }
    return force;
}

DesignMatrix HeaveExperiment::answers(const FlexibleForce& force, const std::vector<dynamics::EffectUse>& uses,
                                      const HeaveNoise& noise, const std::vector<double>& innovations) const {
    constexpr double small = 3e-6;  // N
    DesignMatrix matrix;
    matrix.rows = innovations.size();
    FlexibleForce moved = force;
    std::vector<double> there;
    for (std::size_t k = 0; k < force.coefficients.size(); ++k) {
        for (std::size_t i = 0; i <= k; ++i) {
            moved.coefficients[i] += small * force.mix[k * force.coefficients.size() + i];
        }
        evaluate(uses, &moved, noise, there);
        moved.coefficients = force.coefficients;
        ++matrix.columns;
        for (std::size_t i = 0; i < matrix.rows; ++i) {
            matrix.values.push_back((there[i] - innovations[i]) * (small_force / small));
        }
    }
    return matrix;
}

DesignMatrix HeaveExperiment::answers(const Hypothesis& hypothesis, std::span<const double> numbers,
                                      const HeaveNoise& noise, const std::vector<double>& innovations) const {
    DesignMatrix matrix;
    matrix.rows = innovations.size();
    std::vector<double> moved(numbers.begin(), numbers.end());
    std::vector<double> there;
    for (std::size_t j = 0; j < moved.size(); ++j) {
        const FitParameter& p = hypothesis.parameters[j];
        const double step = 1e-3 * p.typical * (moved[j] + 1e-3 * p.typical > p.upper ? -1 : 1);
        moved[j] = numbers[j] + step;
        evaluate(hypothesis.with(moved), nullptr, noise, there);
        moved[j] = numbers[j];
        ++matrix.columns;
        for (std::size_t i = 0; i < matrix.rows; ++i) {
            matrix.values.push_back((there[i] - innovations[i]) * (p.typical / step));
        }
    }
    return matrix;
}

std::vector<std::size_t> HeaveExperiment::begins() const {
    std::vector<std::size_t> list{0};
    for (const std::size_t r : chosen_) {
        const HeaveRecord& record = records_.records[r];
        list.push_back(list.back() + record.time.size() * (record.velocity.empty() ? 1 : 2));
    }
    return list;
}

DesignMatrix HeaveExperiment::answers_inside(const Hypothesis& hypothesis, std::span<const double> numbers,
                                             const HeaveNoise& noise, const std::vector<double>& innovations) const {
    DesignMatrix columns = answers(hypothesis, numbers, noise, innovations);
    for (std::size_t j = 0; j < columns.columns; ++j) {
        const FitParameter& p = hypothesis.parameters[j];
        if (numbers[j] - p.lower < 1e-9 * (p.upper - p.lower) || p.upper - numbers[j] < 1e-9 * (p.upper - p.lower)) {
            std::fill_n(columns.values.begin() + static_cast<std::ptrdiff_t>(j * columns.rows), columns.rows, 0.0);
        }
    }
    return columns;
}

std::vector<double> HeaveExperiment::held_out_cost(const Left& fit, HeaveNoise noise, double most_process) const {
    // A law whose form is not quite the true one needs more process noise on runs that it was not fitted to: with the
    // little that suits the fit every run would be lost to the runs' slow drift. So the process noise too is judged by
    // the runs left out.
    std::vector<double> least;
    double sum = 1e300;
    for (;;) {
        double inside = 0;
        std::vector<double> costs = held_out_at(fit, noise, inside);
        const double own = std::accumulate(costs.begin(), costs.end(), 0.0);
        if (!(own < sum)) {
            return least.empty() ? costs : least;
        }
        sum = own;
        least = std::move(costs);
        if (noise.process >= most_process || sum - inside < 5 * static_cast<double>(fit.numbers.size())) {
            return least;
        }
        noise.process = std::min(most_process, 10 * noise.process);
    }
}

std::vector<double> HeaveExperiment::held_out_at(const Left& fit, const HeaveNoise& noise, double& inside) const {
    std::vector<double> innovations, result, scratch;
    for (const std::size_t r : chosen_) {
        result.push_back(fit.cost(r, fit.numbers, noise, innovations));
    }
    const std::vector<double> by_record = result;
    inside = std::accumulate(by_record.begin(), by_record.end(), 0.0);
    if (by_record.size() < 2 || fit.numbers.empty()) {
        return result;
    }
    const auto ridge = [&](const std::vector<double>& numbers) {
        double square = 0;
        for (std::size_t j = 0; j < numbers.size(); ++j) {
            square += std::pow(numbers[j] / fit.parameters[j].typical, 2);
        }
        return fit.ridge * square;
    };
    std::vector<double> scaled;
    for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
        scaled.push_back(fit.numbers[j] / fit.parameters[j].typical);
    }
    const std::vector<std::vector<double>> moves =
        moves_without_groups(fit.answers(noise, innovations), innovations, begins(), scaled, fit.ridge);
    std::vector<double> numbers = fit.numbers;
    for (std::size_t g = 0; g < by_record.size(); ++g) {
        // laws bend: a step that the other runs do not like is no fit to them
        for (double share = 1; share > 0.05; share /= 2) {
            for (std::size_t j = 0; j < numbers.size(); ++j) {
                const FitParameter& p = fit.parameters[j];
                numbers[j] = std::clamp(fit.numbers[j] + share * moves[g][j] * p.typical, p.lower, p.upper);
            }
            double others = ridge(numbers);
            scratch.clear();
            for (std::size_t k = 0; k < chosen_.size(); ++k) {
                others += k == g ? 0 : fit.cost(chosen_[k], numbers, noise, scratch);
            }
            if (others < inside - by_record[g] + ridge(fit.numbers) + 0.1) {
                scratch.clear();
                result[g] = fit.cost(chosen_[g], numbers, noise, scratch);
                break;
            }
        }
    }
    return result;
}

HeaveExperiment::Smooth HeaveExperiment::fit_smooth(const SmoothSet& set, const std::vector<dynamics::EffectUse>& uses,
                                                    const HeaveNoise& begin, double base_cost) const {
    Smooth result;
    result.set = set;
    FlexibleForce& force = result.force;
    force = flat_force(set, uses, begin);
    for (const FlexibleForce::Variable variable : set.variables) {
        result.fit.variables.emplace_back(variable_name(variable));
    }
    std::vector<FitParameter> parameters;
    for (std::size_t k = 0; k < force.coefficients.size(); ++k) {
        parameters.push_back({"c" + std::to_string(k), "N", -10, 10, 0, small_force});
    }
    HeaveNoise noise = begin;
    FlexibleForce trial = force;
    const WhitenedResiduals residuals = [&](std::span<const double> p, std::vector<double>& r) {
        trial.set(p);
        return evaluate(uses, &trial, noise, r) - sum_of_squares(r);
    };
    // the innovations are nearly linear in the coefficients: one step at a time, and between steps the process noise
    // that they ask for
    Fit best;
    best.cost = 1e300;
    best.parameters.assign(parameters.size(), 0);
    HeaveNoise best_noise = noise;
    std::vector<double> scratch;
    for (int round = 0; round < 12; ++round) {
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            parameters[k].start = best.parameters[k];
        }
        noise = best_noise;
        const double before = best.cost;
        Fit fit = least_squares(parameters, residuals, {1, 0.5, smooth_ridge, true});
        if (fit.cost < best.cost) {
            best = std::move(fit);
        }
        for (const double factor : {0.1, 10.0, 0.32, 3.2}) {
            for (;;) {
                noise.process = std::clamp(best_noise.process * factor, process_floor, process_ceiling);
                const double cost = noise.process == best_noise.process
                                        ? best.cost
                                        : residuals(best.parameters, scratch) + sum_of_squares(scratch);
                if (!(cost < best.cost)) {
                    break;
                }
                best.cost = cost;
                best_noise = noise;
            }
        }
        if (before - best.cost < 2) {
            break;
        }
    }
    force.set(best.parameters);
    result.noise = best_noise;
    result.cost = best.cost;
    result.fit.gain = base_cost - best.cost;
    result.fit.degrees = static_cast<double>(force.coefficients.size());
    result.fit.p = chi_squared_tail(result.fit.gain, result.fit.degrees);
    evaluate(uses, &force, best_noise, result.residuals);
    const Left left{parameters, best.parameters, smooth_ridge,
                    [&](std::size_t record, const std::vector<double>& p, const HeaveNoise& n, std::vector<double>& r) {
                        trial.set(p);
                        return cost_of(record, uses, &trial, n, r);
                    },
                    [&](const HeaveNoise& n, const std::vector<double>& r) { return answers(force, uses, n, r); }};
    result.held_out = held_out_cost(left, best_noise, std::max(begin.process, best_noise.process));
    return result;
}

std::vector<SampledRun> HeaveExperiment::sampled() const {
    std::vector<SampledRun> runs;
    const std::vector<std::size_t> begin = begins();
    for (std::size_t g = 0; g < chosen_.size(); ++g) {
        const HeaveRecord& record = records_.records[chosen_[g]];
        runs.push_back({record.time, record.velocity.empty() ? 1U : 2U, begin[g]});
    }
    return runs;
}

WaveLine HeaveExperiment::line_at(double frequency, const std::vector<dynamics::EffectUse>& uses,
                                  const HeaveNoise& noise, const std::vector<double>& base) const {
    // the innovations answer a small force as a linear system: one run each for sine and cosine
    constexpr double small = 1e-4;  // N
    std::vector<double> answer[2], moved;
    const auto& all = dynamics::effects();
    const auto scanned = std::find_if(all.begin(), all.end(), [](const auto* e) { return e->info().search.scanned; });
    if (scanned == all.end()) {
        return {};
    }
    const dynamics::EffectUse wave = dynamics::neutral_use((*scanned)->info().name);
    for (int part = 0; part < 2; ++part) {
        std::vector<dynamics::EffectUse> with = uses;
        with.push_back(wave);
        with.back().values = {small, frequency, part == 0 ? 0.0 : std::numbers::pi / 2};
        evaluate(with, nullptr, noise, moved);
        answer[part].resize(base.size());
        for (std::size_t i = 0; i < base.size(); ++i) {
            answer[part][i] = (base[i] - moved[i]) / small;
        }
    }
    return wave_line(frequency, answer[0], answer[1], base);
}

std::vector<std::vector<double>> HeaveExperiment::periodic_starts(const std::vector<dynamics::EffectUse>& uses,
                                                                  const HeaveNoise& noise, std::size_t count) const {
    std::vector<double> base;
    evaluate(uses, nullptr, noise, base);
    return wave_starts(
        sampled(), base, [&](double frequency) { return line_at(frequency, uses, noise, base); }, count);
}

}  // namespace underbody::discovery
