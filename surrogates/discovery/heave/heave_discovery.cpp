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
    experiment_->fit_noise({}, noise, calibration_.colour_gain);
    set_null(noise);
}

namespace {

/// Steps whose gap is `far` standard deviations from what the filter expects while its neighbours are not.
std::vector<std::size_t> accidents(const HeaveRecord& record, const std::vector<double>& innovations, double far) {
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
                              const HeaveExperiment& experiment, const HeaveNoise& noise,
                              const Calibration& calibration) {
    std::size_t dropped = 0;
    for (const std::size_t r : chosen) {
        HeaveRecord& record = records.records[r];
        std::vector<double> innovations;
        filter_innovations(record, experiment.explanation(r, {}), noise, innovations);
        const std::vector<std::size_t> bad = accidents(record, innovations, calibration.accident_sigmas);
        if (static_cast<double>(bad.size()) < calibration.accident_share * static_cast<double>(record.time.size())) {
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
        const std::size_t more = drop_accidents_of(records_, train_, *experiment_, null_noise_, calibration_);
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
            drop_accidents_of(records, test_, test, null_noise_, calibration_);
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
        // driven against the bound of what physics allows: it stands in for something else
        result.fitted.hypothesis.prior *= calibration_.bound_prior;
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
    double lowest = 1e300;
    for (const std::size_t r : train_) {
        for (const double gap : records_.records[r].gap) {
            lowest = std::isfinite(gap) ? std::min(lowest, gap) : lowest;
        }
    }
    keep_shapes_inside(candidates_, lowest, lowest_frequency(experiment_->sampled()));
    begin_scanned(candidates_, [&] { return experiment_->periodic_starts({}, null_noise_, 3); });
    keep_only(candidates_, options_.candidates);
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
        const bool coloured =
            experiment_->fit_noise(best.hypothesis.with(best.fit.parameters), noise, calibration_.colour_gain);
        if (!coloured && before == 0) {
            return;
        }
        if (coloured && before > 0 && noise.slow < calibration_.colour_change * before &&
            noise.slow > before / calibration_.colour_change) {
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
    if (!records_.input_recorded || !in_time || std::abs(shift) >= records_.raw_step ||
        best.explained < calibration_.shift_gain) {
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

/// Cost of the likeliest explanation where the input is read so.
double HeaveLoop::cost_with_input(const InputReading& reading, const std::vector<std::size_t>& beside) {
    change_input(-reading.early, reading.factor);
    const double cost =
        least_cost(beside, {[&] {
                                HeaveNoise noise = null_noise_;
                                return experiment_->fit_process({}, noise);
                            },
                            [&](std::size_t i) {
                                const FittedHypothesis& one = fitted_[i];
                                std::vector<double> innovations;
                                return experiment_->evaluate(one.hypothesis.with(one.fit.parameters), nullptr,
                                                             noises_[i], innovations) +
                                       one.occam;
                            },
                            [&](std::size_t i) { return fitted_[i].score(); },
                            [&](std::size_t i) { return fitted(fitted_[i].hypothesis, null_noise_).fitted.score(); }});
    change_input(reading.early, 1 / reading.factor);
    return cost;
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
    const std::vector<std::string> columns{"input_force"};
    const std::vector<std::size_t> beside = beside_the_input(fitted_, singles_, model_);
    const FittedHypothesis& single = fitted_[best_single_];
    const InputReading found =
        better_input({.columns = columns,
                      .as_logged = single.score(),
                      .gain = touch_of(single.hypothesis, model_).gain,
                      .cost = [&](const InputReading& reading) { return cost_with_input(reading, beside); }});
    if (found.as_logged()) {
        experiment_->set_hold(hold);
        return;
    }
    // A factor can be said with a name or a law of the input as well: the slip is the likelier story there.
    const bool clock = found.clock();
    const Answer before = clock ? best_answer() : answer_of({}, null_noise_);
    std::optional<Answer> law;
    if (clock) {
        smooth_corrections();
        law = smooth_answer();
    }
    const HeaveRecords as_logged = records_;
    const std::optional<HeaveRecords> test_as_logged = test_records_;
    change_input(-found.early, found.factor);
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
    records_read_.input_advance += found.early;
    records_read_.input_factor *= found.factor;
    result_.mended = mended_text(found, columns);
    warn(mended_warning(found, columns));
}

Discovery discover_heave(const dynamics::Model& model, const dynamics::Measurements& data,
                         const DiscoverOptions& options, core::Progress& progress) {
    return HeaveLoop(model, data, options, progress).run();
}

}  // namespace underbody::discovery
