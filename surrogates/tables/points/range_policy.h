// What a table does beyond the ends of its axes, axis by axis.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace underbody::tables {

/// What ForceTable::at() and all exports but JSBSim's do beyond the ends of an axis. The standard deviation grows with
/// the distance under each policy. Searches (equilibria, pitch windows, pictures) end where the axis does that they
/// move along, and the motion of a model holds the ends of all axes.
enum class RangePolicy {
    clamp,        ///< hold the end value with slope zero, flagged (default)
    refuse,       ///< core::InputError; an export gives values that are not numbers
    extrapolate,  ///< go on along the tangent at the end, flagged
};

/// "clamp", "refuse" or "extrapolate"; the way back gives nothing for any other word.
std::string to_string(RangePolicy policy);
std::optional<RangePolicy> range_policy(const std::string& word);

/// What happens there, for the user: "the end value is held", ...
std::string outside_words(RangePolicy policy);

/// A policy for every axis: of axes by name, and of all others.
struct RangePolicies {
    RangePolicies() = default;
    RangePolicies(RangePolicy all)
        : others(all) {}  // NOLINT(google-explicit-constructor): one policy for all is the usual case

    std::optional<RangePolicy> others;  ///< nothing: what an exported table says, else clamp
    std::vector<std::pair<std::string, RangePolicy>> named;

    /// Of an axis: its own, that of the others, or `otherwise` where neither is given.
    [[nodiscard]] RangePolicy of(const std::string& axis, RangePolicy otherwise = RangePolicy::clamp) const;
};

/// "clamp", "gap=refuse,pitch=clamp", "extrapolate,gap=refuse". Throws core::UsageError for an unknown policy (with the
/// nearest one), a part that is neither a policy nor AXIS=POLICY, an axis named twice. Empty: nothing said.
RangePolicies parse_range_policies(const std::string& text);

}  // namespace underbody::tables
