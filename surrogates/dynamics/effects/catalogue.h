// The kinds of effects, in the order of the catalogue.
#pragma once

#include "surrogates/dynamics/model/effect.h"

#define UNDERBODY_EFFECTS(X)    \
    X(constant_force)           \
    X(growing_force)            \
    X(coulomb_friction)         \
    X(linear_damping)           \
    X(quadratic_damping)        \
    X(squeeze_film_damping)     \
    X(lift_lag)                 \
    X(added_mass)               \
    X(gap_dependent_added_mass) \
    X(tether_stiffness)         \
    X(ambient_heave_current)    \
    X(periodic_disturbance)     \
    X(input_gain)               \
    X(input_dead_zone)          \
    X(input_delay)              \
    X(thrust_by_gap)            \
    X(actuator_lag)             \
    X(gap_sensor_bias)          \
    X(gap_sensor_delay)         \
    X(gap_sensor_drift)         \
    X(surface_roughness)        \
    X(history_force)            \
    X(pitch_damping)            \
    X(pitch_quadratic_damping)  \
    X(pitch_stiffness)          \
    X(moment_offset)            \
    X(input_arm)                \
    X(moment_gain)              \
    X(mass_centre_offset)       \
    X(tether_with_arm)          \
    X(added_pitch_inertia)      \
    X(pitch_sensor_bias)        \
    X(surge_damping)            \
    X(sway_damping)             \
    X(yaw_damping)              \
    X(thrust_gain)              \
    X(jet_misalignment)         \
    X(yaw_moment_offset)        \
    X(ground_friction)          \
    X(mass_centre_aside)        \
    X(cable_pull)               \
    X(gap_offset)               \
    X(force_bias)               \
    X(sensor_gain)              \
    X(drift)                    \
    X(speed_exponent)           \
    X(current)                  \
    X(temperature)              \
    X(strut_buoyancy)           \
    X(cable_buoyancy)           \
    X(guide_friction)           \
    X(pump_curve)               \
    X(pitch_misalignment)       \
    X(declared_parameter)       \
    X(unknown)

namespace underbody::dynamics {

#define UNDERBODY_DECLARE_EFFECT(name) const Effect& name##_effect();
UNDERBODY_EFFECTS(UNDERBODY_DECLARE_EFFECT)
#undef UNDERBODY_DECLARE_EFFECT

}  // namespace underbody::dynamics
