#include "surrogates/discovery/heave_pitch/pitch_experiment.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/counted.h"
#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/simulate/pitch_predict.h"

namespace underbody::discovery {

using dynamics::pitch_states;

namespace {

dynamics::Model with_all(const dynamics::Model& model, const std::vector<dynamics::EffectUse>& uses) {
    dynamics::Model changed = model;
    for (const dynamics::EffectUse& use : uses) {
        changed = changed.with_effect(use);
    }
    return changed;
}

/// The variable's value in the middle of a step.
double value_of(const std::string& variable, const PitchTrace& trace, std::size_t k) {
    const PitchTrace::Column& x = trace.state[k];
    return variable == "gap"              ? x[0]
           : variable == "heave_velocity" ? x[1]
           : variable == "pitch"          ? x[2]
           : variable == "pitch_rate"     ? x[3]
                                          : static_cast<double>(k);  // time
}

}  // namespace

PitchExperiment::PitchExperiment(const dynamics::Model& model, const dynamics::Measurements& data,
                                 std::vector<PitchRecord> records)
    : model_(model), data_(data), records_(std::move(records)), reading_(model.records) {}

std::size_t PitchExperiment::readings() const {
    std::size_t count = 0;
    for (const PitchRecord& record : records_) {
        for (const std::vector<double>& values : record.value) {
            for (std::size_t k = record.first; !values.empty() && k <= record.last; ++k) {
                count += std::isfinite(values[k]) ? 1 : 0;
            }
        }
    }
    return count;
}

std::vector<std::size_t> PitchExperiment::begins() const {
    std::vector<std::size_t> begin{0};
    for (const PitchRecord& record : records_) {
        const auto channels = static_cast<std::size_t>(std::count_if(
            record.value.begin(), record.value.end(), [](const auto& values) { return !values.empty(); }));
        begin.push_back(begin.back() + channels * (record.last - record.first + 1));
    }
    return begin;
}

std::vector<std::size_t> PitchExperiment::channels() const {
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < pitch_states; ++i) {
        if (std::any_of(records_.begin(), records_.end(), [&](const auto& r) { return !r.value[i].empty(); })) {
            list.push_back(i);
        }
    }
    return list;
}

double PitchExperiment::evaluate(const std::vector<dynamics::EffectUse>& uses, const PitchNoise& noise,
                                 std::vector<double>& innovations, std::vector<double>* by_record,
                                 std::vector<PitchTrace>* traces) const {
    innovations.clear();
    const dynamics::Model changed = with_all(model_, uses);
    double cost = 0;
    for (const PitchRecord& record : records_) {
        dynamics::PitchRun run(changed, data_.runs[record.run], reading_);
        PitchTrace* const trace = traces != nullptr ? &traces->emplace_back() : nullptr;
        const double own = filter_pitch(run, record, noise, innovations, trace);
        if (by_record != nullptr) {
            by_record->push_back(own);
        }
        cost += own;
    }
    innovations.resize(begins().back(), 1e3);  // a filter that ran away
    return cost;
}

double PitchExperiment::cost_of(const std::vector<std::size_t>& chosen, const std::vector<dynamics::EffectUse>& uses,
                                const PitchNoise& noise) const {
    const dynamics::Model changed = with_all(model_, uses);
    std::vector<double> costs(chosen.size());
    core::parallel_for(chosen.size(), [&](std::size_t i) {
        const PitchRecord& record = records_[chosen[i]];
        std::vector<double> innovations;
        try {
            dynamics::PitchRun run(changed, data_.runs[record.run], reading_);
            costs[i] = filter_pitch(run, record, noise, innovations);
        } catch (const core::Error&) {
            costs[i] = 1e300;
        }
    });
    return std::accumulate(costs.begin(), costs.end(), 0.0);
}

std::vector<LinearPitchRun> PitchExperiment::linear_runs(const std::vector<dynamics::EffectUse>& uses,
                                                         const PitchNoise& noise) const {
    const dynamics::Model changed = with_all(model_, uses);
    std::vector<LinearPitchRun> runs(records_.size());
    core::parallel_for(runs.size(), [&](std::size_t i) {
        try {
            dynamics::PitchRun run(changed, data_.runs[records_[i].run], reading_);
            runs[i] = linear_pitch(run, records_[i], noise);
        } catch (const core::Error&) {
            runs[i].cost = 1e300;
        }
    });
    return runs;
}

/// The path is the filter's at the noise that the search begins with, and once more at what it finds.
double PitchExperiment::search(const std::vector<dynamics::EffectUse>& uses, const Numbers& numbers,
                               const std::vector<std::size_t>& white, PitchNoise& noise) const {
    constexpr int rounds = 3;  // the last only judges
    double least = 1e301, factor = 3;
    PitchNoise there = noise;
    for (int round = 0; round < rounds; ++round) {
        const std::vector<LinearPitchRun> runs = linear_runs(uses, there);
        const double cost = std::accumulate(runs.begin(), runs.end(), 0.0,
                                            [](double sum, const LinearPitchRun& run) { return sum + run.cost; });
        const bool better = cost < least - 0.5;
        if (cost < least) {
            least = cost;
            noise = there;
        }
        if (!better || cost >= 1e300 || round + 1 == rounds) {
            break;
        }
        search_about(runs, numbers, white, there, factor);
        factor = std::sqrt(factor);
    }
    return least;
}

