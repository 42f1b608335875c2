// From a judged attribution to findings: what is missing, what else it could be, what would have been seen. Both
// pipelines tell it here.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"

namespace underbody::discovery {

/// The numbers of a fitted hypothesis as a finding (of its first name; all its parameters). Its uses carry the errors
/// of their numbers.
FoundEffect found_effect(const FittedHypothesis& fitted, double probability);

/// One finding per name, each with its own parameters, uses and share.
std::vector<FoundEffect> split_by_name(const FoundEffect& whole, const FittedHypothesis& fitted);

/// What speaks for a hypothesis that was fitted to runs in time: the fall of the likelihood, and in how many runs.
std::string evidence_of_runs(const FittedHypothesis& one);

/// All that a pipeline knows once it has judged.
struct Judgement {
    const std::vector<FittedHypothesis>& fitted;
    const Attribution& attribution;
    const SmoothFit& whole;                        ///< structure found without any named effect
    const SmoothFit& rest;                         ///< structure beside the best named effect
    double left = 0;                               ///< its share of all structure
    const std::vector<dynamics::EffectUse>& uses;  ///< what goes into the model
    std::string correction;                        ///< what stands in for a law without a name: "a smooth correction"
    std::function<std::string(const FittedHypothesis&)> evidence;
    std::function<std::string(const FittedHypothesis& chosen, const FittedHypothesis& rival)> told_apart;
};

/// Fills effects, alternatives and limits of a result whose verdict stands.
void tell(const Judgement& judgement, Discovery& result);

/// Chance that a resampled set of `groups` runs (or set points) passes: draws with replacement, `same` is told how
/// often each was drawn.
double share_of_draws(std::size_t groups, std::uint64_t seed,
                      const std::function<bool(const std::vector<double>& weight)>& same);

/// The hypothesis of least score among the shares of an attribution when each group counts with its weight.
std::size_t best_in_draw(const Attribution& attribution, const std::vector<FittedHypothesis>& fitted,
                         const std::vector<double>& weight);

}  // namespace underbody::discovery
