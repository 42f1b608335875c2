// What a heave verdict is told with: error before and after, rivals, limits, and doubts about the data.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text.h"
#include "surrogates/discovery/heave/heave_error.h"
#include "surrogates/discovery/heave/heave_experiment_design.h"
#include "surrogates/discovery/heave/heave_figures.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::discovery {

void HeaveLoop::warn(const std::string& text) {
    result_.problems.push_back(
        {core::Problem::Severity::warning, text, core::Place{data_.folder.string(), {}, {}, {}}});
}

/// By predict(), so that the error is that of the command, of the model as declared and as written.
void HeaveLoop::measure_error() {
    double last = 0;
    for (const double horizon : horizons()) {
        const PredictedWindows before = predicted_windows(model_, test_data_, horizon, "gap", progress_);
        const PredictedWindows after = predicted_windows(result_.model, test_data_, horizon, "gap", progress_);
        if (before.horizon == last || before.windows.record.empty() || after.windows.record.empty()) {
            continue;  // no run is as long
        }
        last = before.horizon;
        const auto estimate = [&](const PredictedWindows& one) {
            const BlockSquares sums = one.windows.by_record(test_data_.runs.size());
            return error_by_groups(sums.square, sums.count, options_.seed);
        };
        ErrorChange change;
        change.channel = std::string("gap");
        change.unit = std::string("m");
        change.horizon = before.horizon;
        // As predict has it: a declared figure holds unless the readings themselves scatter by more. What the gap
        // wanders by beside it is noise as well, where nothing is declared.
        const auto declared = data_.declared_noise("gap");
        change.noise = dynamics::unit_of_errors(
            declared, declared ? records_.gap_noise : std::hypot(null_noise_.gap, null_noise_.slow));
        change.before = estimate(before);
        change.after = estimate(after);
        if (std::isfinite(change.before.rmse) && std::isfinite(change.after.rmse)) {
            result_.error.push_back(change);
        }
    }
    if (!result_.error.empty() && !result_.rest.is_noise) {
        // windows begun from a filter that expects a random force miss more than predict does: no more than that is
        // left
        const double left = result_.error.front().after.rmse, twins = result_.rest.twins;
        result_.rest.is_noise = left <= calibration_.most_over_twins * twins;
        result_.rest.unexplained =
            std::min(result_.rest.unexplained, std::sqrt(std::max(0.0, left * left - twins * twins)));
    }
    const HeaveExperiment& test = held_out_runs();
    result_.consequence.estimator_before = estimator_error(test, {}, declared_noise_, uses_, after_noise_);
    result_.consequence.estimator_after = uses_.empty()
                                              ? result_.consequence.estimator_before
                                              : estimator_error(test, uses_, after_noise_, uses_, after_noise_);
}

void HeaveLoop::describe() {
    const bool coloured = null_noise_.slow > 0;
    result_.noise["gap"] = {
        std::hypot(null_noise_.gap, null_noise_.slow), "m",
        experiment_->gap_noise_from() +
            (coloured ? ", of which " + core::format_number(null_noise_.gap, 3) + " m white and " +
                            core::format_number(null_noise_.slow, 3) + " m with a correlation time of " +
                            core::format_number(null_noise_.slow_time, 2) + " s"
                      : ""),
        records_.gap_noise};
    if (records_.velocity_measured) {
        result_.noise["heave_velocity"] = {null_noise_.velocity, "m/s", experiment_->velocity_noise_from(),
                                           records_.velocity_noise};
    }
    result_.stability = stability();
    tell({fitted_, attribution_, whole_, rest_.fit, rest_.share, uses_, "a smooth force", evidence_of_runs,
          [&](const FittedHypothesis& chosen, const FittedHypothesis& rival) {
              return heave_told_apart(*experiment_, chosen, rival);
          }},
         result_);
    next_heave_experiment(*experiment_, fitted_, attribution_, result_);
    for (const core::Problems* list :
         std::initializer_list<const core::Problems*>{&data_.problems, &records_.problems, &experiment_->problems()}) {
        result_.problems.insert(result_.problems.end(), list->begin(), list->end());
    }
    check_excitation();
    check_runs_agree();
    if (options_.consequence) {
        Consequence found = heave_consequence(model_, result_.model, records_, progress_);
        found.estimator_before = result_.consequence.estimator_before;
        found.estimator_after = result_.consequence.estimator_after;
        result_.consequence = std::move(found);
    }
    result_.sentence = verdict_sentence(result_);
    if (options_.figures) {
        result_.figures = heave_figures(*experiment_, null_noise_, uses_, result_);
    }
}

