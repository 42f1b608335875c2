// How sure a trim is: its gap and pitch, its stiffness and its modes, from the errors that the model's force tables and
// the numbers of its effects state.
#pragma once

#include <vector>

#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/model/force_error.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/tables/analysis/equilibria.h"

namespace underbody::dynamics {

/// One standard deviation of a mode's numbers; NaN where draws of the model change its kind (a pair that splits).
struct ModeError {
    double real = 0, imaginary = 0, frequency = 0, damping_ratio = 0;
};

/// One standard deviation each; all 0 where the model states no errors (`stated` false).
struct TrimError {
    bool stated = false;
    double force = 0;      ///< N, of the vertical force at rest there
    double gap = 0;        ///< m; 0 of a trim that is given
    double pitch = 0;      ///< rad, of heave and pitch together
    double stiffness = 0;  ///< N/m
    double swing = 0;      ///< rad/s, of the frequency without damping: root of stiffness over virtual mass
    std::vector<ModeError> modes;
    double stable = 0;  ///< share of the draws in which the trim is stable
    double exists = 1;  ///< share of the draws that have an equilibrium like this one within its reach
};

/// N: of the force at rest at a gap, by ForceError and by the errors of everything else that a model's effects do there
/// (constant force, springs, declared weight).
class HeaveForceError {
public:
    HeaveForceError(const Model& model, const Conditions& held);
    [[nodiscard]] double operator()(double gap, double pitch = 0) const;

private:
    struct Beside {
        HeavePlant above, below;  ///< one number of an effect moved
        double share;             ///< of its deviation that lies between the two
    };
    ForceError of_tables_;
    Conditions held_;
    std::vector<Beside> beside_;
};

/// d(heave_velocity, gap)/dt about a gap, with input_force as input. `stiffness`, N/m, when asked for.
LinearSystem heave_system(const HeavePlant& plant, double gap, double* stiffness = nullptr);

/// About a gap. `balanced`: an equilibrium, whose gap is the force's error over the stiffness, as
/// tables::equilibria has it, and moves with the model's draws; else a trim that is given and held. Stiffness and
/// modes: half the range that 68 % of `draws` models take (drawn_model), each about its own equilibrium to first order.
TrimError heave_trim_error(const Model& model, const Conditions& held, double gap, bool balanced,
                           std::size_t draws = tables::usual_draws);
/// An equilibrium, and how far one of a draw may lie from it (m) to be the same.
struct BalancedGap {
    double gap = 0, reach = 0;
    bool stable = false;
};
/// The same of all equilibria of a model: each draw is made once. Sets `exists`, too.
std::vector<TrimError> heave_trim_errors(const Model& model, const Conditions& held,
                                         const std::vector<BalancedGap>& balanced, std::size_t draws);
/// The same free to pitch. Throws core::InputError as HeavePitch does.
TrimError pitch_trim_error(const Model& model, const Conditions& held, double gap, double pitch, bool balanced,
                           std::size_t draws = tables::usual_draws);

}  // namespace underbody::dynamics
