// How equilibria move with speed, voltage, weight or any axis: the curve of balance with its folds.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/tables/analysis/equilibria.h"

namespace underbody::tables {

struct ContinuationOptions {
    EquilibriumOptions base;      ///< net weight, mass, other held axes
    std::string parameter;        ///< "net_weight", an axis of the table, or a scaling quantity (speed, jet_voltage)
    double lower = 0, upper = 1;  ///< of the parameter, SI
    double reference = 1;         ///< scaling quantity: force = table * (parameter/reference)^exponent
    double exponent = 2;
    int steps = 240;  ///< along each direction
};

struct BranchPoint {
    double parameter = 0;
    double gap = 0;
    double stiffness = 0;  ///< N/m
    Stability stability = Stability::stable;
};
/// Connected points of balance, in order along the curve; stability changes where it folds.
using Branch = std::vector<BranchPoint>;

struct Fold {
    double parameter = 0;
    double gap = 0;
};

struct EquilibriumCurve {
    std::string parameter, parameter_unit, axis, axis_unit;
    std::vector<Branch> branches;
    std::vector<Fold> folds;  ///< where a stable and an unstable equilibrium meet (dF/dh = 0), to 1e-9 of the range
};

/// Throws core::UsageError: ends swapped, a range outside the table's axis, an unknown parameter, a reference that is
/// not positive or an exponent that is not finite.
EquilibriumCurve continue_equilibria(const ForceTable& table, const ContinuationOptions& options,
                                     core::Progress& progress = core::Progress::none());
core::Figure continuation_figure(const ForceTable& table, const EquilibriumCurve& curve);
void to_json(nlohmann::json& json, const EquilibriumCurve& curve);

}  // namespace underbody::tables
