// The forces of a model as tables: what leaves the program (exports, values at a point, equilibria) is what it
// simulates.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/tables/fit/sampled.h"

namespace underbody::dynamics {

/// A channel that becomes an axis, and its range (SI) where that is not the one of the tables.
struct ForceAxis {
    std::string name;
    std::optional<double> lower, upper;
};

struct ForceTablesOptions {
    Conditions held;  ///< of channels that are no axes
    /// Channels whose values come later, with the points asked for: the model's conditions do not hold them.
    std::vector<Channel> asked;
    std::vector<ForceAxis>
        axes;  ///< empty: every axis of the model's tables that neither `held` nor its conditions hold
    std::vector<std::string> quantities;  ///< empty: all that the model has force sources for
    tables::RangePolicies
        range;  ///< a motion holds the ends of all tables (clamp); a controller may want another policy
    tables::SamplingOptions sampling;
};

/// A channel that is no axis of the tables and that their forces depend on.
struct HeldChannel {
    Channel channel{};
    double value = 0;  ///< SI
    std::string from;  ///< "given", "condition of the model", "reference of its scale", "default"
};

struct ForceTables {
    std::vector<tables::ForceTable> tables;  ///< in the order of the quantities, all over the same axes
    std::vector<HeldChannel> held;
    core::Problems remarks;  ///< what was held, what was left out
};

/// static_value of every quantity over the axes, with the effects that change the vehicle's own forces (roughness,
/// exponents, pump curve, corrections); effects of the rig and of the motion are left out, and named in the remarks.
/// Standard deviations are those of ForceError. A point is outside when it is so for one of the quantity's tables,
/// although others may still change there: the grid spans them all. It has no data where one of these tables has none.
/// Channels that the model's [conditions] hold are held there, unless they are asked for or named as axes.
/// Channels that only scale a force (speed, jet_voltage) may be axes; without a range they run from 0 to twice the
/// reference of the scale. Each table is exact (to rounding) where the force is piecewise cubic, else within
/// options.sampling.tolerance, as its sampling_error() says. Throws core::InputError: no force source; more set points
/// than a grid can have. core::UsageError: an axis that no force depends on or without a range, a quantity that the
/// model lacks, more than four axes.
ForceTables force_tables(const Model& model, const ForceTablesOptions& options = {},
                         core::Progress& progress = core::Progress::none());

}  // namespace underbody::dynamics
