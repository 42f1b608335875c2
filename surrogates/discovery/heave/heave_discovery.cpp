// Closing the loop with heave runs: the declared model inside the experiment.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/counted.h"
#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/run_split.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::discovery {

HeaveLoop::HeaveLoop(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
                     core::Progress& progress)
    : model_(model),
      data_(data),
      options_(options),
      progress_(progress),
      calibration_(heave_calibration(options.constants)),
      records_(prepare_heave_records(model, data)),
      records_read_(model.records) {}

Discovery HeaveLoop::run() {
    split();
    experiment_.emplace(model_, records_, train_, data_.declared_noise("gap"), data_.declared_noise("heave_velocity"));
    experiment_->set_hold(records_read_.input_between != dynamics::RecordReading::Between::linear);
    progress_.report(0.02, "noise");
    fit_null();
    drop_accidents();
    progress_.report(0.08, "fitting the effects of the catalogue");
    fit_singles();
    try_hold();
    colour_noise();
    absorb_small_shift();
    progress_.report(0.5, "testing what is left");
    open_gate();
    if (gate_ < calibration_.gate) {
        check_input();
        smooth_corrections();
        progress_.report(0.65, "pairs of effects");
        fit_pairs();
        fit_further();
    } else {
        look_run_by_run();
    }
    decide();
    progress_.report(0.8, "clean twins");
    run_placebo();
    progress_.report(0.85, "error on held-out runs");
    measure_error();
    describe();
    return std::move(result_);
}

void HeaveLoop::split() {
    std::vector<std::size_t> run_of;
    for (const HeaveRecord& record : records_.records) {
        run_of.push_back(record.run);
    }
    RunSplit split = split_runs(data_, run_of, options_.seed);
    test_data_ = held_out_data(split, data_, run_of);
    test_data_.motion = "heave";
    train_ = std::move(split.train);
    test_ = std::move(split.test);
    if (split.beside) {
        test_records_ = prepare_heave_records(model_, *split.beside);
        test_.resize(test_records_->records.size());
        std::iota(test_.begin(), test_.end(), std::size_t{0});
    }
    result_.held_out = std::move(split.held_out);
    result_.problems.insert(result_.problems.end(), split.problems.begin(), split.problems.end());
}

void HeaveLoop::fit_null() {
    HeaveNoise noise = experiment_->noise();
    experiment_->fit_process({}, noise);
    experiment_->fit_noise({}, noise);
    set_null(noise);
}

namespace {

/// Steps whose gap is far from what the filter expects while its neighbours are not.
std::vector<std::size_t> accidents(const HeaveRecord& record, const std::vector<double>& innovations) {
    constexpr double far = 6;  // standard deviations
    const std::size_t channels = record.velocity.empty() ? 1 : 2;
    std::vector<std::size_t> found;
    for (std::size_t k = 25; k + 3 < record.time.size(); ++k) {
        const double own = std::abs(innovations[channels * k]);
        bool peak = own > far;
        for (std::size_t d = 1; d <= 3; ++d) {
            peak = peak && own > std::abs(innovations[channels * (k - d)]) &&
                   own > std::abs(innovations[channels * (k + d)]);
        }
        if (peak) {
            found.push_back(k);
        }
    }
    return found;
}

/// Takes them out of the chosen records; returns how many.
std::size_t drop_accidents_of(HeaveRecords& records, const std::vector<std::size_t>& chosen,
                              const HeaveExperiment& experiment, const HeaveNoise& noise) {
    constexpr double most = 0.01;  // of the readings: more are no accidents
    std::size_t dropped = 0;
    for (const std::size_t r : chosen) {
        HeaveRecord& record = records.records[r];
        std::vector<double> innovations;
        filter_innovations(record, experiment.explanation(r, {}), noise, innovations);
        const std::vector<std::size_t> bad = accidents(record, innovations);
        if (static_cast<double>(bad.size()) < most * static_cast<double>(record.time.size())) {
            for (const std::size_t k : bad) {
                record.gap[k] = std::nan("");
            }
            dropped += bad.size();
        }
    }
    return dropped;
}

}  // namespace

