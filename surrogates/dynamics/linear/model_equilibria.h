// Equilibria of a model in heave: of the one plant that moves, too, told as those of a table are.
#pragma once

#include <optional>
#include <vector>

#include "core/progress.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/tables/analysis/equilibria.h"

namespace underbody::dynamics {

struct BalanceOptions {
    Conditions held;                     ///< over the model's conditions
    std::optional<double> net_weight;    ///< N, in place of the model's
    std::optional<double> virtual_mass;  ///< kg, in place of the model's
    std::optional<double> damping;       ///< N s/m, linear, in place of the model's
    double scale = 1;                    ///< on the lift of its tables
    int draws = tables::usual_draws;
};

struct ModelEquilibria {
    tables::Equilibria found;
    std::vector<double> virtual_mass;  ///< kg, at each of them
    /// The force at rest over the gap without the net weight: tables, jets, and whatever else acts. With the weight as
    /// tables::EquilibriumOptions it has the same equilibria.
    tables::ForceTable at_rest;
    double net_weight = 0;  ///< N

    [[nodiscard]] bool one_mass() const;
};

/// Gaps, stiffness, masses and their errors are those that a linear analysis of the model has (HeavePlant,
/// HeaveForceError, heave_trim_errors): every effect that acts on the vehicle at rest counts. Throws as HeavePlant;
/// core::UsageError: damping, mass, weight or scale that is none.
ModelEquilibria model_equilibria(const Model& model, const BalanceOptions& options,
                                 core::Progress& progress = core::Progress::none());

/// The model without the effects of the motion, whose forces its tables do not hold.
Model with_effects_on_forces(Model model);

}  // namespace underbody::dynamics