void PitchExperiment::search_about(const std::vector<LinearPitchRun>& runs, const Numbers& numbers,
                                   const std::vector<std::size_t>& white, PitchNoise& noise, double factor) const {
    constexpr double finest = 1.12, enough = 0.5;
    const auto number = [&](PitchNoise& of, std::size_t j) -> double& {
        return j < numbers.size() ? of.*numbers[j] : of.white[white[j - numbers.size()]];
    };
    const auto cost_of = [&](const PitchNoise& of) {
        std::vector<double> costs(runs.size());
        core::parallel_for(runs.size(), [&](std::size_t i) { costs[i] = linear_cost(runs[i], of); });
        return std::accumulate(costs.begin(), costs.end(), 0.0);
    };
    double best = cost_of(noise);
    std::vector<double> last(numbers.size() + white.size(), 1);  // direction that helped
    while (factor > finest) {
        const double before = best;
        for (std::size_t j = 0; j < last.size(); ++j) {
            const double way = last[j];
            for (const double direction : {way, -way}) {
                PitchNoise there = noise;
                number(there, j) *= std::pow(factor, direction);
                const double cost = cost_of(there);
                if (cost < best) {
                    best = cost;
                    noise = there;
                    last[j] = direction;
                    break;
                }
            }
        }
        factor = before - best < enough ? std::sqrt(factor) : factor;
    }
}

double PitchExperiment::fit_noise(const std::vector<dynamics::EffectUse>& uses, PitchNoise& noise) const {
    const Numbers process{&PitchNoise::force, &PitchNoise::moment};
    const PitchNoise first = noise;
    const double white = search(uses, process, channels(), noise);
    constexpr double clearly = 12;  // -2 log likelihood that coloured noise has to win, for three numbers
    PitchNoise best = noise;
    double least = white - clearly;
    for (const double time : {0.05, 0.2, 1.0}) {
        // from where the search began: white noise alone has made force and moment of the colour
        PitchNoise coloured = first;
        coloured.slow_time = time;
        coloured.gap_slow = first.white[0];
        coloured.pitch_slow = first.white[2];
        coloured.white[0] *= 0.4;
        coloured.white[2] *= 0.4;
        coloured.force *= 0.1;
        coloured.moment *= 0.1;
        const double cost = search(uses,
                                   {&PitchNoise::gap_slow, &PitchNoise::pitch_slow, &PitchNoise::slow_time,
                                    &PitchNoise::force, &PitchNoise::moment},
                                   channels(), coloured);
        if (cost < least) {
            least = cost;
            best = coloured;
        }
    }
    noise = best;
    return fit_process(uses, noise);
}

double PitchExperiment::fit_process(const std::vector<dynamics::EffectUse>& uses, PitchNoise& noise) const {
    return search(uses, {&PitchNoise::force, &PitchNoise::moment}, {}, noise);
}

