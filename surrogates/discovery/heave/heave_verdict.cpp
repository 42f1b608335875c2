// From fitted effects to a verdict for heave runs: pairs, what they leave, and how stable the answer is.
#include <algorithm>
#include <numeric>
#include <set>

#include "core/parallel.h"
#include "surrogates/discovery/heave/heave_error.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/one_law.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr std::size_t seconds_tried = 5;

}  // namespace

/// Both of each pair at once; appended.
void HeaveLoop::fit_both(const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                         std::vector<FittedHypothesis>& found, std::vector<HeaveNoise>& noises) const {
    const std::size_t first = found.size();
    found.resize(first + pairs.size());
    noises.resize(first + pairs.size());
    core::parallel_for(
        pairs.size(),
        [&](std::size_t k) {
            const auto [a, b] = pairs[k];
            const Hypothesis& second = fitted_[b].hypothesis;
            std::vector<double> start = second.starts.empty() ? fitted_[b].fit.parameters : second.starts.front();
            if (is_scanned(second)) {
                const auto starts =
                    experiment_->periodic_starts(fitted_[a].hypothesis.with(fitted_[a].fit.parameters), noises_[a], 1);
                start = starts.empty() ? start : starts.front();
            }
            HeaveExperiment::Result result =
                fitted(joined(fitted_[a].hypothesis, fitted_[a].fit.parameters, second, start), noises_[a]);
            found[first + k] = std::move(result.fitted);
            noises[first + k] = result.noise;
        },
        progress_);
}

/// The pairs of effects that were asked for, each fitted once.
class HeaveLoop::PairSearch {
public:
    explicit PairSearch(const HeaveLoop& loop) : loop_(loop), asked_{loop.best_single_} {}

    void add(std::size_t a, std::size_t b) {
        if (a < loop_.singles_ && b < loop_.singles_ &&
            loop_.fitted_[a].hypothesis.names != loop_.fitted_[b].hypothesis.names &&
            std::find(pairs_.begin(), pairs_.end(), std::pair{a, b}) == pairs_.end() &&
            std::find(pairs_.begin(), pairs_.end(), std::pair{b, a}) == pairs_.end()) {
            pairs_.emplace_back(a, b);
        }
    }
    void add_seconds(std::size_t one, const std::vector<std::size_t>& second) {
        for (std::size_t k = 0; k < std::min(seconds_tried, second.size()); ++k) {
            add(one, second[k]);
        }
    }
    /// With what would explain most beside it, looked for once.
    void add_beside(std::size_t one) {
        if (asked_.insert(one).second) {
            add_seconds(one, loop_.rest_beside(loop_.fitted_[one], loop_.noises_[one]).second);
        }
    }
    /// Either of the best two may stand in for one that is like it.
    void add_like(const std::pair<std::size_t, std::size_t>& best) {
        for (std::size_t c = 0; c < loop_.singles_; ++c) {
            if (like(c, best.second)) {
                add(best.first, c);
            }
            if (like(c, best.first)) {
                add(best.second, c);
            }
        }
    }
    /// True where there was something that had not been fitted.
    bool fit_new() {
        const std::vector<std::pair<std::size_t, std::size_t>> more(
            pairs_.begin() + static_cast<std::ptrdiff_t>(found.size()), pairs_.end());
        loop_.fit_both(more, found, noises);
        return !more.empty();
    }
    [[nodiscard]] std::pair<std::size_t, std::size_t> best() const { return pairs_[best_hypothesis(found, 2)]; }
    void drop_implausible() {
        for (std::size_t k = found.size(); k-- > 0;) {
            if (!loop_.plausible_pair(found[k])) {
                found.erase(found.begin() + static_cast<std::ptrdiff_t>(k));
                noises.erase(noises.begin() + static_cast<std::ptrdiff_t>(k));
            }
        }
    }

    std::vector<FittedHypothesis> found;
    std::vector<HeaveNoise> noises;

private:
    [[nodiscard]] bool like(std::size_t a, std::size_t b) const {
        return one_kin({loop_.fitted_[a].hypothesis.names.front(), loop_.fitted_[b].hypothesis.names.front()});
    }

    const HeaveLoop& loop_;
    std::vector<std::pair<std::size_t, std::size_t>> pairs_;
    std::set<std::size_t> asked_;  ///< beside which others were looked for
};

