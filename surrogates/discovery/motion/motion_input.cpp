// Recorded inputs that come late, or of which one is turned round or a thousand times off: a matter of the record.
#include "surrogates/discovery/motion/motion_loop.h"

namespace underbody::discovery {

dynamics::RecordReading MotionLoop::with_inputs(dynamics::RecordReading reading, const InputReading& inputs) const {
    for (const std::string& column : inputs_) {
        (column == "input_force" ? reading.input_advance : reading.others_advance) += inputs.early;
    }
    if (!inputs.clock()) {
        reading.scale(inputs.column, inputs.factor);
    }
    return reading;
}

/// s: a quarter of the shortest run at most, for that much of its end is left out.
double MotionLoop::latest_looked_for() const {
    double latest = 2;
    for (const MotionRecord& record : experiment_->records()) {
        const std::vector<double>& time = data_.runs[record.run].table.numbers("time");
        latest = std::min(latest, (time.back() - time[record.first]) / 4);
    }
    return latest;
}

/// Of an effect with the numbers that it had, as the inputs are read now.
double MotionLoop::cost_alone(std::size_t single) const {
    const FittedHypothesis& one = fitted_[single];
    std::vector<double> innovations;
    return experiment_->evaluate(one.hypothesis.with(one.fit.parameters), noises_[single], innovations) + one.occam;
}

/// Of the likeliest explanation, as the inputs are read now; `before`: cost_alone() of each as they were logged.
double MotionLoop::cost_with_input(const std::vector<std::size_t>& beside, const std::vector<double>& before) {
    try {
        return least_cost(beside,
                          {[&] {
                               MotionNoise noise = null_noise_;
                               return experiment_->fit_process({}, noise);
                           },
                           [&](std::size_t i) { return cost_alone(i); }, [&](std::size_t i) { return before[i]; },
                           [&](std::size_t i) {
                               const FittedHypothesis& one = fitted_[i];
                               return fitted(one.hypothesis, {one.fit.parameters}, null_noise_).fitted.score();
                           }});
    } catch (const core::Cancelled&) {
        throw;
    } catch (const core::Error&) {
        return 1e300;  // with such inputs the body could not have moved as it did
    }
}

/// Every reading is judged by the same part of the logs.
InputReading MotionLoop::likeliest_inputs() {
    using Between = dynamics::RecordReading::Between;
    const dynamics::RecordReading as_logged = experiment_->reading();
    const double latest = latest_looked_for(), unused = std::max(0.0, as_logged.last_unknown()) + latest;
    experiment_->read(as_logged, unused);
    const std::vector<std::size_t> beside = beside_the_input(fitted_, candidate_of_.size(), model_);
    std::vector<double> before(fitted_.size(), 0);
    for (const std::size_t i : beside) {
        before[i] = cost_alone(i);
    }
    InputSearch search{.columns = inputs_,
                       .as_logged = cost_alone(best_single_),
                       .gain = touch_of(fitted_[best_single_].hypothesis, model_).gain,
                       .longest = latest};
    search.cost = [&](const InputReading& inputs) {
        dynamics::RecordReading reading = with_inputs(as_logged, inputs);
        if (model_.records.input_between == Between::unsaid) {
            reading.input_between = Between::held;  // it was asked of an input that may be wrong
        }
        experiment_->read(reading, unused);
        return cost_with_input(beside, before);
    };
    const InputReading found = better_input(search);
    experiment_->read(as_logged);
    return found;
}

void MotionLoop::fit_again() {
    result_.problems.erase(result_.problems.begin() + problems_before_fit_, result_.problems.end());
    fit_null();
    try_between();
    list_candidates();  // a wave begins at what is left
    fit_singles();
    noise_beside_best();
    open_gate();
}

namespace {

/// The runs up to so many seconds before their ends.
dynamics::Measurements without_ends(dynamics::Measurements data, double seconds) {
    for (dynamics::MeasuredRun& run : data.runs) {
        const std::vector<double>& time = run.table.numbers("time");
        std::vector<std::size_t> rows;
        for (std::size_t k = 0; k < time.size() && time[k] <= time.back() - seconds + 1e-9; ++k) {
            rows.push_back(k);
        }
        run.table = run.table.selected(rows);
    }
    return data;
}

}  // namespace

/// As in heave: kept only where the held-out error falls by it, and further than by a smooth law on the logs as they
/// are.
void MotionLoop::check_input() {
    if (inputs_.empty() || fitted_.empty()) {
        return;
    }
    const dynamics::RecordReading as_logged = experiment_->reading();
    const InputReading found = likeliest_inputs();
    if (found.as_logged()) {
        return;
    }
    // nothing is known of what acted in the end of a late record: neither reading is judged by it
    const dynamics::Measurements known = without_ends(test_data_, found.early);
    const auto best_answer = [&](const dynamics::Measurements& data) {
        const dynamics::RecordReading& reading = experiment_->reading();
        const FittedHypothesis& best = fitted_[best_single_];
        Answer declared = answer_of({}, options_.horizon, reading, data);
        Answer named = answer_of(best.hypothesis.with(best.fit.parameters), options_.horizon, reading, data);
        const std::size_t runs = test_data_.runs.size();
        const bool better = together(named).by_record(runs).rmse() < together(declared).by_record(runs).rmse();
        return better ? std::move(named) : std::move(declared);
    };
    // A factor can be said with a name or a law of the input as well: the slip is the likelier story there.
    const Answer before = found.clock() ? best_answer(known) : answer_of({}, options_.horizon);
    std::optional<Answer> law;
    if (found.clock()) {
        if (const std::optional<dynamics::EffectUse> force = smooth_force()) {
            law = answer_of({*force}, options_.horizon, as_logged, known);
        }
    }
    dynamics::RecordReading mended = with_inputs(as_logged, found);
    mended.input_between = model_.records.input_between;
    experiment_->read(mended);
    fit_again();
    const Answer after = best_answer(test_data_);
    if (!falls(before, after) || (law && !falls(*law, after))) {  // it made up for something else
        dynamics::RecordReading back = as_logged;
        back.input_between = model_.records.input_between;
        experiment_->read(back);
        fit_again();
        return;
    }
    result_.mended = mended_text(found, inputs_);
    warn(mended_warning(found, inputs_));
}

}  // namespace underbody::discovery
