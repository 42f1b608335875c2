// Jets as a list of positions, directions and limits: wrench, allocation, choice of angles.
// Body frame: x forward, y starboard, z down, origin at the centre of gravity. Thrust is that ON the vehicle.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// Force and moment about the centre of gravity.
struct Wrench {
    Vector3 force{};   ///< N
    Vector3 moment{};  ///< N m
};

Vector3 cross(const Vector3& a, const Vector3& b);

/// Sum of the thrusts and of r x F. One thrust a jet.
Wrench jet_wrench(std::span<const Jet> jets, std::span<const double> thrust);

/// Angles and arms of EVIE's jets (docs/physics.md section 2.1). rad, m.
struct EvieJets {
    double alpha = 0, beta = 0, gamma = 0;
    double turn_x = 0, turn_y = 0, turn_z = 0;             ///< L_tu, L_tv, L_tw of J1, J2, J5, J6
    double pitch_x = 0, pitch_upper = 0, pitch_lower = 0;  ///< L_pu, L_pw (J3, J4), L_qw (J7, J8)
    double bottom = 0;                                     ///< depth of the bottom jet's mouth
    double maximum = 0.5, lag = 0;
    bool bidirectional = false;  ///< J3, J4, J7, J8 may reverse (reversed J3 is not J7)
};
/// J1 ... J8 and Jj, in this order.
std::vector<Jet> evie_jets(const EvieJets& layout);

/// Elevation that sends the thrust of J1, J2, J5, J6 through the centre of gravity in side view: no pitch moment.
double pitch_free_elevation(double turn_x, double turn_z, double gamma);
/// Yaw torque of one turning pair at full thrust: 2 F cos(beta) (L_tv cos(gamma) + L_tu sin(gamma)); largest at
/// tan(gamma) = L_tu/L_tv.
double pair_yaw_torque(double thrust, double beta, double gamma, double turn_x, double turn_y);
/// Yaw torque that a sideslip and friction under one side ask for: |C_mm| U^2 sin cos + mu N y.
double needed_yaw_torque(double munk_coefficient, double speed, double sideslip, double friction_force,
                         double friction_offset);
/// Munk's moment in yaw, 1/2 C_mm U^2 sin(2 sideslip), C_mm = A_x - A_y.
double munk_yaw_moment(double munk_coefficient, double speed, double sideslip);

/// The turning jets (J1, J2, J5, J6) of a list as angles and arms, from the one aft on starboard; nothing when the list
/// has no pair aft or fore that pushes forward and to the side.
std::optional<EvieJets> turning_layout(std::span<const Jet> jets);

/// Thrusts within the jets' limits whose wrench is nearest to the wanted one (weights per component), by bounded least
/// squares; among equals the smallest thrusts.
struct Allocation {
    std::vector<double> thrust;
    Wrench reached;
    double misfit = 0;  ///< root of the weighted sum of squares of what is missing
    bool saturated = false;
};
Allocation allocate(std::span<const Jet> jets, const Wrench& wanted,
                    const std::array<double, 6>& weights = {1, 1, 1, 10, 10, 10});

}  // namespace underbody::dynamics
