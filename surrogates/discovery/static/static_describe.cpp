// What a static verdict is told with: error before and after, rivals, limits, and doubts about the data.
#include <algorithm>

#include "core/counted.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/static/static_checks.h"
#include "surrogates/discovery/static/static_consequence.h"
#include "surrogates/discovery/static/static_experiment_design.h"
#include "surrogates/discovery/static/static_figures.h"
#include "surrogates/discovery/static/static_loop.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

void StaticLoop::measure_error() {
    const StaticExperiment& experiment = held_out_experiment();
    const std::vector<std::size_t> chosen = held_out_readings();
    for (std::size_t q = 0; q < experiment.quantities().size(); ++q) {
        std::vector<double> before(experiment.set_points(), 0);
        std::vector<double> after = before;
        std::vector<double> count = before;
        double noise = 0;
        for (const std::size_t i : chosen) {
            const Observation& one = experiment.observations()[i];
            if (one.quantity == q) {
                const double b = one.value - experiment.predict(one, {});
                const double a = one.value - experiment.predict(one, uses_);
                before[one.set_point] += b * b;
                after[one.set_point] += a * a;
                count[one.set_point] += 1;
                noise = experiment.sigma(one);
            }
        }
        ErrorChange change;
        change.channel = experiment.quantities()[q];
        change.unit = core::find_quantity(change.channel)->unit;
        change.before = error_by_groups(before, count, options_.seed);
        change.after = uses_.empty() ? change.before : error_by_groups(after, count, options_.seed);
        change.noise = noise;
        result_.error.push_back(change);
    }
    std::stable_sort(result_.error.begin(), result_.error.end(), [](const ErrorChange& a, const ErrorChange& b) {
        return a.before.rmse / core::never_zero(a.noise) > b.before.rmse / core::never_zero(b.noise);
    });
    if (!result_.error.empty()) {
        result_.rest.twins = result_.error.front().noise;
        result_.rest.unexplained = rest_in_noise_ * result_.error.front().noise;
    }
}

std::string StaticLoop::evidence(const FittedHypothesis& one) const {
    const double structure = std::max({whole_.gain, one.explained, least_gain});
    return "explains " + core::format_number(100 * std::max(0.0, one.explained) / structure, 3) +
           " % of the structure in the residual (fall of -2 log likelihood " + core::format_number(one.explained, 4) +
           " for " + core::counted(one.hypothesis.parameters.size(), "free number") + ")" +
           (one.hypothesis.form.empty() ? "" : "; " + one.hypothesis.form);
}

void StaticLoop::describe() {
    result_.stability = stability();
    const double explained = attribution_.chosen < fitted_.size() ? fitted_[attribution_.chosen].explained : 0;
    tell({fitted_, attribution_, whole_, rest_, structure_left(rest_, explained), uses_, "a smooth correction",
          [&](const FittedHypothesis& one) { return evidence(one); },
          [&](const FittedHypothesis& chosen, const FittedHypothesis& rival) {
              return static_told_apart(experiment_, chosen, rival);
          }},
         result_);
    next_static_experiment(experiment_, fitted_, attribution_, options_.seed, result_);
    result_.problems.insert(result_.problems.end(), data_.problems.begin(), data_.problems.end());
    result_.problems.insert(result_.problems.end(), experiment_.problems().begin(), experiment_.problems().end());
    const core::Problems odd = check_static_data(experiment_, data_);
    result_.problems.insert(result_.problems.end(), odd.begin(), odd.end());
    std::vector<double> left;
    for (const std::size_t i : train_) {
        const Observation& one = experiment_.observations()[i];
        left.push_back((one.value - experiment_.predict(one, uses_)) / experiment_.sigma(one));
    }
    const core::Problems apart = check_runs_agree(experiment_, data_, train_, left);
    result_.problems.insert(result_.problems.end(), apart.begin(), apart.end());
    if (options_.consequence) {
        result_.consequence = static_consequence(model_, uses_, experiment_, progress_);
    }
    result_.sentence = verdict_sentence(result_);
    if (options_.figures) {
        result_.figures = static_figures(experiment_, train_, uses_, result_);
    }
}

}  // namespace underbody::discovery
