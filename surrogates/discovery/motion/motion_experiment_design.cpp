#include "surrogates/discovery/motion/motion_experiment_design.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/text.h"
#include "core/told.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

namespace {

constexpr double window = 2;  ///< s

}  // namespace

const MotionRecord& longest_record(const MotionRig& rig) {
    const auto seconds = [&](const MotionRecord& record) {
        const std::vector<double>& time = rig.data.runs[record.run].table.numbers("time");
        return time[record.last] - time[record.first];
    };
    return *std::max_element(rig.records.begin(), rig.records.end(),
                             [&](const MotionRecord& a, const MotionRecord& b) { return seconds(a) < seconds(b); });
}

namespace {

const dynamics::MeasuredRun& longest_run(const MotionRig& rig) { return rig.data.runs[longest_record(rig).run]; }

/// Half of what the input spans in the runs; as it acts.
double size_of(const MotionRig& rig, const std::string& input) {
    std::vector<double> values;
    for (const MotionRecord& record : rig.records) {
        const core::Column* column = rig.data.runs[record.run].table.find(input);
        if (column == nullptr || column->is_text()) {
            continue;  // no such input in this run
        }
        std::copy_if(column->numbers.begin(), column->numbers.end(), std::back_inserter(values),
                     [](double x) { return std::isfinite(x); });
    }
    if (values.empty()) {
        return 0;
    }
    return 0.5 * std::abs(rig.model.records.factor_of(input)) * (quantile(values, 0.95) - quantile(values, 0.05));
}

std::vector<MotionTrial> waves(const MotionRig& rig, const dynamics::MeasuredRun& run) {
    std::vector<MotionTrial> list;
    const std::vector<double>& time = run.table.numbers("time");
    for (const std::string& input : rig.inputs) {
        const core::Column* column = run.table.find(input);
        if (column == nullptr) {
            continue;
        }
        const double size = size_of(rig, input);
        if (!(size > 0)) {
            continue;  // it hardly ever moves: no measure of what to add
        }
        for (const double frequency : {0.0, 0.1, 0.3, 0.8, 2.0}) {
            MotionTrial trial{"", input, column->unit, time, {}, 0};
            const double strength = frequency > 0.5 ? 2 * size : size;
            const std::string told = core::told(strength, column->unit, 2);
            trial.text = run.name + " again with " +
                         (frequency == 0 ? "steps of +-" + told + " every second"
                                         : "a sine of " + told + " at " + core::format_number(frequency, 2) + " Hz") +
                         " added to " + input;
            for (const double t : time) {
                const double since = t - time.front();
                const double wave = frequency == 0 ? (static_cast<long>(since) % 2 == 0 ? 1.0 : -1.0)
                                                   : std::sin(2 * std::numbers::pi * frequency * since);
                trial.added.push_back(strength * wave);
            }
            list.push_back(std::move(trial));
        }
    }
    return list;
}

dynamics::MeasuredRun with_wave(const MotionRig& rig, const dynamics::MeasuredRun& run, const MotionTrial& trial) {
    dynamics::MeasuredRun changed = run;
    changed.table = {};
    changed.table.source = run.table.source;
    for (const core::Column& column : run.table.columns()) {
        if (column.is_text()) {
            continue;
        }
        std::vector<double> values = column.numbers;
        for (std::size_t k = 0; column.name == trial.input && k < values.size(); ++k) {
            values[k] += trial.added[k] / rig.model.records.factor_of(trial.input);
        }
        changed.table.add_numbers(column.name, column.unit, std::move(values));
    }
    return changed;
}

/// Of a reading, as if each were independent of its neighbours: slow noise is as large as it leaves their mean.
double unit_of(const MotionNoise& noise, std::size_t state, double step) {
    const double decay = std::exp(-step / noise.slow_time);
    return std::sqrt(noise.white[state] * noise.white[state] +
                     noise.slow[state] * noise.slow[state] * (1 + decay) / (1 - decay));
}

/// Adds the squared difference of two explanations within a window of the run.
double difference_in(const MotionRig& rig, const dynamics::MotionWindow& at, dynamics::MeasuredMotion& one,
                     dynamics::MeasuredMotion& other) {
    const dynamics::MotionState begin = at.at(at.start);
    dynamics::MotionState beside = begin;  // both are read alike there: a sensor's offset does not show in a start
    for (const std::size_t i : rig.channels) {
        beside[i] += one.reading(at.start, i, begin) - other.reading(at.start, i, begin);
    }
    bool lost = false, lost_too = false;
    const auto first = dynamics::motion_from(one, begin, at.start, at.end, &lost),
               second = dynamics::motion_from(other, beside, at.start, at.end, &lost_too);
    double sum = 0;
    for (std::size_t k = at.start + 1; !lost && !lost_too && k <= at.end; ++k) {
        for (const std::size_t i : rig.channels) {
            const double difference =
                             one.reading(k, i, first[k - at.start]) - other.reading(k, i, second[k - at.start]),
                         share = difference / unit_of(rig.noise, i, one.time()[k] - one.time()[k - 1]);
            sum += std::isfinite(share) ? std::min(share * share, 1e4) : 0;
        }
    }
    return sum;
}

dynamics::Model with_all(dynamics::Model model, const std::vector<dynamics::EffectUse>& uses) {
    for (const dynamics::EffectUse& use : uses) {
        model = model.with_effect(use);
    }
    return model;
}

}  // namespace

