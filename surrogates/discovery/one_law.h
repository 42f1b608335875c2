// One law of the catalogue under two names, which some data cannot tell apart.
#pragma once

#include <algorithm>

#include "surrogates/discovery/attribution.h"

namespace underbody::discovery {

/// What the shares that `is_law` holds for have is shared equally among them, and they come first, where the likeliest
/// share is one of them or where they together are likelier than it: a law is no less likely for having two names.
template <typename IsLaw>
void tie_names_of_one_law(Attribution& attribution, const IsLaw& is_law) {
    std::vector<Attribution::Share>& shares = attribution.shares;
    double law = 0;
    for (const Attribution::Share& share : shares) {
        law += is_law(share) ? share.probability : 0;
    }
    if (shares.empty() || (!is_law(shares.front()) && law <= shares.front().probability)) {
        return;
    }
    const auto end = std::stable_partition(shares.begin(), shares.end(), is_law);
    for (auto share = shares.begin(); share != end; ++share) {
        share->probability = law / static_cast<double>(end - shares.begin());
    }
    attribution.chosen = shares.front().hypothesis;
}

}  // namespace underbody::discovery
