// Equilibria of a net force along a gap, whoever makes it: a table with a weight, or a model at rest.
#pragma once

#include <functional>

#include "surrogates/tables/analysis/equilibria.h"

namespace underbody::tables {

/// What is known beside the force, at a gap.
struct AtBalance {
    double error = 0;    ///< N, one standard deviation of the force
    double mass = 0;     ///< kg, virtual mass; 0: not known
    double damping = 0;  ///< N s/m, linear
};

/// Sets the range, the forces at its ends, the extremes and all equilibria with what is told of each but for what draws
/// tell.
void set_balances(Equilibria& result, const Line& force, const std::function<AtBalance(double gap)>& at);

/// m: how far from an equilibrium one of its kind in a draw counts as the same.
double reach_of(const Equilibria& all, const Equilibrium& one);

}  // namespace underbody::tables