std::vector<MotionTrial> motion_trials(const MotionRig& rig, const std::vector<dynamics::EffectUse>& one,
                                       const std::vector<dynamics::EffectUse>& other) {
    const dynamics::MeasuredRun& run = longest_run(rig);
    std::vector<MotionTrial> list = waves(rig, run);
    const dynamics::Model first = with_all(rig.model, one), second = with_all(rig.model, other);
    const auto as_it_was = rig.motion.run(first, run, first.records);
    as_it_was->set_noise(rig.noise.white);
    const std::vector<dynamics::MotionWindow> windows = dynamics::predict_windows(*as_it_was, window, window);
    core::parallel_for(list.size(), [&](std::size_t i) {
        try {
            const dynamics::MeasuredRun changed = with_wave(rig, run, list[i]);
            const auto a = rig.motion.run(first, changed, first.records),
                       b = rig.motion.run(second, changed, second.records);
            double sum = 0;
            for (const dynamics::MotionWindow& at : windows) {
                sum += at.lost ? 0 : difference_in(rig, at, *a, *b);
            }
            list[i].separation = std::sqrt(sum);
        } catch (const core::InputError&) {
            list[i].separation = 0;  // with such inputs the body cannot move
        }
    });
    std::sort(list.begin(), list.end(),
              [](const MotionTrial& x, const MotionTrial& y) { return x.separation > y.separation; });
    return list;
}

std::string motion_told_apart(const MotionRig& rig, const FittedHypothesis& chosen, const FittedHypothesis& rival) {
    const std::vector<MotionTrial> list =
        motion_trials(rig, chosen.hypothesis.with(chosen.fit.parameters), rival.hypothesis.with(rival.fit.parameters));
    if (list.empty()) {
        return "runs in which " + list_of(rival.hypothesis.depends_on) + " is excited apart from the rest";
    }
    if (list.front().separation < 0.5) {
        return "no wave on the inputs tells them apart with these sensors; measure another channel";
    }
    return list.front().text + ": they differ there by " + core::format_number(list.front().separation, 3) +
           " standard deviations";
}

std::optional<MotionQuestion> motion_question(const MotionRig& rig, const std::vector<FittedHypothesis>& fitted,
                                              const Attribution& attribution, const Discovery& result) {
    if (attribution.shares.empty() || rig.inputs.empty()) {
        return {};
    }
    MotionQuestion question;
    question.one = attribution.shares.front().hypothesis;
    const FittedHypothesis& best = fitted[question.one];
    question.one_uses = best.hypothesis.with(best.fit.parameters);
    if (result.verdict == "effect" && attribution.shares.size() > 1) {
        question.rival = attribution.shares[1].hypothesis;
        const FittedHypothesis& rival = fitted[*question.rival];
        question.rival_uses = rival.hypothesis.with(rival.fit.parameters);
        question.purpose = "to tell " + best.hypothesis.label() + " from " + rival.hypothesis.label();
    } else if (result.verdict == "none") {
        std::vector<double> p = best.fit.parameters;
        p.front() += 3 * (std::isfinite(best.fit.sigma.front()) ? best.fit.sigma.front() : 0.0);
        question.one_uses = best.hypothesis.with(p);
        question.purpose = "to see " + best.hypothesis.label() + " below today's limit";
    } else if (result.verdict == "unknown") {
        question.purpose = "to see the law behind what depends on " + list_of(result.depends_on);
    } else {
        question.purpose = "to confirm " + best.hypothesis.label();
    }
    return question;
}

void next_motion_experiment(const MotionRig& rig, const std::optional<MotionQuestion>& question,
                            const MotionPromises& promised, Discovery& result) {
    constexpr std::size_t repeats = 4, looked_into = 3;
    if (!question) {
        result.next_experiment = "runs in other states, with inputs that move and are recorded";
        return;
    }
    const std::vector<MotionTrial> list = motion_trials(rig, question->one_uses, question->rival_uses);
    if (list.empty()) {
        result.next_experiment = question->purpose + ": runs with inputs that are recorded";
        return;
    }
    // what differs most without a controller need not do so with one
    std::size_t best = 0;
    MotionPromise promise;
    for (std::size_t i = 0; i < std::min(looked_into, list.size()); ++i) {
        MotionPromise own = promised(list[i], repeats);
        if (i == 0 || own.chance > promise.chance) {
            best = i;
            promise = std::move(own);
        }
    }
    const MotionTrial& trial = list[best];
    result.next_power = promise.chance;
    result.next_experiment =
        experiment_text(question->purpose, trial.text + ", " + std::to_string(repeats) + " times", result.next_power) +
        " (next-experiment.csv: what is added" + promise.controller + ")";
    result.next_set_points.add_numbers("time", "s", trial.time);
    result.next_set_points.add_numbers(trial.input, trial.unit, trial.added);
}

}  // namespace underbody::discovery