/// A second effect is looked for where the best single one leaves structure, and stays when it earns its place.
void HeaveLoop::fit_pairs() {
    if (rest_.fit.p > calibration_.unknown_p && rest_.second.empty()) {
        return;
    }
    PairSearch search(*this);
    search.add_seconds(best_single_, rest_.second);
    if (singles_ > 1) {
        std::vector<std::size_t> order(singles_);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(),
                  [&](std::size_t a, std::size_t b) { return fitted_[a].score() < fitted_[b].score(); });
        search.add_beside(order[0] == best_single_ ? order[1] : order[0]);
    }
    search.fit_new();
    if (!search.found.empty()) {
        search.add_like(search.best());
        search.fit_new();
    }
    // one effect alone may do what two do together, and neither of the two be found beside it: from each of the best
    // two the search goes on without the other
    for (bool more = !search.found.empty(); more;) {
        const auto [a, b] = search.best();
        search.add_beside(a);
        search.add_beside(b);
        more = search.fit_new();
    }
    search.drop_implausible();
    if (!search.found.empty()) {
        keep_pairs(search.found, search.noises);
    }
}

void HeaveLoop::keep_pairs(const std::vector<FittedHypothesis>& found, const std::vector<HeaveNoise>& noises) {
    const std::size_t best = best_hypothesis(found, 2);
    const double gain = fitted_[best_single_].score() - found[best].score();
    // two effects of one kind may be one effect whose law has another form than the catalogue's: that needs more to be
    // believed
    const double share = calibration_.pair_share * (one_kin(found[best].hypothesis.names) ? calibration_.kin_share : 1);
    if (gain < calibration_.pair_gain || gain < share * found[best].explained) {
        return;
    }
    // one smooth law that does better for its price is one law, not two
    if (!whole_list_.empty() &&
        smooth_score(best_smooth(whole_list_)) < found[best].cost + found[best].occam - calibration_.smooth_gain) {
        return;
    }
    // what a second effect adds on the runs that were fitted may be the first one's law in another form
    const auto answer = [&](const FittedHypothesis& one, const HeaveNoise& noise) {
        return answer_of(one.hypothesis.with(one.fit.parameters), noise);
    };
    if (!falls(answer(fitted_[best_single_], noises_[best_single_]), answer(found[best], noises[best]))) {
        return;
    }
    const Rest rest = rest_beside(found[best], noises[best]);
    if (rest.fit.p > calibration_.unknown_p || rest.share < calibration_.pair_rest_share * calibration_.unknown_share) {
        fitted_.insert(fitted_.end(), found.begin(), found.end());
        noises_.insert(noises_.end(), noises.begin(), noises.end());
        rest_ = rest;
    }
}

/// A third and a fourth effect, one at a time, where the best set so far leaves structure that noise does not make.
void HeaveLoop::fit_further() {
    for (std::size_t count = 3; count <= static_cast<std::size_t>(calibration_.most_effects); ++count) {
        const std::size_t base = best_hypothesis(fitted_, count - 1);
        if (fitted_[base].hypothesis.names.size() + 1 != count || rest_.fit.p > calibration_.unknown_p) {
            return;
        }
        std::vector<FittedHypothesis> found(std::min(seconds_tried, rest_.second.size()));
        std::vector<HeaveNoise> noises(found.size());
        core::parallel_for(
            found.size(),
            [&](std::size_t k) {
                const FittedHypothesis& other = fitted_[rest_.second[k]];
                const Hypothesis& next = other.hypothesis;
                HeaveExperiment::Result result =
                    fitted(joined(fitted_[base].hypothesis, fitted_[base].fit.parameters, next,
                                  next.starts.empty() ? other.fit.parameters : next.starts.front()),
                           noises_[base]);
                found[k] = std::move(result.fitted);
                noises[k] = result.noise;
            },
            progress_);
        const std::size_t best = best_finding(found, count, calibration_.neutral_sigmas);
        // each has to bring as much as a second one must
        const double before = null_cost_ - fitted_[base].cost;
        if (best == found.size() ||
            fitted_[base].score() - found[best].score() <
                std::max(calibration_.pair_gain, calibration_.further_share * calibration_.pair_share * before)) {
            return;
        }
        rest_ = rest_beside(found[best], noises[best]);
        fitted_.push_back(std::move(found[best]));
        noises_.push_back(noises[best]);
    }
}