void HeaveLoop::check_excitation() {
    double widest = 0;
    for (const std::size_t r : train_) {
        const std::vector<double>& gap = records_.records[r].gap;
        std::vector<double> finite;
        std::copy_if(gap.begin(), gap.end(), std::back_inserter(finite), [](double x) { return std::isfinite(x); });
        widest = std::max(widest, quantile(finite, 0.95) - quantile(finite, 0.05));
    }
    if (widest < 20 * null_noise_.gap) {
        result_.problems.push_back(
            {core::Problem::Severity::warning,
             "the body hardly moves in any run (" + core::format_number(1000 * widest, 2) +
                 " mm): effects of velocity, acceleration and gap cannot be seen; only constant ones can",
             core::Place{data_.folder.string(), {}, {}, {}}});
    }
}

void HeaveLoop::check_runs_agree() {
    const auto fits_best =
        std::min_element(fitted_.begin(), fitted_.begin() + static_cast<std::ptrdiff_t>(singles_),
                         [](const auto& a, const auto& b) { return a.cost + a.occam < b.cost + b.occam; });
    const auto fitted_best = static_cast<std::size_t>(fits_best - fitted_.begin());
    const std::size_t chosen = result_.verdict == "effect" ? attribution_.chosen : best_single_;
    // what fits all runs best together may have lost because it fails from run to run
    if (runs_agree_on(chosen) && fitted_best != chosen) {
        runs_agree_on(fitted_best);
    }
}

/// The strength of an effect run by run: where runs disagree far beyond their errors, no one number is true of all of
/// them. Warns.
bool HeaveLoop::runs_agree_on(std::size_t index) {
    const FittedHypothesis& best = fitted_[index];
    const DesignMatrix columns =
        experiment_->answers(best.hypothesis, best.fit.parameters, noises_[index], best.fit.residuals);
    const std::vector<std::size_t> begin = experiment_->begins();
    const FitParameter& chief = best.hypothesis.parameters.front();
    std::vector<double> own, error;
    for (std::size_t g = 0; g + 1 < begin.size(); ++g) {
        double jj = 0;
        double jr = 0;
        for (std::size_t i = begin[g]; i < begin[g + 1]; ++i) {
            jj += columns.values[i] * columns.values[i];
            jr += columns.values[i] * best.fit.residuals[i];
        }
        own.push_back(best.fit.parameters.front() - (jj > 0 ? jr / jj : 0) * chief.typical);
        error.push_back(jj > 0 ? chief.typical / std::sqrt(jj) : 1e300);
    }
    if (own.size() < 2) {
        return true;
    }
    const double middle = median(own);
    const double size = std::max(std::abs(middle - chief.start), 3 * median(error));
    std::string against;
    for (std::size_t g = 0; g < own.size(); ++g) {
        if (std::abs(own[g] - middle) > 8 * error[g] && std::abs(own[g] - middle) > 0.7 * size) {
            against += (against.empty() ? "" : ", ") + records_.records[train_[g]].name + " (" +
                       core::format_number(own[g], 2) + " +- " + core::format_number(error[g], 2) + ")";
        }
    }
    if (!against.empty()) {
        warn("the runs contradict each other: the " + chief.name + " of " + best.hypothesis.label() + " is " +
             core::format_number(middle, 2) + (chief.unit == "1" ? "" : " " + chief.unit) + " in most, but not in " +
             against + "; look at these runs apart");
    }
    return against.empty();
}

}  // namespace underbody::discovery
