// Closing the loop with runs of a coupled motion: the declared model inside the experiment.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/discovery/motion/motion_loop.h"
#include "surrogates/discovery/run_split.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/declared_noise.h"

namespace underbody::discovery {

namespace {

/// True for what a filter of these runs cannot follow: a force with memory.
bool out_of_reach(const Hypothesis& hypothesis, const dynamics::Model& model) {
    dynamics::HeaveTerms terms;
    for (dynamics::EffectUse use : hypothesis.uses) {
        for (std::size_t j = 0; j < use.values.size(); ++j) {
            use.values[j] += 0.1 * dynamics::effect(use.name).info().parameters[j].typical;
        }
        dynamics::effect(use.name).add_to(terms, use, model);
    }
    return terms.history != 0;
}

}  // namespace

MotionLoop::MotionLoop(const dynamics::Motion& motion, const dynamics::Model& model, const dynamics::Measurements& data,
                       const DiscoverOptions& options, core::Progress& progress)
    : motion_(motion),
      model_(model),
      data_(data),
      options_(options),
      progress_(progress),
      calibration_(heave_calibration(options.constants)) {}

Discovery MotionLoop::run() {
    result_.motion = shape().name;
    split();
    problems_before_fit_ = static_cast<std::ptrdiff_t>(result_.problems.size());
    progress_.report(0.02, "noise");
    fit_null();
    try_between();
    progress_.report(0.15, "fitting the effects of the catalogue");
    list_candidates();
    fit_singles();
    noise_beside_best();
    progress_.report(0.6, "testing what is left");
    open_gate();
    if (gate_ < calibration_.gate) {
        check_input();
        rest_ = rest_beside(fitted_[best_single_], noises_[best_single_]);
        progress_.report(0.7, "several effects");
        fit_further();
    } else {
        look_run_by_run();
    }
    progress_.report(0.85, "error on held-out runs");
    decide();
    measure_error();
    measure_axes();
    describe();
    return std::move(result_);
}

void MotionLoop::warn(const std::string& text) {
    result_.problems.push_back(
        {core::Problem::Severity::warning, text, core::Place{data_.folder.string(), {}, {}, {}}});
}

void MotionLoop::split() {
    std::vector<std::size_t> all(data_.runs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<MotionRecord> records = motion_records(motion_, model_, data_, all, result_.problems);
    if (records.empty()) {
        throw core::InputError("range", "no run of " + shape().words + " is long enough",
                               core::Place{data_.folder.string(), {}, {}, {}},
                               "50 rows at least before it " + shape().end_of_free);
    }
    std::vector<std::size_t> run_of;
    for (const MotionRecord& record : records) {
        run_of.push_back(record.run);
    }
    const RunSplit split = split_runs(data_, run_of, options_.seed);
    result_.held_out = split.held_out;
    held_out_is_told_ = split.told;
    result_.problems.insert(result_.problems.end(), split.problems.begin(), split.problems.end());
    test_data_ = held_out_data(split, data_, run_of);
    test_data_.motion = shape().name;
    if (auto without = dynamics::without_doubtful_noise(model_, test_data_, result_.problems)) {
        test_data_ = std::move(*without);  // as predict takes them
    }
    std::vector<MotionRecord> train;
    for (const std::size_t i : split.train) {
        train.push_back(std::move(records[i]));
    }
    experiment_.emplace(motion_, model_, data_, std::move(train));
    channels_ = experiment_->channels();
    for (const std::string& column : motion_.inputs(model_)) {
        if (std::any_of(experiment_->records().begin(), experiment_->records().end(), [&](const MotionRecord& record) {
                return dynamics::column_moves(data_.runs[record.run], column);
            })) {
            inputs_.push_back(column);
        }
    }
}

/// Of the sensors as declared or as the readings scatter; of the loads a little.
MotionNoise MotionLoop::noise_at_first() const {
    MotionNoise noise;
    for (const std::size_t i : channels_) {
        std::vector<double> own;
        for (const MotionRecord& record : experiment_->records()) {
            own.push_back(std::max(dynamics::motion_noise(shape(), data_, data_.runs[record.run])[i], 1e-7));
        }
        noise.white[i] = median(own);
    }
    const auto first = motion_.run(model_, data_.runs[experiment_->records().front().run], model_.records);
    for (std::size_t l = 0; l < shape().loads.size(); ++l) {
        noise.load[l] = shape().loads[l].process * first->inertia(l);
    }
    return noise;
}

void MotionLoop::fit_null() {
    MotionNoise noise = noise_at_first();
    experiment_->fit_noise({}, noise);
    set_null(noise);
}

void MotionLoop::set_null(const MotionNoise& noise) {
    null_noise_ = noise;
    null_by_record_.clear();
    null_cost_ = experiment_->evaluate({}, null_noise_, null_innovations_, &null_by_record_);
}

/// Is the recorded input held from sample to sample, or linear between? Asked of the data only where the model does not
/// say.
void MotionLoop::try_between() {
    using Between = dynamics::RecordReading::Between;
    if (model_.records.input_between != Between::unsaid || inputs_.empty()) {
        return;
    }
    const MotionNoise noise = null_noise_;
    const double held = null_cost_;
    dynamics::RecordReading reading = experiment_->reading();
    reading.input_between = Between::linear;
    experiment_->read(reading);
    MotionNoise other = null_noise_;
    const double linear = experiment_->fit_process({}, other);
    const Between found = dynamics::between_samples(Between::unsaid, held, linear);
    reading.input_between = found;
    experiment_->read(reading);
    set_null(found == Between::linear ? other : noise);
    if (found == Between::linear) {
        warn(
            "the recorded inputs are linear between their samples: the motion fits that better than held ones; the "
            "errors before and after are with inputs read so, and [records] of the new model says it");
    }
}

void MotionLoop::list_candidates() {
    std::vector<dynamics::Channel> varying;
    if (std::any_of(data_.runs.begin(), data_.runs.end(),
                    [](const dynamics::MeasuredRun& run) { return dynamics::column_moves(run, "input_force"); })) {
        varying.push_back(dynamics::Channel::input_force);
    }
    for (std::size_t c = 0; c < dynamics::channel_count; ++c) {
        const auto channel = static_cast<dynamics::Channel>(c);
        std::vector<double> held;
        for (const dynamics::MeasuredRun& run : data_.runs) {
            const auto found = run.conditions.find(dynamics::channel_name(channel));
            if (found != run.conditions.end()) {
                held.push_back(found->second);
            }
        }
        if (!held.empty() &&
            *std::max_element(held.begin(), held.end()) > *std::min_element(held.begin(), held.end())) {
            varying.push_back(channel);
        }
    }
    candidates_ = motion_hypotheses(shape(), model_, varying);
    const bool pushed = std::find(varying.begin(), varying.end(), dynamics::Channel::input_force) != varying.end();
    std::erase_if(candidates_, [&](const Hypothesis& one) {
        return out_of_reach(one, model_) || (!pushed && touch_of(one, model_).input) || needs_unread(one);
    });
    keep_shapes_inside(candidates_, lowest_gap(), lowest_frequency(experiment_->sampled()));
    begin_scanned(candidates_, [&] { return experiment_->periodic_starts(null_noise_, 3); });
    keep_only(candidates_, options_.candidates);
}

/// m, of all readings; 0 where the gap is not a state.
double MotionLoop::lowest_gap() const {
    double lowest = 1e300;
    for (const std::size_t i : channels_) {
        for (const MotionRecord& record : experiment_->records()) {
            for (const double value : record.readings.value[i]) {
                lowest = shape().states[i].channel == "gap" && std::isfinite(value) ? std::min(lowest, value) : lowest;
            }
        }
    }
    return lowest < 1e300 ? lowest : 0;
}

/// A law over a place that no run has readings of, or over a recorded moment that none has.
bool MotionLoop::needs_unread(const Hypothesis& hypothesis) const {
    return std::any_of(hypothesis.depends_on.begin(), hypothesis.depends_on.end(), [&](const std::string& quantity) {
        for (std::size_t i = 0; i < shape().states.size(); ++i) {
            if (shape().is_place(i) && shape().states[i].channel == quantity) {
                return std::find(channels_.begin(), channels_.end(), i) == channels_.end();
            }
        }
        return quantity == "input_moment" &&
               std::none_of(data_.runs.begin(), data_.runs.end(), [](const dynamics::MeasuredRun& run) {
                   return dynamics::column_moves(run, "input_moment");
               });
    });
}

MotionExperiment::Result MotionLoop::fitted(const Hypothesis& hypothesis,
                                            const std::vector<std::vector<double>>& starts,
                                            const MotionNoise& begin) const {
    MotionExperiment::Result result = experiment_->fit(hypothesis, starts, begin);
    FittedHypothesis& one = result.fitted;
    one.explained = null_cost_ - one.cost;
    const FitParameter& chief = hypothesis.parameters.front();
    if (one.fit.parameters.front() >= chief.upper - 1e-9 * std::abs(chief.upper)) {
        one.hypothesis.prior *= 1e-4;  // driven against the bound of what physics allows: it stands for something else
    }
    one.explained_by_group = null_by_record_;
    for (std::size_t r = 0; r < null_by_record_.size(); ++r) {
        one.explained_by_group[r] -= one.cost_of_group[r];
    }
    return result;
}

/// The effects that promise most to first order are fitted; then whatever promises more than the best of these gives.
void MotionLoop::fit_singles() {
    constexpr std::size_t at_first = 8;
    constexpr double within = 12;  // -2 log likelihood
    probes_ = probes({}, null_noise_, {});
    candidate_of_.clear();
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < probes_.size(); ++k) {
        if (!probes_[k].smooth) {
            order.push_back(k);
        }
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return probes_[a].gain > probes_[b].gain; });
    std::size_t done = 0;
    const auto fit_to = [&](std::size_t end) {
        const std::size_t first = done;
        fitted_.resize(end);
        noises_.resize(end);
        core::parallel_for(
            end - first,
            [&](std::size_t k) {
                const Probe& probe = probes_[order[first + k]];
                std::vector<std::vector<double>> starts = candidates_[probe.candidate].starts;
                if (!probe.numbers.empty()) {
                    starts.push_back(probe.numbers);
                }
                MotionExperiment::Result result = fitted(candidates_[probe.candidate], starts, null_noise_);
                fitted_[first + k] = std::move(result.fitted);
                noises_[first + k] = result.noise;
            },
            progress_);
        for (std::size_t k = first; k < end; ++k) {
            candidate_of_.push_back(probes_[order[k]].candidate);
        }
        done = end;
        best_single_ = best_hypothesis(fitted_, 1);
    };
    fit_to(std::min(at_first, order.size()));
    while (done < order.size() && probes_[order[done]].gain > fitted_[best_single_].explained - within &&
           probes_[order[done]].gain > within) {
        fit_to(std::min(done + 2, order.size()));
    }
}

