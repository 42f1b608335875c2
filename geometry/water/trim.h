// How a body floats with what is in it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "geometry/body/loading.h"
#include "geometry/body/mass_properties.h"

namespace underbody::geometry {

/// A wholly submerged body at rest in water.
struct Trim {
    double mass = 0;          ///< kg
    Vec3 centre_of_gravity;   ///< m, axes of the mesh
    Matrix3 inertia{};        ///< kg m^2 about the centre of gravity, axes of the mesh
    double buoyancy = 0;      ///< N
    double net_weight = 0;    ///< N, weight less buoyancy, positive sinks
    Vec3 centre_of_buoyancy;  ///< m
    bool stable = false;      ///< the centre of buoyancy lies above the centre of gravity
    bool neutral = false;     ///< the two centres are one, to rounding: it stays as it is turned
    double pitch = 0;         ///< rad, nose up, where the body comes to rest; 0 when not stable
    double roll = 0;          ///< rad, starboard down
    /// N m per rad about the equilibrium: buoyancy times the distance of the two centres; negative: it turns over.
    double righting_stiffness = 0;
    /// N m, nose up, of weight and buoyancy at a pitch (roll 0): against the angle from the equilibrium.
    [[nodiscard]] double pitch_moment(double at_pitch) const;
};
/// `body`: volume, centroid and inertia of its surface; `loading`: what it weighs and where, in the same axes;
/// `water_density` in kg/m^3. Throws core::InputError where nothing has a mass.
Trim trim(const MassProperties& body, const Loading& loading, double water_density = default_water_density);

/// Where the point mass `name` must lie (at its own height) for the wanted pitch and roll at rest.
/// Throws core::InputError: no such mass, a place outside the box of the body (names the pitch or roll that can be
/// had), a centre of gravity above the centre of buoyancy.
Vec3 ballast_position(const MassProperties& body, const Loading& loading, const std::string& name, double pitch,
                      double roll);

void to_json(nlohmann::json& json, const Trim& trim);

}  // namespace underbody::geometry
