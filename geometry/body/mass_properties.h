// Volume, centroid and inertia: of a closed surface by the divergence theorem, exact for its triangles; of a shape by
// quadrature over the exact body.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>

#include "core/water.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

using Matrix3 = std::array<std::array<double, 3>, 3>;

using core::default_water_density;
using core::standard_gravity;

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

class ExactBody;

/// Of the exact shape behind the surface `mesh` that was made of it, in the axes of the mesh: volume, centroid and
/// inertia to about 1e-9 of themselves, however coarse the mesh. The area is that of the triangles. The box is that of
/// the body, not only of the points of its mesh.
MassProperties mass_properties(const ExactBody& body, const SurfaceMesh& mesh);

/// m^3: how much more the smooth surface holds on which the corners of the triangles stand, estimated from the turn of
/// the normals along the edges; edges of more than 20 degrees stay sharp. Positive where the body bulges, 0 for a body
/// of plane faces. Within about a tenth of itself on smooth surfaces; falls with the square of the edges' length, as
/// what it estimates does.
double volume_left_out(const SurfaceMesh& mesh);

/// Keys `volume`, `area`, `centroid`, `inertia`, `buoyancy` (at the default density), `bounding_box` {`lower`,
/// `upper`}.
void to_json(nlohmann::json& json, const MassProperties& mass);

}  // namespace underbody::geometry
