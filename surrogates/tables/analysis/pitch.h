// Pitch: the windows in which the pitch moment restores, the trim torque that each needs, and heave coupled with pitch.
#pragma once

#include <array>
#include <complex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/line.h"

namespace underbody::tables {

/// A range of pitch in which the pitch moment restores (d moment / d pitch < 0, both nose up). Thesis figures 4-18,
/// 4-19 have the opposite sign.
struct PitchWindow {
    double lower = 0, upper = 0;  ///< rad
    /// One standard deviation of each edge, rad: from the errors of the points (40 draws of the table) and from how
    /// differently a spline and a parabola turn there. 0 at an end of the table, which is no extremum.
    double lower_sigma = 0, upper_sigma = 0;
    std::string side;                       ///< "nose up", "nose down" or "level" (holds zero)
    double best_pitch = 0;                  ///< rad, where it is stiffest
    double stiffness = 0;                   ///< N m/rad there, -dM/dpitch
    double trim_torque = 0;                 ///< N m, nose up, that holds it there: -M
    double trim_lower = 0, trim_upper = 0;  ///< N m over the window
};
/// The edges are extrema of the moment. A table that is interpolated without overshoot has them at its points by
/// construction; there they are those of the spline through the points. `moment`: a table of pitch_moment with an axis
/// pitch; `held`: its other axes.
std::vector<PitchWindow> pitch_windows(const ForceTable& moment, const Held& held);
core::Figure pitch_figure(const ForceTable& moment, const Held& held);
void to_json(nlohmann::json& json, const PitchWindow& window);

struct CoupledOptions {
    double net_weight = 0;    ///< N
    double trim_torque = 0;   ///< N m, nose up, constant
    double virtual_mass = 0;  ///< kg, mass + added mass in heave
    double virtual_inertia =
        0;      ///< kg m^2 (I_yy + B_q). Both or neither of the two: without them 1 kg and 1 kg m^2 are taken
    Held held;  ///< axes other than gap and pitch
};
struct CoupledEquilibrium {
    double gap = 0, pitch = 0;
    /// One standard deviation each from the errors of both tables, taken as independent: stiffness^-1 (sigma of lift,
    /// sigma of moment). 0 without errors, infinite where the stiffness is singular.
    double gap_sigma = 0, pitch_sigma = 0;  ///< m, rad
    /// -[[dF/dh, dF/dpitch], [dM/dh, dM/dpitch]]; N/m, N/rad, N, N m/rad.
    std::array<std::array<double, 2>, 2> stiffness{};
    /// Of mass^-1 stiffness, 1/s^2.
    std::array<std::complex<double>, 2> eigenvalues{};
    /// "stable": both real and positive; "divergent": one real and negative; "flutter": complex (grows without damping,
    /// the stiffness is not symmetric). Of what is not symmetric, mass and inertia decide between "stable" and
    /// "flutter".
    std::string kind;
    std::array<double, 2> frequency{};  ///< Hz, of a stable one whose mass and inertia are known; else 0
};
/// All points in the common range of lift and moment where both balance. Both tables need axes gap and pitch.
/// Throws core::UsageError: no common range, mass or inertia negative or without the other, a held axis that is none,
/// gap or pitch held.
std::vector<CoupledEquilibrium> coupled_equilibria(const ForceTable& lift, const ForceTable& moment,
                                                   const CoupledOptions& options);
/// Smallest and largest trim torque (N m, nose up) that would balance the pitch moment somewhere on the lines where
/// lift holds the net weight; nothing where it does so nowhere.
std::optional<std::pair<double, double>> trim_range(const ForceTable& lift, const ForceTable& moment,
                                                    const CoupledOptions& options);
/// Over gap and pitch the lines where lift balances the net weight and where the pitch moment balances the trim torque,
/// and the equilibria where they cross.
core::Figure coupled_figure(const ForceTable& lift, const ForceTable& moment, const CoupledOptions& options);
void to_json(nlohmann::json& json, const CoupledEquilibrium& equilibrium);

}  // namespace underbody::tables
