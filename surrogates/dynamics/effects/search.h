// What effects ask of a model before a search looks for them.
#pragma once

#include <algorithm>

#include "surrogates/dynamics/model/effect.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// Share of a declared inertia that an added one may take away: a body keeps some.
constexpr double most_taken = 0.9;

/// True if a source of one of these quantities has the channel as an axis or (`scaled`) a power of it.
inline bool source_feels(const SearchContext& context, Channel channel, bool scaled) {
    const auto& asked = context.quantities;
    return std::any_of(context.model.forces.begin(), context.model.forces.end(), [&](const ForceSource& source) {
        const bool axis = std::find(source.axes.begin(), source.axes.end(), channel) != source.axes.end();
        const bool power = std::any_of(source.scales.begin(), source.scales.end(), [&](const ForceScale& scale) {
            return scale.channel == channel && scale.exponent != 0;
        });
        return std::find(asked.begin(), asked.end(), source.quantity) != asked.end() && (axis || (scaled && power));
    });
}

inline bool varies(const SearchContext& context, Channel channel) {
    return std::find(context.varying.begin(), context.varying.end(), channel) != context.varying.end();
}

}  // namespace underbody::dynamics