/// True where a channel has been left with less than half of the noise by which its readings scatter: random loads that
/// make up for what is missing follow a measured rate from reading to reading, as if it had none.
bool MotionLoop::noise_given_to_loads() const {
    constexpr double half = 0.5;
    const MotionNoise first = noise_at_first();
    return std::any_of(channels_.begin(), channels_.end(),
                       [&](std::size_t i) { return null_noise_.total(i) < half * first.white[i]; });
}

/// Coloured sensor noise would pass for an effect, and an effect for coloured noise: it was looked for beside the
/// declared model, now beside the best explanation; if the answer is another one, everything is judged again.
void MotionLoop::noise_beside_best() {
    constexpr double other = 1.3;  // times as much noise of a reading, or as little
    if (fitted_.empty() || !(null_noise_.coloured() || noise_given_to_loads())) {
        return;
    }
    const FittedHypothesis& best = fitted_[best_single_];
    MotionNoise noise = noise_at_first();
    experiment_->fit_noise(best.hypothesis.with(best.fit.parameters), noise);
    const bool changed = std::any_of(channels_.begin(), channels_.end(), [&](std::size_t i) {
        const double ratio = noise.total(i) / null_noise_.total(i);
        return ratio > other || ratio < 1 / other;
    });
    if (changed) {
        experiment_->fit_process({}, noise);
        set_null(noise);
        fit_singles();
    }
}

Discovery discover_motion(const dynamics::Motion& motion, const dynamics::Model& model,
                          const dynamics::Measurements& data, const DiscoverOptions& options,
                          core::Progress& progress) {
    return MotionLoop(motion, model, data, options, progress).run();
}

}  // namespace underbody::discovery
