#include "surrogates/discovery/motion/motion_experiment.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/counted.h"
#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/dynamics/simulate/motion_predict.h"

namespace underbody::discovery {

namespace {

dynamics::Model with_all(const dynamics::Model& model, const std::vector<dynamics::EffectUse>& uses) {
    dynamics::Model changed = model;
    for (const dynamics::EffectUse& use : uses) {
        changed = changed.with_effect(use);
    }
    return changed;
}

}  // namespace

MotionExperiment::MotionExperiment(const dynamics::Motion& motion, const dynamics::Model& model,
                                   const dynamics::Measurements& data, std::vector<MotionRecord> records)
    : motion_(motion),
      model_(model),
      data_(data),
      records_(std::move(records)),
      reading_(model.records),
      unused_(std::max(0.0, reading_.last_unknown())) {
    for (const MotionRecord& record : records_) {
        logged_.push_back(record.readings);
    }
}

void MotionExperiment::read(const dynamics::RecordReading& reading, double unused) {
    reading_ = reading;
    if (std::max(0.0, unused) == unused_) {
        return;
    }
    unused_ = std::max(0.0, unused);
    for (std::size_t i = 0; i < records_.size(); ++i) {
        const std::vector<double>& time = data_.runs[records_[i].run].table.numbers("time");
        records_[i].readings = logged_[i];
        for (std::vector<double>& values : records_[i].readings.value) {
            dynamics::forget_after(time, time.back() - unused_, values);
        }
    }
}

std::size_t MotionExperiment::readings() const {
    std::size_t count = 0;
    for (const MotionRecord& record : records_) {
        for (const std::vector<double>& values : record.readings.value) {
            for (std::size_t k = record.first; !values.empty() && k <= record.last; ++k) {
                count += std::isfinite(values[k]) ? 1 : 0;
            }
        }
    }
    return count;
}

std::vector<std::size_t> MotionExperiment::begins() const {
    std::vector<std::size_t> begin{0};
    for (const MotionRecord& record : records_) {
        const auto channels =
            static_cast<std::size_t>(std::count_if(record.readings.value.begin(), record.readings.value.end(),
                                                   [](const auto& values) { return !values.empty(); }));
        begin.push_back(begin.back() + channels * (record.last - record.first + 1));
    }
    return begin;
}

std::vector<std::size_t> MotionExperiment::channels() const {
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < shape().states.size(); ++i) {
        if (std::any_of(records_.begin(), records_.end(),
                        [&](const auto& r) { return !r.readings.value[i].empty(); })) {
            list.push_back(i);
        }
    }
    return list;
}

double MotionExperiment::evaluate(const std::vector<dynamics::EffectUse>& uses, const MotionNoise& noise,
                                  std::vector<double>& innovations, std::vector<double>* by_record,
                                  std::vector<MotionTrace>* traces) const {
    innovations.clear();
    const dynamics::Model changed = with_all(model_, uses);
    double cost = 0;
    for (const MotionRecord& record : records_) {
        const auto run = motion_.run(changed, data_.runs[record.run], reading_);
        MotionTrace* const trace = traces != nullptr ? &traces->emplace_back() : nullptr;
        const double own = filter_motion(*run, record, noise, innovations, trace);
        if (by_record != nullptr) {
            by_record->push_back(own);
        }
        cost += own;
    }
    innovations.resize(begins().back(), 1e3);  // a filter that ran away
    return cost;
}

double MotionExperiment::cost_of(const std::vector<std::size_t>& chosen, const std::vector<dynamics::EffectUse>& uses,
                                 const MotionNoise& noise) const {
    const dynamics::Model changed = with_all(model_, uses);
    std::vector<double> costs(chosen.size());
    core::parallel_for(chosen.size(), [&](std::size_t i) {
        const MotionRecord& record = records_[chosen[i]];
        std::vector<double> innovations;
        try {
            const auto run = motion_.run(changed, data_.runs[record.run], reading_);
            costs[i] = filter_motion(*run, record, noise, innovations);
        } catch (const core::Error&) {
            costs[i] = 1e300;
        }
    });
    return std::accumulate(costs.begin(), costs.end(), 0.0);
}

