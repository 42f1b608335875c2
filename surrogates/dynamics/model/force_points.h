// The forces of a model as points, for those who want a table: export, equilibria, plots.
#pragma once

#include "core/error.h"
#include "core/table.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

struct ForcePoints {
    core::Table points;      ///< axes and forces on a full grid, SI
    core::Problems remarks;  ///< what was held, what was left out
};

/// Every quantity that the model has force sources for, with the effects that change the vehicle's own forces
/// (roughness, exponents, pump curve, corrections), on the set points of its tables; up to four times as many between
/// them when an effect bends the force there, or a table (a spline, an exported one) has slopes of its own there that a
/// new fit would not give back. Effects of the rig and those of the motion are left out, and named in the remarks.
/// Beside them columns of one value: what is held, and mass, added mass, net weight, size and density of the model, so
/// that a table of the points says what it belongs to. A channel that only scales is held at `held`, else at the
/// model's condition, else at the scale's reference. Throws core::InputError: no force source; more than a million
/// points.
ForcePoints force_points(const Model& model, const Conditions& held = {});

}  // namespace underbody::dynamics