/// They would move states and figures.
void HeaveLoop::drop_accidents() {
    std::size_t dropped = 0;
    for (int round = 0; round < 3; ++round) {
        const std::size_t more = drop_accidents_of(records_, train_, *experiment_, null_noise_);
        dropped += more;
        if (more == 0) {
            break;
        }
        fit_null();
    }
    if (dropped > 0) {
        warn(core::counted(dropped, "gap reading lies", "gap readings lie") +
             " more than six standard deviations from what the motion before and after says: not used");
    }
    // the same for what is held out, with the noise that was found
    HeaveRecords& records = test_records_ ? *test_records_ : records_;
    if (test_ != train_ || test_records_) {
        const HeaveExperiment test(model_, records, test_, null_noise_.gap, {});
        for (int round = 0; round < 3; ++round) {
            drop_accidents_of(records, test_, test, null_noise_);
        }
    }
}

void HeaveLoop::set_null(HeaveNoise noise) {
    experiment_->fit_process({}, noise);
    null_noise_ = noise;
    null_by_record_.clear();
    null_cost_ = experiment_->evaluate({}, nullptr, null_noise_, null_innovations_, &null_by_record_);
}

HeaveExperiment::Result HeaveLoop::fitted(const Hypothesis& hypothesis, const HeaveNoise& begin) const {
    HeaveExperiment::Result result = experiment_->fit(hypothesis, begin);
    result.fitted.explained = null_cost_ - result.fitted.cost;
    const FitParameter& chief = hypothesis.parameters.front();
    if (result.fitted.fit.parameters.front() >= chief.upper - 1e-9 * std::abs(chief.upper)) {
        result.fitted.hypothesis.prior *=
            1e-4;  // driven against the bound of what physics allows: it stands in for something else
    }
    result.fitted.explained_by_group = null_by_record_;
    for (std::size_t r = 0; r < null_by_record_.size(); ++r) {
        result.fitted.explained_by_group[r] -= result.fitted.cost_of_group[r];
    }
    return result;
}

void HeaveLoop::list_candidates() {
    std::vector<dynamics::Channel> varying;
    const dynamics::Conditions& first = records_.records.front().plant->held();
    for (std::size_t c = 0; c < dynamics::channel_count; ++c) {
        const auto channel = static_cast<dynamics::Channel>(c);
        if (std::any_of(records_.records.begin(), records_.records.end(), [&](const HeaveRecord& record) {
                return std::abs(record.plant->held().get(channel, 0) - first.get(channel, 0)) >
                       1e-3 * std::abs(first.get(channel, 0));
            })) {
            varying.push_back(channel);
        }
    }
    candidates_ = heave_hypotheses(model_, varying);
    if (!records_.input_recorded) {
        // a motion without input that is seen later is a motion without input: only a velocity beside the gap could
        // tell
        std::erase_if(candidates_, [&](const Hypothesis& h) {
            const Touch touch = touch_of(h, model_);
            return touch.input || (touch.reading_late && !records_.velocity_measured);
        });
    }
    keep_shapes_inside();
    for (Hypothesis& candidate : candidates_) {
        if (is_scanned(candidate)) {
            candidate.starts = experiment_->periodic_starts({}, null_noise_, 3);
            std::erase_if(candidate.starts,
                          [&](const std::vector<double>& start) { return start[1] < candidate.parameters[1].lower; });
        }
    }
    std::erase_if(candidates_, [](const Hypothesis& h) { return is_scanned(h) && h.starts.empty(); });
    keep_only(candidates_, options_.candidates);
}

