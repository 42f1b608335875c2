// From fitted effects to a verdict for static sets: the gate, pairs, what they leave, and how stable the answer is.
#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>

#include "core/no_limit.h"
#include "core/parallel.h"
#include "surrogates/discovery/guards.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/static/static_loop.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

using dynamics::Channel;

constexpr double trial_move = 0.1;  ///< of a typical value: the direction into which an effect moves the readings

std::vector<DesignMatrix> StaticLoop::directions() const {
    std::vector<DesignMatrix> list;
    std::vector<double> moved;
    for (std::size_t i = 0; i < singles_; ++i) {
        const Hypothesis& h = fitted_[i].hypothesis;
        DesignMatrix matrix;
        matrix.rows = train_.size();
        for (std::size_t j = 0; j < h.parameters.size(); ++j) {
            std::vector<double> p = h.start();
            const double move = trial_move * h.parameters[j].typical;
            p[j] += p[j] + move <= h.parameters[j].upper ? move : -move;
            experiment_.residuals(train_, h.with(p), moved);
            ++matrix.columns;
            for (std::size_t k = 0; k < moved.size(); ++k) {
                matrix.values.push_back(moved[k] - null_residuals_[k]);
            }
        }
        list.push_back(orthonormal(matrix));
    }
    return list;
}

void StaticLoop::open_gate() {
    structure_.emplace(experiment_, train_);
    whole_ = structure_->best(null_residuals_);
    best_single_ = best_hypothesis(fitted_, 1);
    rest_ = whole_;
    std::vector<double> noise_like = null_residuals_;
    if (best_single_ < fitted_.size()) {
        rest_ = structure_->best(fitted_[best_single_].fit.residuals);
        noise_like = fitted_[best_single_].fit.residuals;
    }
    gate_ = simulated_gate(*structure_, directions(), null_residuals_, noise_like, options_.seed, progress_);
    result_.depends_on = whole_.variables;
}

namespace {

/// Beside a strong effect another one lies elsewhere than alone: a law with starts of its own begins at all of them
/// again.
Hypothesis from_many_starts(const FittedHypothesis& first, const Hypothesis& second) {
    const dynamics::EffectInfo& info = dynamics::effect(second.names.front()).info();
    const bool many = info.seen_in == dynamics::SeenIn::static_set && !info.search.starts.empty();
    const std::vector<double> begin = second.starts.empty() ? second.start() : second.starts.front();
    Hypothesis both = joined(first.hypothesis, first.fit.parameters, second, begin);
    for (std::size_t k = 0; many && k < second.starts.size(); ++k) {
        both.starts.push_back(joined(first.hypothesis, first.fit.parameters, second, second.starts[k]).start());
    }
    return both;
}

}  // namespace

/// A form of the same law with fewer numbers, where those that it lacks add less than a second effect must: beside one
/// they may be too many.
bool StaticLoop::does_as_much(const FittedHypothesis& form, const FittedHypothesis& richer) const {
    return form.hypothesis.names == richer.hypothesis.names &&
           form.hypothesis.parameters.size() < richer.hypothesis.parameters.size() &&
           form.score() - richer.score() < calibration_.pair_share * richer.explained;
}

std::vector<FittedHypothesis> StaticLoop::pairs_of_leaders() const {
    std::vector<std::size_t> order(singles_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return fitted_[a].score() < fitted_[b].score(); });
    std::vector<std::size_t> leaders;
    std::map<std::vector<std::string>, std::size_t> taken;  // the last form of each law
    for (const std::size_t i : order) {
        std::vector<std::string> law = fitted_[i].hypothesis.names;
        const std::string& same = dynamics::effect(law.front()).info().search.same_law_as;
        law.front() = same.empty() ? law.front() : std::max(law.front(), same);  // under two names it takes one place
        const auto last = taken.find(law);
        const bool leads = last == taken.end() ? taken.size() < 5 : does_as_much(fitted_[i], fitted_[last->second]);
        if (leads) {
            taken[law] = i;
            leaders.push_back(i);
        }
    }
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const std::size_t a : leaders) {
        for (std::size_t b = 0; b < singles_; ++b) {
            const bool both_lead = std::find(leaders.begin(), leaders.end(), b) != leaders.end();
            if (fitted_[a].hypothesis.names != fitted_[b].hypothesis.names && !(both_lead && b < a)) {
                pairs.emplace_back(a, b);
            }
        }
    }
    std::vector<FittedHypothesis> found(pairs.size());
    core::parallel_for(
        pairs.size(),
        [&](std::size_t k) {
            const auto [a, b] = pairs[k];
            const Hypothesis both = from_many_starts(fitted_[a], fitted_[b].hypothesis);
            found[k] = fitted(both);
            found[k].hypothesis.starts = {found[k].fit.parameters};
        },
        progress_);
    std::erase_if(found, [&](const FittedHypothesis& pair) {
        return cancels(pair) || !differs_from_neutral(pair, calibration_.neutral_sigmas);
    });
    return found;
}

