#include "surrogates/discovery/attribution.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "surrogates/discovery/guards.h"

namespace underbody::discovery {

namespace {

constexpr double no_finding = 30;  ///< of a log weight: what is no finding keeps its place in the list and nothing else

/// Weights of the names beside that of the likeliest, which is one; `finding`: differs from doing nothing.
std::vector<Attribution::Share> shares_by_names(const std::vector<FittedHypothesis>& hypotheses,
                                                const FittedHypothesis& best, const std::vector<bool>& finding,
                                                bool any, const Calibration& calibration) {
    // laws of nature differ in form from the catalogue's: a share of what is explained counts as one unit of evidence
    const double temperature = 1 + calibration.form_share * std::max(0.0, best.explained);
    // of the forms of a name the likeliest stands for it; as logarithms, so that the order holds where nothing else is
    // left of a rival
    std::map<std::vector<std::string>, Attribution::Share> by_names;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
        const FittedHypothesis& one = hypotheses[i];
        if (one.hypothesis.names.size() > best.hypothesis.names.size() && !one.rival) {
            continue;  // a second effect that did not earn its place
        }
        const double evidence = one.score() - one.occam - (best.score() - best.occam);
        // what an effect beside the same other ones explains owes nothing to their form
        const std::vector<std::string>& all = best.hypothesis.names;
        const bool part =
            one.hypothesis.names.size() < all.size() &&
            std::includes(all.begin(), all.end(), one.hypothesis.names.begin(), one.hypothesis.names.end());
        const double softened =
            part ? 1 + calibration.form_share * std::max(0.0, best.explained - one.explained) : temperature;
        // a number that may as well be the one at which its effect does nothing is no finding
        const double weight = std::log(one.hypothesis.prior) - 0.5 * (evidence / softened + one.occam - best.occam) -
                              (any && !finding[i] ? no_finding : 0.0);
        const auto [known, first] = by_names.try_emplace(one.hypothesis.names, Attribution::Share{i, weight});
        if (first) {
            continue;
        }
        // with a number held or free it is one form, whose law owes nothing to other names: the score decides
        const std::size_t before = known->second.hypothesis;
        const auto price = [&](std::size_t k) {
            return hypotheses[k].score() - 2 * std::log(hypotheses[k].hypothesis.prior);
        };
        const bool one_form =
            hypotheses[before].hypothesis.form == one.hypothesis.form && finding[before] == finding[i];
        const bool better = one_form ? price(i) < price(before) : weight > known->second.probability;
        if (better) {
            known->second = {i, weight};
        }
    }
    std::vector<Attribution::Share> shares;
    for (const auto& [names, share] : by_names) {
        shares.push_back(share);
    }
    std::stable_sort(shares.begin(), shares.end(),
                     [](const auto& a, const auto& b) { return a.probability > b.probability; });
    const double largest = shares.front().probability;
    for (Attribution::Share& share : shares) {
        share.probability = std::exp(share.probability - largest);
    }
    return shares;
}

}  // namespace

std::size_t best_hypothesis(const std::vector<FittedHypothesis>& hypotheses, std::size_t effects) {
    std::vector<std::size_t> all(hypotheses.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return best_hypothesis(hypotheses, effects, all);
}

std::size_t best_hypothesis(const std::vector<FittedHypothesis>& hypotheses, std::size_t effects,
                            const std::vector<std::size_t>& among) {
    std::size_t best = hypotheses.size();
    for (const std::size_t i : among) {
        if (hypotheses[i].hypothesis.names.size() <= effects &&
            (best == hypotheses.size() ||
             hypotheses[i].score() - 2 * std::log(hypotheses[i].hypothesis.prior) <
                 hypotheses[best].score() - 2 * std::log(hypotheses[best].hypothesis.prior))) {
            best = i;
        }
    }
    return best;
}

double structure_left(const SmoothFit& rest, double explained) {
    const double left = std::max(0.0, rest.gain - rest.degrees);
    return left / std::max(left + std::max(explained, 0.0), least_gain);
}

namespace {

/// Chances of "none", of "unknown" and of each name, which share what is between these; `left`: of the structure;
/// `any`: a name has something to show.
void share_out(double gate_p, const SmoothFit& rest, double left, bool any, const Calibration& calibration,
               Attribution& result) {
    double total = 0;
    for (const Attribution::Share& share : result.shares) {
        total += share.probability;
    }
    // a smooth step between the two verdicts: at the limits above the odds are even
    double unknown = 1 / (1 + std::exp(-12 * (left / calibration.unknown_share - 1)));
    // and no surer than what is left is real: even odds at the limit of its chance
    const double real = rest.p > calibration.unknown_p ? 0.5 * calibration.unknown_p / rest.p
                                                       : 1 - 0.5 * rest.p / calibration.unknown_p;
    unknown = std::min(unknown, real);
    result.none_probability = gate_p >= calibration.even_none ? 1 - 0.5 * calibration.even_none / gate_p
                                                              : 0.5 * gate_p / calibration.even_none;
    result.unknown_probability = (1 - result.none_probability) * unknown;
    for (Attribution::Share& share : result.shares) {
        share.probability *= (1 - result.none_probability) * (1 - unknown) / total;
    }
    for (Attribution::Share& share : result.shares) {
        if (gate_p >= calibration.gate &&
            share.probability > calibration.left_undecided) {  // not asked for, so not sure
            result.unknown_probability += share.probability - calibration.left_undecided;
            share.probability = calibration.left_undecided;
        }
    }
    if (!any) {  // no name has anything to show: what they would share goes to what is left
        double& heir = gate_p >= calibration.gate ? result.none_probability : result.unknown_probability;
        for (Attribution::Share& share : result.shares) {
            heir += share.probability * (1 - std::exp(-no_finding));
            share.probability *= std::exp(-no_finding);
        }
    }
}

}  // namespace

Attribution attribute(const std::vector<FittedHypothesis>& hypotheses, double gate_p, const SmoothFit& rest,
                      const Calibration& calibration) {
    Attribution result;
    const auto most = static_cast<std::size_t>(calibration.most_effects);
    std::vector<bool> finding(hypotheses.size());
    std::vector<std::size_t> findings;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
        finding[i] = differs_from_neutral(hypotheses[i], calibration.neutral_sigmas);
        if (finding[i]) {
            findings.push_back(i);
        }
    }
    const bool any = !findings.empty();
    result.chosen = any ? best_hypothesis(hypotheses, most, findings) : best_hypothesis(hypotheses, most);
    if (result.chosen >= hypotheses.size()) {
        result.verdict = gate_p < calibration.gate ? "unknown" : "none";
        result.none_probability = result.verdict == "none" ? 1 : 0;
        result.unknown_probability = 1 - result.none_probability;
        return result;
    }
    const FittedHypothesis& best = hypotheses[result.chosen];
    result.shares = shares_by_names(hypotheses, best, finding, any, calibration);
    const double left = structure_left(rest, best.explained);
    const bool unexplained = rest.p < calibration.unknown_p && left > calibration.unknown_share;
    share_out(gate_p, rest, left, any, calibration, result);
    if (gate_p >= calibration.gate) {
        result.verdict = "none";
    } else {
        result.verdict = unexplained || !any ? "unknown" : "effect";
    }
    result.chosen = result.shares.front().hypothesis;
    return result;
}

}  // namespace underbody::discovery
