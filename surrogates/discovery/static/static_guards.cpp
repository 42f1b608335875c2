// What a static verdict may say: judged by set points that nothing was fitted to.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/static/static_loop.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

using dynamics::Channel;

const StaticExperiment& StaticLoop::held_out_experiment() const {
    return test_experiment_ ? *test_experiment_ : experiment_;
}

std::vector<std::size_t> StaticLoop::held_out_readings() const {
    if (!test_experiment_) {
        return test_.empty() ? train_ : test_;
    }
    std::vector<std::size_t> all(test_experiment_->observations().size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
}

BlockErrors StaticLoop::held_out_errors(const std::vector<dynamics::EffectUse>& uses) const {
    const StaticExperiment& experiment = held_out_experiment();
    BlockErrors errors{std::vector<std::vector<double>>(experiment.set_points())};
    for (const std::size_t i : held_out_readings()) {
        const Observation& one = experiment.observations()[i];
        if (!one.accident) {
            errors.blocks[one.set_point].push_back((one.value - experiment.predict(one, uses)) / experiment.sigma(one));
        }
    }
    return errors;
}

BlockErrors StaticLoop::unseen_errors(const std::vector<dynamics::EffectUse>& whole, const FitOn& fit_on) const {
    constexpr std::size_t folds = 4;
    BlockErrors errors = held_out_errors(whole);
    const std::size_t first = errors.blocks.size();
    errors.blocks.resize(first + experiment_.set_points());
    for (std::size_t fold = 0; fold < folds; ++fold) {
        const auto left_out = [&](std::size_t i) { return experiment_.observations()[i].set_point % folds == fold; };
        std::vector<std::size_t> inside;
        std::remove_copy_if(train_.begin(), train_.end(), std::back_inserter(inside), left_out);
        const std::vector<dynamics::EffectUse> uses = fit_on(inside);
        for (const std::size_t i : train_) {
            const Observation& seen = experiment_.observations()[i];
            if (left_out(i)) {
                errors.blocks[first + seen.set_point].push_back((seen.value - experiment_.predict(seen, uses)) /
                                                                experiment_.sigma(seen));
            }
        }
    }
    return errors;
}

BlockErrors StaticLoop::unseen_errors(const FittedHypothesis* one) const {
    using Uses = std::vector<dynamics::EffectUse>;
    return unseen_errors(one != nullptr ? one->hypothesis.with(one->fit.parameters) : Uses{},
                         [&](const std::vector<std::size_t>& inside) {
                             return one != nullptr
                                        ? one->hypothesis.with(experiment_.fit(one->hypothesis, inside).fit.parameters)
                                        : Uses{};
                         });
}

/// A quarter of the set points alone misses effects of the size of the noise.
bool StaticLoop::falls(const FittedHypothesis* before, const FittedHypothesis& after) const {
    const PairedFall held_out =
        paired_fall(held_out_errors(before != nullptr ? before->hypothesis.with(before->fit.parameters)
                                                      : std::vector<dynamics::EffectUse>{}),
                    held_out_errors(after.hypothesis.with(after.fit.parameters)), calibration_.fall_tail);
    return held_out.falls() ||
           (held_out.mean > 0 &&
            paired_fall(unseen_errors(before), unseen_errors(&after), calibration_.fall_tail).falls());
}

/// The twins of a static set have readings of one standard deviation about the model as found.
bool StaticLoop::rest_is_noise(const BlockErrors& errors) const {
    return errors.rmse() <= calibration_.most_over_twins ||
           chi_squared_tail(errors.sum_of_squares(), static_cast<double>(errors.count())) > calibration_.rest_chance;
}

bool StaticLoop::correct(const FittedHypothesis* before) {
    const bool over_time = std::find(whole_.variables.begin(), whole_.variables.end(),
                                     dynamics::channel_name(Channel::time)) != whole_.variables.end();
    const std::vector<dynamics::EffectUse> kept = uses_;
    uses_.clear();
    if (!over_time && !whole_.variables.empty()) {
        const std::vector<std::size_t> quantities = quantities_to_correct();
        uses_ = correction_on(train_, quantities);
        const PairedFall held_out =
            paired_fall(held_out_errors(before != nullptr ? before->hypothesis.with(before->fit.parameters)
                                                          : std::vector<dynamics::EffectUse>{}),
                        held_out_errors(uses_), calibration_.fall_tail);
        const auto fit_on = [&](const std::vector<std::size_t>& inside) { return correction_on(inside, quantities); };
        if (!uses_.empty() &&
            (held_out.falls() ||
             (held_out.mean > 0 &&
              paired_fall(unseen_errors(before), unseen_errors(uses_, fit_on), calibration_.fall_tail).falls()))) {
            return true;
        }
    }
    uses_ = kept;
    return false;
}

bool StaticLoop::noise_figure_may_be_wrong() const {
    bool doubted = false;
    for (const auto& [quantity, figure] : experiment_.noise()) {
        if (figure.doubted && figure.estimated > calibration_.most_over_declared * figure.declared) {
            return false;
        }
        doubted = doubted || figure.doubted;
    }
    if (!doubted) {
        return false;
    }
    DiscoverOptions plain = options_;
    plain.figures = plain.consequence = false;
    plain.placebo_twins = 0;
    StaticLoop again(model_, data_, plain, progress_);
    again.overrule_noise_ = true;
    const Discovery seen = again.run();
    return seen.verdict == "none" && !seen.structure;
}

/// A name needs a held-out error that falls, and a name and "none" a rest that is noise.
void StaticLoop::guard() {
    uses_.clear();
    if (result_.verdict == "effect") {
        const FittedHypothesis& chosen = fitted_[attribution_.chosen];
        uses_ = found_effect(chosen, 1).uses;
        const BlockErrors named = held_out_errors(uses_);
        if (!falls(nullptr, chosen)) {
            uses_.clear();
            result_.verdict = "none";
            hold_names_down(attribution_, calibration_.left_undecided);
            result_.problems.push_back(
                {core::Problem::Severity::warning,
                 chosen.hypothesis.label() +
                     " would explain the fitted readings better, but the held-out error does not fall with it beyond "
                     "its interval: it is not named",
                 {}});
        } else if (!rest_is_noise(named) && correct(&chosen)) {
            result_.verdict = "unknown";
            give_to_unknown(attribution_, calibration_.given_to_unknown);
        }
    } else if (result_.verdict == "unknown" && !correct(nullptr)) {
        cap_probabilities(attribution_, calibration_.left_undecided);
    }
    result_.rest.is_noise = rest_is_noise(held_out_errors(uses_));
    if (result_.verdict == "none" && !result_.rest.is_noise) {
        result_.verdict = "unknown";
        rule_out_none(attribution_, correct(nullptr) ? calibration_.given_to_unknown : calibration_.left_undecided);
        result_.rest.is_noise = rest_is_noise(held_out_errors(uses_));
    }
    if (result_.verdict == "unknown" && uses_.empty() && noise_figure_may_be_wrong()) {
        result_.verdict = "none";
        result_.rest.or_noise_figure = true;
        give_to_none(attribution_, calibration_.left_undecided);
    }
    rest_in_noise_ = std::sqrt(std::max(0.0, std::pow(held_out_errors(uses_).rmse(), 2) - 1));
    result_.none_probability = attribution_.none_probability;
    if (!result_.rest.is_noise && !result_.rest.or_noise_figure) {
        result_.rest.depends_on = result_.verdict == "effect" ? rest_.variables : whole_.variables;
    }
}

}  // namespace underbody::discovery
