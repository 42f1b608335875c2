#include "surrogates/tables/points/range_policy.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace underbody::tables {

std::string to_string(RangePolicy policy) {
    return policy == RangePolicy::clamp ? "clamp" : policy == RangePolicy::refuse ? "refuse" : "extrapolate";
}

std::string outside_words(RangePolicy policy) {
    return policy == RangePolicy::clamp    ? "the end value is held"
           : policy == RangePolicy::refuse ? "refused"
                                           : "extrapolated along the end slope";
}

std::optional<RangePolicy> range_policy(const std::string& word) {
    for (const RangePolicy policy : {RangePolicy::clamp, RangePolicy::refuse, RangePolicy::extrapolate}) {
        if (word == to_string(policy)) {
            return policy;
        }
    }
    return std::nullopt;
}

RangePolicy RangePolicies::of(const std::string& axis, RangePolicy otherwise) const {
    const auto own = std::find_if(named.begin(), named.end(), [&](const auto& entry) { return entry.first == axis; });
    return own != named.end() ? own->second : others.value_or(otherwise);
}

namespace {

RangePolicy known_policy(const std::string& word) {
    const auto policy = range_policy(word);
    if (!policy) {
        throw core::UsageError("range", "there is no range policy '" + word + "'", {},
                               core::did_you_mean(word, {"clamp", "refuse", "extrapolate"}));
    }
    return *policy;
}

}  // namespace

RangePolicies parse_range_policies(const std::string& text) {
    RangePolicies policies;
    for (const auto part : core::split(text, ',')) {
        const std::string word(core::trimmed(part));
        if (word.empty()) {
            continue;
        }
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos) {
            if (policies.others) {
                throw core::UsageError("range", "the range policy of all axes is given twice: '" + text + "'", {},
                                       "such as option 'range extrapolate,gap=refuse'");
            }
            policies.others = known_policy(word);
            continue;
        }
        const std::string axis(core::trimmed(word.substr(0, equals)));
        if (axis.empty()) {
            throw core::UsageError("range", "'" + word + "' names no axis", {},
                                   "such as option 'range gap=refuse,pitch=clamp'");
        }
        const bool known = std::any_of(policies.named.begin(), policies.named.end(),
                                       [&](const auto& entry) { return entry.first == axis; });
        if (known) {
            throw core::UsageError("range", "the range policy of axis '" + axis + "' is given twice: '" + text + "'");
        }
        policies.named.emplace_back(axis, known_policy(std::string(core::trimmed(word.substr(equals + 1)))));
    }
    return policies;
}

}  // namespace underbody::tables
