// What a new model means for the vehicle, as far as both kinds of data say it in the same way.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/discovery.h"

namespace underbody::discovery {

/// A gap at which the vehicle may stay.
struct Balance {
    std::string name;
    bool stable = false;
    double gap = 0;  ///< m
};

/// Equilibria before and after, each with the nearest of the same kind (by ratio of their gaps); those without a
/// partner have NaN there.
std::vector<EquilibriumPair> paired(const std::vector<Balance>& before, std::vector<Balance> after);

/// Where starts between two gaps (m) and heave velocities of -0.1 to 0.1 m/s end without input, before and after;
/// `cells` a side. The same shares where the models are the same.
void compare_regions(const dynamics::Model& before, const dynamics::Model& after, double low, double high,
                     const dynamics::Conditions& held, std::size_t cells, core::Progress& progress,
                     Consequence& result);

/// Runs `map`; where a model cannot be mapped the reason goes into the text.
void map_if_possible(Consequence& result, const std::function<void()>& map);

}  // namespace underbody::discovery