std::vector<LinearMotionRun> MotionExperiment::linear_runs(const std::vector<dynamics::EffectUse>& uses,
                                                           const MotionNoise& noise) const {
    const dynamics::Model changed = with_all(model_, uses);
    std::vector<LinearMotionRun> runs(records_.size());
    core::parallel_for(runs.size(), [&](std::size_t i) {
        try {
            const auto run = motion_.run(changed, data_.runs[records_[i].run], reading_);
            runs[i] = linear_motion(*run, records_[i], noise);
        } catch (const core::Error&) {
            runs[i].cost = 1e300;
        }
    });
    return runs;
}

/// The path is the filter's at the noise that the search begins with, and once more at what it finds.
double MotionExperiment::search(const std::vector<dynamics::EffectUse>& uses, const Numbers& numbers,
                                MotionNoise& noise) const {
    constexpr int rounds = 3;  // the last only judges
    double least = 1e301, factor = 3;
    MotionNoise there = noise;
    for (int round = 0; round < rounds; ++round) {
        const std::vector<LinearMotionRun> runs = linear_runs(uses, there);
        const double cost = std::accumulate(runs.begin(), runs.end(), 0.0,
                                            [](double sum, const LinearMotionRun& run) { return sum + run.cost; });
        const bool better = cost < least - 0.5;
        if (cost < least) {
            least = cost;
            noise = there;
        }
        if (!better || cost >= 1e300 || round + 1 == rounds) {
            break;
        }
        search_about(runs, numbers, there, factor);
        factor = std::sqrt(factor);
    }
    return least;
}