/// Two laws of one kind that work against each other are no two effects: together they bend into a law that neither
/// has.
bool HeaveLoop::plausible_pair(const FittedHypothesis& pair) const {
    if (!differs_from_neutral(pair, calibration_.neutral_sigmas)) {
        return false;
    }
    const auto& names = pair.hypothesis.names;
    if (!one_kin(names) || !std::all_of(names.begin(), names.end(), [](const auto& name) {
            return dynamics::effect(name).info().search.one_sign;
        })) {
        return true;
    }
    int up = 0;
    int down = 0;
    std::set<std::size_t> seen;
    for (std::size_t j = 0; j < pair.hypothesis.slots.size(); ++j) {
        if (seen.insert(pair.hypothesis.slots[j].use).second) {  // its strength comes first
            const dynamics::EffectUse neutral =
                dynamics::neutral_use(pair.hypothesis.uses[pair.hypothesis.slots[j].use].name);
            const double strength = pair.fit.parameters[j] - neutral.values[pair.hypothesis.slots[j].value];
            up += strength > 0 ? 1 : 0;
            down += strength < 0 ? 1 : 0;
        }
    }
    return up == 0 || down == 0;
}

/// From recorded input to gap reading a delay before the body and one behind it are one law: without a measured
/// velocity they share what either has.
void HeaveLoop::tie_delays() {
    if (records_.velocity_measured || attribution_.verdict != "effect") {
        return;
    }
    tie_names_of_one_law(attribution_, [&](const Attribution::Share& share) {
        const Hypothesis& one = fitted_[share.hypothesis].hypothesis;
        return one.names.size() == 1 && touch_of(one, model_).delay;
    });
}

void HeaveLoop::decide() {
    SmoothFit rest = rest_.fit;
    const std::size_t chosen = best_hypothesis(fitted_, static_cast<std::size_t>(calibration_.most_effects));
    if (!whole_list_.empty() && chosen < fitted_.size()) {
        // a law without a name must do better on runs that it was not fitted to
        double smooth = 0;
        double named = 0;
        for (const double own : best_smooth(whole_list_).held_out) {
            smooth += own;
        }
        for (const double own : fitted_[chosen].held_out) {
            named += own;
        }
        // or so much better on all runs, at Schwarz's price, that runs which alone visit a corner of its variables
        // cannot spoil it
        const bool far_better = smooth_score(best_smooth(whole_list_)) <
                                fitted_[chosen].cost + fitted_[chosen].occam - calibration_.smooth_far_gain;
        // a law that does hardly more than a named one is that one in another form: a power of 1.9 instead of 2
        const bool hardly_more = whole_.gain < calibration_.smooth_more * fitted_[chosen].explained;
        if ((smooth > named - calibration_.smooth_gain && !far_better) || hardly_more) {
            rest.p = 1;
        }
    }
    if (gate_ < calibration_.gate && named_gate_ >= calibration_.gate && !whole_list_.empty()) {
        rest = whole_;  // something is there, and no name says more of it than noise would
        rest.p = gate_;
    }
    attribution_ = attribute(fitted_, gate_, rest, calibration_);
    tie_delays();
    result_.verdict = attribution_.verdict;
    result_.gate = gate_;
    result_.structure = gate_ < calibration_.gate;
    result_.none_probability = attribution_.none_probability;
    result_.model = model_;
    result_.model.records = reading_found();
    after_noise_ = declared_noise_ = null_noise_;
    guard();
    for (const dynamics::EffectUse& use : uses_) {
        result_.model = result_.model.with_effect(use);
    }
    if (result_.verdict != "none") {
        result_.depends_on = whole_.variables;
    }
}

/// Share of resampled runs in which the chosen names have the least score.
double HeaveLoop::stability() const {
    if (result_.verdict == "none") {
        return result_.none_probability;
    }
    if (result_.verdict == "unknown") {
        return attribution_.unknown_probability;
    }
    return share_of_draws(null_by_record_.size(), options_.seed + 1, [&](const std::vector<double>& weight) {
        return best_in_draw(attribution_, fitted_, weight) == attribution_.chosen;
    });
}

}  // namespace underbody::discovery