bool StaticLoop::earns_its_place(const FittedHypothesis& pair) const {
    const FittedHypothesis& single = fitted_[best_hypothesis(fitted_, 1)];
    const double gain = single.score() - pair.score();
    // beside a strong effect a second one is a small share and still real: then other set points must show it
    return gain > calibration_.pair_gain &&
           (gain > calibration_.pair_share * std::max(pair.explained, least_gain) || falls(&single, pair));
}

void StaticLoop::try_two() {
    const std::size_t single = best_hypothesis(fitted_, 1);
    if (single >= fitted_.size() || fitted_.size() > singles_ ||
        StaticStructure(experiment_, train_).best(fitted_[single].fit.residuals).p > calibration_.unknown_p) {
        return;
    }
    std::vector<FittedHypothesis> found = pairs_of_leaders();
    const std::size_t best = best_hypothesis(found, 2);
    if (best < found.size() && earns_its_place(found[best])) {
        fitted_.push_back(std::move(found[best]));
    }
}

void StaticLoop::fit_pairs() {
    constexpr std::size_t bends = 2;  // numbers of a law that can do what two effects of one number do together
    const std::size_t numbers = best_single_ < fitted_.size() ? fitted_[best_single_].hypothesis.parameters.size() : 0;
    const bool explained = rest_.p > calibration_.unknown_p;
    if (best_single_ >= fitted_.size() || (explained && numbers < bends)) {
        return;
    }
    std::vector<FittedHypothesis> found = pairs_of_leaders();
    const std::size_t best = best_hypothesis(found, 2);
    if (!explained && best < found.size() && earns_its_place(found[best])) {
        const SmoothFit rest = structure_->best(found[best].fit.residuals);
        // two laws together bend to much: what they leave must look like noise, or nearly
        if (rest.p > calibration_.unknown_p ||
            structure_left(rest, found[best].explained) < calibration_.pair_rest_share * calibration_.unknown_share) {
            fitted_.insert(fitted_.end(), found.begin(), found.end());
            rest_ = rest;
            return;
        }
    }
    std::erase_if(found, [&](const FittedHypothesis& pair) { return pair.hypothesis.parameters.size() > numbers; });
    add_rivals(found, explained);
}

/// Two effects that do with no more numbers what one law of several does: the likeliest where that law leaves nothing,
/// else all that leave no more than it.
void StaticLoop::add_rivals(std::vector<FittedHypothesis>& found, bool explained) {
    constexpr double both = 0.1;  // chance before the data that it is two; many pairs are tried
    const std::size_t best = best_hypothesis(found, 2), single = best_single_;
    if (best >= found.size()) {
        return;
    }
    const SmoothFit rest = explained ? rest_ : structure_->best(found[best].fit.residuals);
    if (rest.p < rest_.p) {
        return;
    }
    if (explained) {
        found = {found[best]};
    }
    for (FittedHypothesis& pair : found) {
        pair.rival = true;
        pair.hypothesis.prior *= both;
        fitted_.push_back(std::move(pair));
    }
    rest_ = best_hypothesis(fitted_, 2) == single ? rest_ : rest;
}

bool StaticLoop::cancels(const FittedHypothesis& pair) const {
    constexpr double most = 20;
    const std::vector<dynamics::EffectUse> uses = pair.hypothesis.with(pair.fit.parameters);
    double parts = 0;
    std::vector<double> moved;
    const auto size_of = [&](const std::vector<dynamics::EffectUse>& some) {
        experiment_.residuals(train_, some, moved);
        double sum = 0;
        for (std::size_t i = 0; i < moved.size(); ++i) {
            sum += (moved[i] - null_residuals_[i]) * (moved[i] - null_residuals_[i]);
        }
        return sum;
    };
    for (const std::string& name : pair.hypothesis.names) {
        std::vector<dynamics::EffectUse> own;
        std::copy_if(uses.begin(), uses.end(), std::back_inserter(own),
                     [&](const dynamics::EffectUse& use) { return use.name == name; });
        parts += size_of(own);
    }
    return parts > most * size_of(uses);
}