/// A wave of which no run shows a few cycles, or an inertia that grows only far below every gap that was visited, is
/// none that these runs can show: it would pass for any slow change.
void HeaveLoop::keep_shapes_inside() {
    double lowest = 1e300;
    for (const std::size_t r : train_) {
        for (const double gap : records_.records[r].gap) {
            lowest = std::isfinite(gap) ? std::min(lowest, gap) : lowest;
        }
    }
    const double slowest = 2 * experiment_->lowest_frequency();  // four cycles of the longest run
    std::erase_if(candidates_, [&](Hypothesis& candidate) {
        for (std::size_t j = 0; j < candidate.parameters.size(); ++j) {
            FitParameter& parameter = candidate.parameters[j];
            const dynamics::EffectUse& use = candidate.uses[candidate.slots[j].use];
            if (is_scanned(candidate) && j == 1) {  // its frequency
                parameter.lower = std::max(parameter.lower, slowest);
                parameter.start = std::max(parameter.start, slowest);
            } else if (dynamics::effect(use.name).info().parameters[candidate.slots[j].value].within_gaps) {
                parameter.lower = std::max(parameter.lower, 0.1 * lowest);
                parameter.start = std::max(parameter.start, parameter.lower);
            }
            if (parameter.lower >= parameter.upper) {
                return true;
            }
        }
        return false;
    });
}

void HeaveLoop::fit_singles() {
    if (candidates_.empty()) {
        list_candidates();
    }
    fitted_.assign(candidates_.size(), {});
    noises_.assign(candidates_.size(), {});
    core::parallel_for(
        candidates_.size(),
        [&](std::size_t i) {
            HeaveExperiment::Result result = fitted(candidates_[i], null_noise_);
            fitted_[i] = std::move(result.fitted);
            noises_[i] = result.noise;
        },
        progress_);
    singles_ = fitted_.size();
    best_single_ = best_hypothesis(fitted_, 1);
}

/// Is the recorded input held from sample to sample, or linear between? Half a sample of delay hangs on it. Asked of
/// the data only where the model does not say.
void HeaveLoop::try_hold() {
    using Between = dynamics::RecordReading::Between;
    if (!records_.input_recorded || records_read_.input_between != Between::unsaid) {
        return;
    }
    const auto linear_by = [&](double held, double linear) {
        return dynamics::between_samples(records_read_.input_between, held, linear) == Between::linear;
    };
    const FittedHypothesis& best = fitted_[best_single_];
    std::vector<double> innovations;
    experiment_->set_hold(false);
    const double linear =
        experiment_->evaluate(best.hypothesis.with(best.fit.parameters), nullptr, noises_[best_single_], innovations);
    // the noise of the held null model may hold what the hold itself does wrong
    const double null_linear = std::min(experiment_->evaluate({}, nullptr, null_noise_, innovations),
                                        experiment_->evaluate({}, nullptr, noises_[best_single_], innovations));
    // What half a sample of delay does to a controlled body looks like damping: where a linear input leaves nothing to
    // that name, there is no effect.
    const bool explains_without_effect = linear_by(null_cost_, null_linear) && null_linear < best.cost;
    if (explains_without_effect || (linear_by(best.cost, linear) && !linear_by(null_linear, null_cost_))) {
        null_by_record_.clear();
        fit_null();
        fit_singles();
        return;
    }
    experiment_->set_hold(true);
}

/// Coloured sensor noise would pass for an effect, and an effect for coloured noise: it was looked for beside the
/// declared model, now beside the best explanation; if the answer is another one, everything is judged again.
void HeaveLoop::colour_noise() {
    for (int round = 0; round < 2; ++round) {
        HeaveNoise noise = noises_[best_single_];
        const FittedHypothesis& best = fitted_[best_single_];
        const double before = null_noise_.slow;
        const bool coloured = experiment_->fit_noise(best.hypothesis.with(best.fit.parameters), noise);
        if (!coloured && before == 0) {
            return;
        }
        if (coloured && before > 0 && noise.slow < 1.6 * before && noise.slow > before / 1.6) {
            return;
        }
        HeaveNoise null = noise;
        null.process = null_noise_.process;
        if (!coloured) {
            null.gap = experiment_->noise().gap;
        }
        set_null(null);
        fit_singles();
    }
}

