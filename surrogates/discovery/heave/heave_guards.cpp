// What a heave verdict may say: judged by runs that nothing was fitted to, beside twins in which nothing is missing.
#include <algorithm>
#include <cmath>
#include <limits>

#include "surrogates/discovery/heave/heave_error.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr std::size_t blocks_wanted = 12;  ///< of held-out runs: enough for Student's t, each of several windows

}  // namespace

const HeaveExperiment& HeaveLoop::held_out_runs() {
    if (!held_out_) {
        const HeaveRecords& records = test_records_ ? *test_records_ : records_;
        held_out_.emplace(model_, records, test_, data_.declared_noise("gap"), data_.declared_noise("heave_velocity"));
        held_out_->set_hold(experiment_->hold());
    }
    return *held_out_;
}

std::vector<double> HeaveLoop::horizons() const {
    return {options_.horizon, 5 * options_.horizon, std::numeric_limits<double>::infinity()};
}

HeaveLoop::Answer HeaveLoop::answer_of(const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise) {
    Answer answer{uses, noise, {}, {}};
    const HeaveExperiment& test = held_out_runs();
    for (const double horizon : horizons()) {
        answer.windows.push_back(window_errors(test, uses, noise, horizon));
    }
    return answer;
}

double HeaveLoop::held_out_error(const Answer& answer) const {
    return answer.windows.front().by_record(test_.size()).rmse();
}

/// The model as declared with whichever filter serves it better: an error that only the filter's noise makes is none of
/// the model.
HeaveLoop::Answer HeaveLoop::declared_answer(const HeaveNoise& other) {
    Answer own = answer_of({}, null_noise_);
    Answer with_other = answer_of({}, other);
    return held_out_error(with_other) < held_out_error(own) ? with_other : own;
}

bool HeaveLoop::falls(const Answer& before, const Answer& after) const {
    const auto fall = [&](std::size_t horizon, double tail) {
        return paired_fall(before.windows[horizon].blocks(test_.size(), blocks_wanted),
                           after.windows[horizon].blocks(test_.size(), blocks_wanted), tail);
    };
    const PairedFall chief = fall(0, calibration_.fall_tail);
    if (chief.falls()) {
        return true;
    }
    // slow effects show over longer predictions: there as well, with the price of three looks
    return !chief.rises() && chief.mean > 0 &&
           (fall(1, calibration_.fall_tail / 4).falls() || fall(2, calibration_.fall_tail / 4).falls());
}

/// Where the declared model leaves more than noise, one block may show most of it (a film that is met once, a force at
/// the end of a run): of the differences of roots such a block is the scatter, of squares it counts in full.
bool HeaveLoop::falls_in_few_blocks(const Answer& before, const Answer& after) {
    const double unit = held_out_error(before);
    const auto errors = [&](const Answer& answer) {
        return errors_of(answer.windows.front().blocks(test_.size(), blocks_wanted), unit);
    };
    return !rest_is_noise(before) && paired_fall(errors(before), errors(after), calibration_.fall_tail).falls();
}

bool HeaveLoop::rest_is_noise(const Answer& answer) {
    const double twins = twins_error(held_out_runs(), answer.uses, answer.noise);
    const double error = held_out_error(answer);
    result_.rest.twins = twins;
    result_.rest.unexplained = std::sqrt(std::max(0.0, error * error - twins * twins));
    return error <= calibration_.most_over_twins * twins;
}

double HeaveLoop::share_left(const Answer& declared, const Answer& answer) const {
    const double noise = result_.rest.twins * result_.rest.twins;
    const double missed = std::pow(held_out_error(declared), 2) - noise;
    const double left = std::pow(held_out_error(answer), 2) - noise;
    return missed > 0 ? std::max(left, 0.0) / missed : 0;
}

std::optional<HeaveLoop::Answer> HeaveLoop::smooth_answer() {
    // a table over time says nothing of another run
    std::vector<HeaveExperiment::Smooth> usable;
    std::copy_if(whole_list_.begin(), whole_list_.end(), std::back_inserter(usable), [](const auto& one) {
        const auto& variables = one.set.variables;
        return !variables.empty() && std::find(variables.begin(), variables.end(), Variable::time) == variables.end();
    });
    if (usable.empty() || best_smooth(whole_list_).set.variables.empty()) {
        return {};
    }
    const std::vector<Variable>& likeliest = best_smooth(whole_list_).set.variables;
    if (std::find(likeliest.begin(), likeliest.end(), Variable::time) != likeliest.end()) {
        return {};  // nor does one over what follows time through the controller
    }
    const HeaveExperiment::Smooth smooth = refined(best_smooth(usable));
    Answer answer = answer_of({force_table(smooth.force, largest_force(smooth))}, smooth.noise);
    answer.variables = smooth.fit.variables;
    return answer;
}

