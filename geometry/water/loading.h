// What is in the body: its own mass, point masses, ballast; how it then floats.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/toml.h"
#include "geometry/body/mass_properties.h"

namespace underbody::geometry {

struct PointMass {
    std::string name;
    double mass = 0;  ///< kg
    Vec3 position;    ///< m, axes of the mesh: x forward, y to port, z up, from the centre of the base
};

/// [mass] of a SHAPE.toml, all optional:
///
///     [mass]
///     hull = "1.4 kg"            # spread evenly over the volume; or density = "620 kg/m^3"
///     [[mass.point]]
///     name = "battery"
///     mass = "0.5 kg"
///     position = ["20 mm", "0 mm", "15 mm"]   # x forward, y to port, z up, from the centre of the base
struct Loading {
    double uniform_density = 0;  ///< kg/m^3, of the hull over the whole volume
    double hull_mass = 0;        ///< kg, as an alternative to the density
    std::vector<PointMass> points;
};

/// Nothing when the file has no [mass]. Throws core::InputError: negative masses, both hull and density.
std::optional<Loading> loading_from(const core::TomlTable& root);

/// The [mass] of a SHAPE.toml, read together with the shape.
std::optional<Loading> read_loading(const std::filesystem::path& path);

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
Trim trim(const MassProperties& body, const Loading& loading, double water_density = default_water_density);

/// Where the point mass `name` must lie (at its own height) for the wanted pitch and roll at rest.
/// Throws core::InputError: no such mass, a place outside the box of the body (names the pitch or roll that can be
/// had), a centre of gravity above the centre of buoyancy.
Vec3 ballast_position(const MassProperties& body, const Loading& loading, const std::string& name, double pitch,
                      double roll);

void to_json(nlohmann::json& json, const Trim& trim);

}  // namespace underbody::geometry