void MotionExperiment::search_about(const std::vector<LinearMotionRun>& runs, const Numbers& numbers,
                                    MotionNoise& noise, double factor) const {
    constexpr double finest = 1.12, enough = 0.5;
    const auto cost_of = [&](const MotionNoise& of) {
        std::vector<double> costs(runs.size());
        core::parallel_for(runs.size(), [&](std::size_t i) { costs[i] = linear_cost(runs[i], of); });
        return std::accumulate(costs.begin(), costs.end(), 0.0);
    };
    double best = cost_of(noise);
    std::vector<double> last(numbers.size(), 1);  // direction that helped
    while (factor > finest) {
        const double before = best;
        for (std::size_t j = 0; j < last.size(); ++j) {
            const double way = last[j];
            for (const double direction : {way, -way}) {
                MotionNoise there = noise;
                numbers[j](there, std::pow(factor, direction));
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

MotionExperiment::Numbers MotionExperiment::process_numbers() const {
    Numbers numbers;
    for (std::size_t l = 0; l < shape().loads.size(); ++l) {
        numbers.emplace_back([l](MotionNoise& noise, double by) { noise.load[l] *= by; });
    }
    return numbers;
}

MotionExperiment::Numbers MotionExperiment::white_numbers() const {
    Numbers numbers;
    for (const std::size_t i : channels()) {
        numbers.emplace_back([i](MotionNoise& noise, double by) { noise.white[i] *= by; });
    }
    return numbers;
}

double MotionExperiment::fit_noise(const std::vector<dynamics::EffectUse>& uses, MotionNoise& noise) const {
    const auto with_white = [&](Numbers numbers) {
        const Numbers white = white_numbers();
        numbers.insert(numbers.end(), white.begin(), white.end());
        return numbers;
    };
    const MotionNoise first = noise;
    const double white = search(uses, with_white(process_numbers()), noise);
    constexpr double clearly = 12;  // -2 log likelihood that coloured noise has to win, for its numbers
    MotionNoise best = noise;
    double least = white - clearly;
    Numbers numbers;
    for (const std::size_t i : channels()) {
        if (shape().is_place(i)) {
            numbers.emplace_back([i](MotionNoise& of, double by) { of.slow[i] *= by; });
        }
    }
    // its change from reading to reading is known far better than its size and time alone, which go along a valley
    numbers.emplace_back([](MotionNoise& of, double by) {
        of.slow_time *= by;
        for (double& slow : of.slow) {
            slow *= std::sqrt(by);
        }
    });
    const Numbers process = process_numbers();
    numbers.insert(numbers.end(), process.begin(), process.end());
    numbers = with_white(numbers);
    for (const double time : {0.05, 0.2, 1.0}) {
        // from where the search began: white noise alone has made loads of the colour
        MotionNoise coloured = first;
        coloured.slow_time = time;
        for (const std::size_t i : channels()) {
            if (shape().is_place(i)) {
                coloured.slow[i] = first.white[i];
                coloured.white[i] *= 0.4;
            }
        }
        for (double& load : coloured.load) {
            load *= 0.1;
        }
        const double cost = search(uses, numbers, coloured);
        if (cost < least) {
            least = cost;
            best = coloured;
        }
    }
    noise = best;
    return fit_process(uses, noise);
}

double MotionExperiment::fit_process(const std::vector<dynamics::EffectUse>& uses, MotionNoise& noise) const {
    return search(uses, process_numbers(), noise);
}

std::vector<double> MotionExperiment::best_start(const Hypothesis& hypothesis,
                                                 const std::vector<std::vector<double>>& starts,
                                                 const MotionNoise& noise) const {
    std::vector<std::size_t> all(records_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<double> best;
    double least = 1e301;
    for (const std::vector<double>& start : starts) {
        std::vector<double> inside = start;
        for (std::size_t j = 0; j < inside.size(); ++j) {
            inside[j] = std::clamp(inside[j], hypothesis.parameters[j].lower, hypothesis.parameters[j].upper);
        }
        const double cost = cost_of(all, hypothesis.with(inside), noise);
        if (cost < least) {
            least = cost;
            best = std::move(inside);
        }
    }
    return best;
}

MotionExperiment::Result MotionExperiment::fit(const Hypothesis& hypothesis,
                                               const std::vector<std::vector<double>>& starts,
                                               const MotionNoise& begin) const {
    Result result;
    result.noise = begin;
    FittedHypothesis& fitted = result.fitted;
    fitted.hypothesis = hypothesis;
    const auto begin_at = [&](const std::vector<double>& numbers) {
        for (std::size_t j = 0; j < numbers.size(); ++j) {
            fitted.hypothesis.parameters[j].start = numbers[j];
        }
    };
    begin_at(best_start(hypothesis, starts, begin));
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
        begin_at(fitted.fit.parameters);
        const MotionNoise before = result.noise;
        if (round < 2) {
            fit_process(hypothesis.with(fitted.fit.parameters), result.noise);
        }
        bool same = true;
        for (std::size_t l = 0; l < shape().loads.size(); ++l) {
            same = same && std::abs(std::log(before.load[l] / result.noise.load[l])) < 0.25;
        }
        if (same) {
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

DesignMatrix MotionExperiment::answers(const Hypothesis& hypothesis, const std::vector<std::vector<double>>& steps,
                                       const std::vector<dynamics::EffectUse>& uses, const MotionNoise& noise,
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

std::vector<MotionRecord> motion_records(const dynamics::Motion& motion, const dynamics::Model& model,
                                         const dynamics::Measurements& data, const std::vector<std::size_t>& runs,
                                         core::Problems& problems) {
    constexpr std::size_t least_rows = 50;
    std::vector<MotionRecord> records;
    for (const std::size_t r : runs) {
        const dynamics::MeasuredRun& run = data.runs[r];
        const auto measured = motion.run(model, run, model.records);
        const core::Place place{run.file.string(), {}, {}, {}};
        const std::vector<std::string> not_used = measured->clean_readings(run.name, model);
        measured->set_noise(dynamics::motion_noise(motion.shape(), data, run));
        const std::size_t end = measured->free_rows();
        if (end < least_rows) {
            problems.push_back({core::Problem::Severity::warning,
                                "run " + run.name + " has only " + core::counted(end, "row") + " before it " +
                                    motion.shape().end_of_free + " or ends: not used",
                                place});
            continue;
        }
        for (const std::string& text : not_used) {
            problems.push_back({core::Problem::Severity::warning, text, place});
        }
        if (end < run.table.rows()) {
            problems.push_back({core::Problem::Severity::warning,
                                "run " + run.name + " is fitted up to " +
                                    core::format_number(run.table.numbers("time")[end], 5) + " s: there it " +
                                    motion.shape().end_of_free,
                                place});
        }
        records.push_back({r, run.name, 0, end - 1, measured->readings()});
    }
    return records;
}

}  // namespace underbody::discovery