double HeaveLoop::largest_force(const HeaveExperiment::Smooth& smooth) const {
    std::vector<double> forces, innovations, states, input;
    for (const std::size_t r : experiment_->chosen()) {
        const HeaveRecord& record = records_.records[r];
        const HeaveExplanation with = experiment_->explanation(r, {}, &smooth.force);
        innovations.clear();
        states.clear();
        filter_innovations(record, with, smooth.noise, innovations, &states);
        transform_input(record, with, input);
        for (std::size_t k = 0; k < record.time.size(); ++k) {
            forces.push_back(std::abs(smooth.force(states[2 * k], states[2 * k + 1], record.time[k], input[k])));
        }
    }
    return quantile(forces, calibration_.correction_reach);
}

/// Guards the verdict of the likelihoods: a name needs a held-out error that falls, and a name and "none" a rest that
/// is noise.
void HeaveLoop::guard() {
    Answer declared = answer_of({}, null_noise_);
    Answer kept = declared;
    bool quiet_rest = true;
    if (result_.verdict == "effect") {
        const FittedHypothesis& chosen = fitted_[attribution_.chosen];
        const Answer named = answer_of(found_effect(chosen, 1).uses, noises_[attribution_.chosen]);
        declared = declared_answer(named.noise);
        if (!falls(declared, named) && !falls_in_few_blocks(declared, named)) {
            refuse(chosen.hypothesis.label() +
                   " would explain the fitted runs better, but the held-out error does not fall with it beyond its "
                   "interval: it is not named");
        } else if (quiet_rest = rest_is_noise(named); !quiet_rest) {
            std::optional<Answer> smooth = smooth_answer();
            const bool better = smooth && falls(named, *smooth);
            if (better || share_left(declared, named) > calibration_.most_left) {
                result_.verdict = "unknown";
                give_to_unknown(attribution_, calibration_.given_to_unknown);
                if (better) {
                    kept = std::move(*smooth);
                }
            } else {
                kept = named;
            }
        } else {
            kept = named;
        }
    }
    if (result_.verdict == "unknown" && kept.uses.empty()) {
        std::optional<Answer> smooth = smooth_answer();
        declared = smooth ? declared_answer(smooth->noise) : declared;
        if (smooth && falls(declared, *smooth)) {
            kept = std::move(*smooth);
        } else {
            cap_probabilities(attribution_, calibration_.left_undecided);
        }
    }
    if (result_.verdict != "effect" || kept.uses.empty()) {
        quiet_rest = rest_is_noise(kept);
    }
    if (result_.verdict == "none" && result_.by_run) {
        call_runs_unlike();
    } else if (result_.verdict == "none" && !quiet_rest) {
        call_rest_unknown(kept, declared);
        quiet_rest = rest_is_noise(kept);
    }
    if (result_.verdict == "unknown" && kept.uses.empty() && !result_.by_run) {
        look_run_by_run();  // what no law of all runs explains may be a number that each has of its own
    }
    if (result_.verdict != "unknown" || !kept.uses.empty()) {
        result_.by_run.reset();
    }
    result_.rest.is_noise = quiet_rest;
    if (!kept.variables.empty()) {
        whole_.variables = kept.variables;
    }
    if (!quiet_rest) {
        result_.rest.depends_on = result_.verdict == "effect" ? rest_.fit.variables : whole_.variables;
    }
    uses_ = kept.uses;
    after_noise_ = kept.noise;
    declared_noise_ = declared.noise;
}

/// No name: silent, until the rest is found to be more than noise.
void HeaveLoop::refuse(const std::string& reason) {
    warn(reason);
    hold_names_down(attribution_, calibration_.left_undecided);
    result_.verdict = "none";
    result_.none_probability = attribution_.none_probability;
}

/// Each run may be predicted as well as its twins, since the filter finds where it begins, and they still contradict
/// each other: something is missing, and no one number is true of all.
void HeaveLoop::call_runs_unlike() {
    result_.verdict = "unknown";
    whole_.variables = {variable_name(Variable::time)};
    rule_out_none(attribution_, 1 - result_.by_run->chance);
    result_.none_probability = 0;
}

/// The declared model predicts worse than its twins do: something is missing, whatever the likelihoods say.
void HeaveLoop::call_rest_unknown(Answer& kept, Answer& declared) {
    result_.verdict = "unknown";
    if (whole_list_.empty()) {
        smooth_corrections();
    }
    if (std::optional<Answer> smooth = smooth_answer()) {
        Answer better = declared_answer(smooth->noise);
        if (falls(better, *smooth)) {
            kept = std::move(*smooth);
            declared = std::move(better);
        }
    }
    if (kept.uses.empty() && (whole_.variables.empty() || gate_ >= calibration_.gate)) {
        whole_.variables = {variable_name(Variable::time)};  // as a random force would: no variable explains it
    }
    rule_out_none(attribution_, kept.uses.empty() ? calibration_.left_undecided : calibration_.given_to_unknown);
    result_.none_probability = 0;
}

}  // namespace underbody::discovery