/// A shift in time below a sample is how the log was written (held, linear, stamped before or after), no effect: the
/// record is read so, and everything is judged again.
void HeaveLoop::absorb_small_shift() {
    const FittedHypothesis& best = fitted_[best_single_];
    const double shift = best.fit.parameters.front();
    const bool in_time = touch_of(best.hypothesis, model_).time;
    if (!records_.input_recorded || !in_time || std::abs(shift) >= records_.raw_step || best.explained < 10) {
        return;
    }
    change_input(shift, 1);
    records_read_.input_advance -= shift;
    const double before = null_cost_;
    const HeaveNoise noise = null_noise_;
    fit_null();
    if (null_cost_ > before) {
        change_input(-shift, 1);
        records_read_.input_advance += shift;
        set_null(noise);
        return;
    }
    result_.problems.push_back({core::Problem::Severity::note,
                                "input_force and gap are " + core::format_number(1000 * shift, 3) +
                                    " ms apart, less than a sample: read so, and no finding",
                                core::Place{data_.folder.string(), {}, {}, {}}});
    fit_singles();
    colour_noise();
}

/// How logs like these are to be read: what model.toml says of them, so that a prediction reads them as this did.
dynamics::RecordReading HeaveLoop::reading_found() const {
    dynamics::RecordReading reading = records_read_;
    if (records_.input_recorded) {
        using Between = dynamics::RecordReading::Between;
        reading.input_between = experiment_->hold() ? Between::held : Between::linear;
    }
    reading.velocity_factor *= records_.velocity_turned ? -1 : 1;
    return reading;
}

/// Moves the recorded input in time and scales it, in every record there is.
void HeaveLoop::change_input(double seconds, double factor) {
    const auto change = [&](HeaveRecords& records) {
        for (HeaveRecord& record : records.records) {
            for (double& t : record.raw_time) {
                t += seconds;
            }
            for (double& u : record.raw_input) {
                u *= factor;
            }
            prepare_input(record);
        }
    };
    change(records_);
    if (test_records_) {
        change(*test_records_);
    }
}

/// The effects that explain most alone, and that no other reading of the input could make up for: beside one of them a
/// wrong clock or sign of the input hides, since the effect explains more than it does.
std::vector<std::size_t> HeaveLoop::beside_the_input() const {
    constexpr std::size_t most = 3;
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < singles_; ++i) {
        const Touch touch = touch_of(fitted_[i].hypothesis, model_);
        if (!touch.time && !touch.gain) {
            list.push_back(i);
        }
    }
    std::sort(list.begin(), list.end(),
              [&](std::size_t a, std::size_t b) { return fitted_[a].score() < fitted_[b].score(); });
    list.resize(std::min(most, list.size()));
    return list;
}

double HeaveLoop::cost_with_input(double seconds, double times, const std::vector<std::size_t>& beside) {
    change_input(-seconds, times);
    HeaveNoise noise = null_noise_;
    double cost = experiment_->fit_process({}, noise);
    std::vector<double> innovations;
    std::size_t with = fitted_.size();
    double least_with = 1e300;
    for (const std::size_t i : beside) {
        // with the numbers of the input as it was recorded: a fit comes once the clock is nearly right
        const FittedHypothesis& one = fitted_[i];
        const double own =
            experiment_->evaluate(one.hypothesis.with(one.fit.parameters), nullptr, noises_[i], innovations) +
            one.occam;
        if (own < least_with) {
            least_with = own;
            with = i;
        }
    }
    if (with < fitted_.size() && least_with < cost && least_with < fitted_[with].score() - 10) {
        cost = std::min(cost, fitted(fitted_[with].hypothesis, null_noise_).fitted.score());
    }
    change_input(seconds, 1 / times);
    return cost;
}