PitchExperiment::Result PitchExperiment::fit(const Hypothesis& hypothesis,
                                             const std::vector<std::vector<double>>& starts,
                                             const PitchNoise& begin) const {
    Result result;
    result.noise = begin;
    FittedHypothesis& fitted = result.fitted;
    fitted.hypothesis = hypothesis;
    std::vector<std::size_t> all(records_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    double least = 1e301;
    for (const std::vector<double>& start : starts) {
        std::vector<double> inside = start;
        for (std::size_t j = 0; j < inside.size(); ++j) {
            inside[j] = std::clamp(inside[j], hypothesis.parameters[j].lower, hypothesis.parameters[j].upper);
        }
        const double cost = cost_of(all, hypothesis.with(inside), begin);
        if (cost < least) {
            least = cost;
            for (std::size_t j = 0; j < inside.size(); ++j) {
                fitted.hypothesis.parameters[j].start = inside[j];
            }
        }
    }
    const auto residuals = [&](std::span<const double> p, std::vector<double>& out) {
        double cost = 0;
        try {
            cost = evaluate(hypothesis.with(p), result.noise, out);
        } catch (const core::Error&) {
            out.assign(begins().back(), 1e3);
            return 1e300;
        }
        return cost - std::inner_product(out.begin(), out.end(), out.begin(), 0.0);
    };
    FitOptions options;
    options.iterations = 6;
    options.tolerance = 0.05;
    for (int round = 0; round < 3; ++round) {
        fitted.fit = least_squares(fitted.hypothesis.parameters, residuals, options);
        for (std::size_t j = 0; j < fitted.fit.parameters.size(); ++j) {
            fitted.hypothesis.parameters[j].start = fitted.fit.parameters[j];
        }
        const PitchNoise before = result.noise;
        if (round < 2) {
            fit_process(hypothesis.with(fitted.fit.parameters), result.noise);
        }
        const auto same = [](double a, double b) { return std::abs(std::log(a / b)) < 0.25; };
        if (same(before.force, result.noise.force) && same(before.moment, result.noise.moment)) {
            break;
        }
    }
    // the neutral numbers stay what they were: where an effect does nothing is told from them
    fitted.hypothesis.parameters = hypothesis.parameters;
    std::vector<double> innovations;
    fitted.cost = evaluate(hypothesis.with(fitted.fit.parameters), result.noise, innovations, &fitted.cost_of_group);
    fitted.fit.residuals = std::move(innovations);
    fitted.occam = occam_factor(hypothesis, readings());
    return result;
}

DesignMatrix PitchExperiment::answers(const Hypothesis& hypothesis, const std::vector<std::vector<double>>& steps,
                                      const std::vector<dynamics::EffectUse>& uses, const PitchNoise& noise,
                                      const std::vector<double>& innovations) const {
    DesignMatrix matrix;
    matrix.rows = innovations.size();
    std::vector<double> there;
    for (const std::vector<double>& p : steps) {
        std::vector<dynamics::EffectUse> with = uses;
        for (dynamics::EffectUse& use : hypothesis.with(p)) {
            with.push_back(std::move(use));
        }
        evaluate(with, noise, there);
        ++matrix.columns;
        for (std::size_t i = 0; i < there.size(); ++i) {
            matrix.values.push_back(there[i] - innovations[i]);
        }
    }
    return matrix;
}

DesignMatrix PitchExperiment::answers(const PitchSmooth& smooth, const std::vector<PitchTrace>& traces) const {
    std::vector<std::vector<double>> values(smooth.variables.size());
    for (std::size_t v = 0; v < values.size(); ++v) {
        for (const PitchTrace& trace : traces) {
            for (std::size_t k = 0; k < trace.state.size(); ++k) {
                values[v].push_back(value_of(smooth.variables[v], trace, k));
            }
        }
    }
    const FlexibleBasis basis(values, smooth.columns);
    DesignMatrix matrix;
    matrix.rows = begins().back();
    matrix.columns = basis.columns();
    std::size_t samples = 0;
    for (const PitchTrace& trace : traces) {
        samples += trace.state.size();
    }
    std::vector<std::vector<double>> loads(matrix.columns);
    std::vector<double> point(values.size()), out(matrix.columns);
    for (std::size_t k = 0; k < samples; ++k) {
        for (std::size_t v = 0; v < values.size(); ++v) {
            point[v] = values[v][k];
        }
        basis.evaluate(point.data(), out.data());
        for (std::size_t c = 0; c < matrix.columns; ++c) {
            loads[c].push_back(out[c]);
        }
    }
    for (std::size_t c = 0; c < matrix.columns; ++c) {
        std::size_t from = 0;
        for (std::size_t r = 0; r < traces.size(); ++r) {
            const std::vector<double> own(
                loads[c].begin() + static_cast<std::ptrdiff_t>(from),
                loads[c].begin() + static_cast<std::ptrdiff_t>(from + traces[r].state.size()));
            from += traces[r].state.size();
            linear_answer(traces[r], records_[r], smooth.axis, own, matrix.values);
        }
    }
    return matrix;
}

std::vector<PitchRecord> pitch_records(const dynamics::Model& model, const dynamics::Measurements& data,
                                       const std::vector<std::size_t>& runs, core::Problems& problems) {
    constexpr double near_ground = 3;  // standard deviations of the lower edge's reading
    constexpr std::size_t least_rows = 50;
    std::vector<PitchRecord> records;
    const double contact = dynamics::contact_gap(model), half_length = model.vehicle.base_half_length;
    for (const std::size_t r : runs) {
        const dynamics::MeasuredRun& run = data.runs[r];
        PitchRecord record;
        record.run = r;
        record.name = run.name;
        dynamics::PitchRun measured(model, run, model.records);
        const core::Place place{run.file.string(), {}, {}, {}};
        for (const std::string& text : measured.clean_readings(run.name, dynamics::lift_gap_range(model))) {
            problems.push_back({core::Problem::Severity::warning, text, place});
        }
        record.value = measured.readings().value;
        const std::array<double, pitch_states> noise = dynamics::pitch_noise(data, run);
        const std::size_t rows = run.table.rows();
        std::size_t end = 0;
        for (; end < rows; ++end) {
            const double edge = record.value[0][end] - contact - half_length * std::abs(std::sin(record.value[2][end]));
            if (edge < near_ground * std::hypot(noise[0], half_length * noise[2])) {
                break;
            }
        }
        if (end < least_rows) {
            problems.push_back({core::Problem::Severity::warning,
                                "run " + run.name + " has only " + core::counted(end, "row") +
                                    " before it touches the ground or ends: not used",
                                place});
            continue;
        }
        if (end < rows) {
            problems.push_back({core::Problem::Severity::warning,
                                "run " + run.name + " is fitted up to " +
                                    core::format_number(run.table.numbers("time")[end], 5) +
                                    " s: there an edge of the base comes to the ground",
                                place});
        }
        record.last = end - 1;
        records.push_back(std::move(record));
    }
    return records;
}

}  // namespace underbody::discovery
