// What effects add to the motion of a body on the ground: plain numbers, evaluated in surface_motion.cpp.
#pragma once

namespace underbody::dynamics {

/// X -= surge u, Y -= sway v, N -= yaw r; the thrust of every jet times thrust_gain, turned by jet_angle about the
/// vertical (bow to starboard); friction: added to the coefficient of the ground; N += moment + mass_aside X, X all
/// forces along the body; pull_x, pull_y in the directions of the ground.
struct SurfaceTerms {
    double surge = 0, sway = 0;     ///< N s/m
    double yaw = 0;                 ///< N m s
    double thrust_gain = 1;         ///< 1
    double jet_angle = 0;           ///< rad
    double friction = 0;            ///< 1
    double moment = 0;              ///< N m, bow to starboard
    double mass_aside = 0;          ///< m, centre of gravity to starboard of the declared one
    double pull_x = 0, pull_y = 0;  ///< N
    bool operator==(const SurfaceTerms&) const = default;
};

}  // namespace underbody::dynamics
