// What a solver may rely on in a volume mesh: measured before it is solved.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "geometry/blocks/poly_mesh.h"

namespace underbody::geometry {

/// Measures as OpenFOAM's checkMesh defines them (1912: primitiveMeshCheck).
struct MeshQuality {
    std::size_t cells = 0, faces = 0, points = 0;
    double volume = 0;           ///< m^3, of the domain
    double smallest_volume = 0;  ///< m^3, of a cell
    std::size_t negative_volumes = 0;
    double largest_non_orthogonality = 0;      ///< rad, between a face's normal and the line between its cells' centres
    double mean_non_orthogonality = 0;         ///< rad
    std::size_t severe_non_orthogonality = 0;  ///< faces above 70 degrees
    std::size_t inverted_faces = 0;            ///< whose normal points to the wrong side of that line
    double largest_skewness = 0;               ///< distance of the face's centre from that line over its size
    double cell_openness = 0;                  ///< largest share by which the area vectors of a cell do not close
    double boundary_openness = 0;              ///< of the whole boundary, over its area
    /// From walls of the body to the centres of the cells on them, m.
    double wall_distance_smallest = 0, wall_distance_mean = 0, wall_distance_largest = 0;
    Vec3 where;  ///< of the first fault, else of the largest skewness
};

/// Limits above which a solver of this kind was seen to fail, or checkMesh calls the mesh bad. A few faces may lie
/// above 70 degrees; none above 88.
inline constexpr double largest_allowed_skewness = 4, largest_allowed_non_orthogonality = 1.536;

/// `mesh` in m; `body_walls`: the patches that are the body, one at least, from which the wall distances are taken. A
/// mesh that cannot be solved on is measured too: fault_of() says why.
MeshQuality measure(const PolyMesh& mesh, const std::vector<std::string>& body_walls);
/// Why a mesh cannot be solved on; empty when it can.
std::string fault_of(const MeshQuality& quality);

/// Angles in rad, distances in m.
void to_json(nlohmann::json& json, const MeshQuality& quality);

}  // namespace underbody::geometry
