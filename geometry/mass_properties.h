// Volume, centroid and inertia of a closed surface, by the divergence theorem, exact for the triangles.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>

#include "geometry/surface_mesh.h"

namespace underbody::geometry {

using Matrix3 = std::array<std::array<double, 3>, 3>;

constexpr double standard_gravity = 9.80665;      ///< m/s^2
constexpr double default_water_density = 1000.0;  ///< kg/m^3 (docs/physics.md section 1)

/// SI, in the axes of the mesh.
struct MassProperties {
    double volume = 0;  ///< m^3
    double area = 0;    ///< m^2
    Vec3 centroid;      ///< of the volume, m
    /// Inertia tensor about the centroid for density 1 kg/m^3: m^5. Off-diagonal terms carry their minus sign.
    Matrix3 inertia{};
    Box bounding_box;

    /// N, upward, in water of the given density at rest.
    [[nodiscard]] double buoyancy(double water_density = default_water_density) const {
        return water_density * standard_gravity * volume;
    }
};

/// Throws core::InputError (kind "open") when the surface is not watertight or its volume is not positive.
/// Source: Eberly, "Polyhedral Mass Properties (Revisited)", 2002, with the origin moved to the middle of the box.
MassProperties mass_properties(const SurfaceMesh& mesh);

/// Keys `volume`, `area`, `centroid`, `inertia`, `buoyancy` (at the default density), `bounding_box` {`lower`,
/// `upper`}.
void to_json(nlohmann::json& json, const MassProperties& mass);

}  // namespace underbody::geometry
