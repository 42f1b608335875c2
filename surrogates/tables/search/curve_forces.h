// Forces over gap and pitch, and what numbers of curves they make.
#pragma once

#include <vector>

#include "surrogates/tables/fit/grid.h"
#include "surrogates/tables/search/curve.h"

namespace underbody::tables {

/// Forces over gap and pitch; of a kick one pitch, of a window at a stated gap one gap.
struct CurveForces {
    std::vector<double> gaps, pitches;          ///< m, rad, ascending
    std::vector<double> lift, moment;           ///< N, N m; [pitch * gaps + gap], empty where not asked for
    double lift_size = 1, moment_size = 1;      ///< what is a large change of each: weighs misses of unlike kinds
    SlopeRule between = SlopeRule::not_a_knot;  ///< how curves go through the values
};

struct CurveNumber {
    double value = 0;       ///< SI. Below zero: there is none, and by how much it is missed (curve_number)
    bool at_least = false;  ///< cut by the range of gaps or pitches: it may be more
};

/// A kick without a stable equilibrium is minus the velocity of the work that the force that lacks for one does over
/// the range of gaps. A window about a pitch at which something does not hold is minus the least way to another pitch,
/// plus, where something does not hold there either, what lacks over its size times the range of pitches. Both are
/// continuous where the last one vanishes at a place inside the ranges, so that a search has a slope to climb.
CurveNumber curve_number(const CurveAsked& asked, const CurveForces& forces);

/// Covariances of the errors of the forces at all nodes, [i * nodes + j]; empty: none.
struct CurveErrors {
    std::vector<double> lift, moment;
};
/// Root mean square distance between curve_number() of the forces and of 64 curves drawn whole from the errors (the
/// same normal numbers for all: a smooth function of what it is given). Lift and moment are drawn independently. Throws
/// std::invalid_argument for more than 512 nodes.
double curve_sigma(const CurveAsked& asked, const CurveForces& forces, const CurveErrors& errors);

}  // namespace underbody::tables