std::vector<std::size_t> StaticLoop::quantities_to_correct() const {
    std::vector<std::size_t> quantities;
    for (std::size_t q = 0; q < experiment_.quantities().size(); ++q) {
        std::vector<double> own = null_residuals_;
        for (std::size_t i = 0; i < train_.size(); ++i) {
            own[i] = experiment_.observations()[train_[i]].quantity == q ? own[i] : 0;
        }
        if (structure_->best(own).p <=
            calibration_.correct_chance) {  // in the others a correction would only carry their noise into the model
            quantities.push_back(q);
        }
    }
    return quantities;
}

std::vector<dynamics::EffectUse> StaticLoop::correction_on(const std::vector<std::size_t>& chosen,
                                                           const std::vector<std::size_t>& quantities) const {
    std::vector<Channel> variables;
    for (const std::string& name : whole_.variables) {
        Channel channel{};
        if (dynamics::find_channel(name, channel)) {
            variables.push_back(channel);
        }
    }
    std::vector<double> residuals;
    for (const std::size_t i : chosen) {
        residuals.push_back(experiment_.observations()[i].value -
                            experiment_.predict(experiment_.observations()[i], {}));
    }
    std::vector<dynamics::EffectUse> uses;
    for (const std::size_t q : quantities) {
        uses.push_back(smooth_correction(experiment_, chosen, variables, q, residuals));
    }
    return uses;
}

void StaticLoop::decide() {
    attribution_ = attribute(fitted_, gate_, rest_, calibration_);
    result_.verdict = attribution_.verdict;
    result_.gate = gate_;
    result_.structure = gate_ < calibration_.gate;
    result_.none_probability = attribution_.none_probability;
    result_.model = model_;
    for (const auto& [quantity, figure] : experiment_.noise()) {
        result_.noise[quantity] = {figure.value, figure.unit, figure.from, figure.estimated};
    }
    guard();
    for (const dynamics::EffectUse& use : uses_) {
        result_.model = result_.model.with_effect(use);
    }
}

bool StaticLoop::same_verdict(const std::vector<double>& weight) const {
    const auto of_rows = [&](const std::vector<double>& gain) {
        double sum = 0;
        for (std::size_t i = 0; i < gain.size(); ++i) {
            sum += weight[experiment_.observations()[train_[i]].set_point] * gain[i];
        }
        return sum;
    };
    const auto of_groups = [&](const FittedHypothesis& one) {
        return std::inner_product(weight.begin(), weight.end(), one.explained_by_group.begin(), 0.0);
    };
    if (result_.verdict == "none") {
        // the gate's chance follows the tail of what looked most like something, smooth or named
        const auto chance = [&](double gain, double drawn, double degrees) {
            const double whole = chi_squared_tail(gain, degrees);
            return std::pair(whole, gate_ * chi_squared_tail(std::max(drawn, 0.0), degrees) / core::never_zero(whole));
        };
        std::pair<double, double> strongest = chance(whole_.gain, of_rows(whole_.gain_of_row), whole_.degrees);
        if (best_single_ < fitted_.size()) {
            const FittedHypothesis& best = fitted_[best_single_];
            strongest = std::min(strongest, chance(best.explained, of_groups(best),
                                                   static_cast<double>(best.hypothesis.parameters.size())));
        }
        return strongest.second >= calibration_.gate;
    }
    const SmoothFit left{{}, of_rows(rest_.gain_of_row), rest_.degrees, rest_.p, {}};
    const bool unknown = attribution_.chosen >= fitted_.size() ||
                         (rest_.p < calibration_.unknown_p &&
                          structure_left(left, of_groups(fitted_[attribution_.chosen])) > calibration_.unknown_share);
    return result_.verdict == "unknown"
               ? unknown
               : !unknown && best_in_draw(attribution_, fitted_, weight) == attribution_.chosen;
}

double StaticLoop::stability() const {
    return share_of_draws(experiment_.set_points(), options_.seed + 1,
                          [&](const std::vector<double>& weight) { return same_verdict(weight); });
}

}  // namespace underbody::discovery