/// An input that acts before it was commanded, or that is a thousand times off or turned round, is no effect but a
/// matter of the record.
HeaveLoop::InputReading HeaveLoop::better_input() {
    InputReading best;
    double least = fitted_[best_single_].score() - 40;
    const std::vector<std::size_t> beside = beside_the_input();
    const auto attempt = [&](double seconds, double times) {
        if (seconds < 0) {
            return;
        }
        const double cost = cost_with_input(seconds, times, beside);
        if (cost < least) {
            least = cost;
            best = {seconds, times};
        }
    };
    for (const double seconds : {0.02, 0.04, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0}) {
        attempt(seconds, 1);
    }
    // From the best of these half-way toward its neighbours and on: they lie up to twice as far apart.
    for (double step = std::max(0.02, best.early / 4); step > 0.002 && best.early > 0; step /= 2) {
        const double middle = best.early;
        attempt(middle - step, 1);
        attempt(middle + step, 1);
    }
    if (best.early == 0 && touch_of(fitted_[best_single_].hypothesis, model_).gain) {
        least += 60;  // the same said with a name; the slip is the likelier story
    }
    for (const double times : {1e-3, 1e3, -1.0}) {
        attempt(0, times);
    }
    return best;
}

namespace {

/// Nothing is known of what was commanded after the record's end.
void leave_out_what_follows(HeaveRecords& records) {
    for (HeaveRecord& record : records.records) {
        for (std::size_t k = 0; k < record.time.size(); ++k) {
            if (record.time[k] > record.raw_time.back() + 0.02) {
                record.gap[k] = std::nan("");
                if (!record.velocity.empty()) {
                    record.velocity[k] = std::nan("");
                }
            }
        }
    }
}

}  // namespace

void HeaveLoop::fit_again() {
    held_out_.reset();
    fit_null();
    fit_singles();
    try_hold();
    colour_noise();
    open_gate();
}

/// The declared model or the best single effect, whichever predicts the held-out runs better.
HeaveLoop::Answer HeaveLoop::best_answer() {
    Answer declared = answer_of({}, null_noise_);
    const FittedHypothesis& best = fitted_[best_single_];
    Answer named = answer_of(best.hypothesis.with(best.fit.parameters), noises_[best_single_]);
    return held_out_error(named) < held_out_error(declared) ? named : declared;
}

void HeaveLoop::check_input() {
    if (!records_.input_recorded) {
        return;
    }
    const bool hold = experiment_->hold();
    if (records_read_.input_between == dynamics::RecordReading::Between::unsaid) {
        experiment_->set_hold(true);  // whether it is held between samples was asked of an input that may be wrong
    }
    const auto [early, factor] = better_input();
    if (early == 0 && factor == 1) {
        experiment_->set_hold(hold);
        return;
    }
    // A factor can be said with a name or a law of the input as well: the slip is the likelier story there.
    const bool clock = factor == 1;
    const Answer before = clock ? best_answer() : answer_of({}, null_noise_);
    std::optional<Answer> law;
    if (clock) {
        smooth_corrections();
        law = smooth_answer();
    }
    const HeaveRecords as_logged = records_;
    const std::optional<HeaveRecords> test_as_logged = test_records_;
    change_input(-early, factor);
    leave_out_what_follows(records_);
    if (test_records_) {
        leave_out_what_follows(*test_records_);
    }
    fit_again();
    const Answer after = best_answer();
    if (!falls(before, after) || (law && !falls(*law, after))) {  // it made up for something else
        records_ = as_logged;
        test_records_ = test_as_logged;
        experiment_->set_hold(hold);
        fit_again();
        return;
    }
    records_read_.input_advance += early;
    records_read_.input_factor *= factor;
    result_.mended = clock ? "input_force " + core::format_number(early, 2) + " s earlier"
                           : "input_force times " + core::format_number(factor, 4);
    if (clock) {
        warn("the recorded input comes about " + core::format_number(early, 2) +
             " s after the motion that it makes: the clocks of input_force and gap differ, or the vehicle has a law "
             "that leads as much; the input was moved forward by that much");
    } else {
        warn("the motion fits an input_force " + core::format_number(factor, 4) + " times the recorded one: " +
             (factor < 0 ? "its sign is turned round (up is positive)" : "its unit is wrong by a thousand") +
             "; it was used so");
    }
}

Discovery discover_heave(const dynamics::Model& model, const dynamics::Measurements& data,
                         const DiscoverOptions& options, core::Progress& progress) {
    return HeaveLoop(model, data, options, progress).run();
}

}  // namespace underbody::discovery
