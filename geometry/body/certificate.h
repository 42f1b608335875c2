// What a mesher may rely on: a surface's soundness, checked after it was made and not by the one who made it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "geometry/body/body_shape.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

struct Certificate {
    bool closed = false;    ///< each edge belongs to two triangles
    bool oriented = false;  ///< that run through it in opposite directions, normals outward
    bool manifold = false;  ///< around each point the triangles form one fan
    bool self_intersection_free =
        false;                        ///< no two triangles share more than a corner or an edge; none is without area
    double smallest_angle = 0;        ///< rad
    double largest_aspect_ratio = 0;  ///< longest edge over the height on it, times sqrt(3)/2: 1 when equilateral

    /// Against the exact shape, where there is one: at the triangles' centres and the middles of their edges.
    struct Exact {
        double distance_rms = 0;      ///< m, weighted by area
        double distance_largest = 0;  ///< m
        Vec3 where;                   ///< of the largest
        double volume = 0;            ///< m^3, of the exact shape
        double volume_error = 0;      ///< (volume of the mesh - exact) / exact
    };
    std::optional<Exact> exact;

    struct Fault {
        std::string what;  ///< "open edge", "self-intersection", ...
        Vec3 where;        ///< m
    };
    /// The first few of each kind.
    std::vector<Fault> faults;

    [[nodiscard]] bool passed() const { return closed && oriented && manifold && self_intersection_free; }
};

Certificate certify(const SurfaceMesh& mesh, core::Progress& progress = core::Progress::none());
/// Also measures the mesh (as made, not placed) against the exact shape.
Certificate certify(const SurfaceMesh& mesh, const BodyShape& shape, core::Progress& progress = core::Progress::none());

/// Throws core::InputError (kind "surface") with the first fault and its place when it did not pass.
void require(const Certificate& certificate, const std::string& name);

/// Keys `closed`, `oriented`, `manifold`, `self_intersection_free`, `passed`, `smallest_angle`, `largest_aspect_ratio`,
/// `faults`, and where there is an exact shape `distance_rms`, `distance_largest`, `exact_volume`, `volume_error`.
void to_json(nlohmann::json& json, const Certificate& certificate);

}  // namespace underbody::geometry
