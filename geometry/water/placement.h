// A body over flat ground: where it stands, how near it comes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/table.h"
#include "geometry/body/body_shape.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

/// Of the body-as-made (origin at the centre of the base) over the ground plane z = 0.
struct Placement {
    double gap = 0;    ///< m, from the ground up to the centre of the base
    double pitch = 0;  ///< rad, nose up positive, about the centre of the base
    double roll = 0;   ///< rad, starboard down positive, about the centre of the base; pitch is applied after roll
};

/// Rotates about the centre of the base (the origin) and lifts by the gap: ground at z = 0. Points in m, axes of the
/// body (x forward, y to port, z up) and of the ground.
Vec3 placed(const Vec3& point, const Placement& placement);
SurfaceMesh placed(const SurfaceMesh& body, const Placement& placement);

struct Clearance {
    double smallest = 0;  ///< m, from the ground to the lowest point; negative: below the ground
    Vec3 where;           ///< that point, placed; of several equally low the one nearest to the middle of the base
    Vec3 where_on_body;   ///< the same in the axes of the body
    std::string patch;    ///< of a triangle that has it
};
/// `body` in m as made. Throws core::InputError for a mesh without triangles.
Clearance clearance(const SurfaceMesh& body, const Placement& placement);

/// Height of the lowest point of base, lower hull in the plane of symmetry, protrusion and tail plate over the ground,
/// without a mesh, at a pitch and no roll; m, negative below the ground. Within 0.1 mm of `clearance` (which has no
/// tail plate). The shape must have passed `check`.
double clearance_of_base(const BodyShape& shape, double gap, double pitch);

/// The angles, about the centre of the base at a gap, at which the body first touches the ground; nothing when it does
/// not within 60 degrees. rad.
struct ContactAngles {
    std::optional<double> nose_up;    ///< the tail touches
    std::optional<double> nose_down;  ///< positive number: so many rad nose down
    std::optional<double> roll;
};
ContactAngles contact_angles(const SurfaceMesh& body, double gap);

/// Under side of a placed body against the height above the ground: how much of it (seen from below, m^2) lies lower.
struct AreaBelow {
    std::vector<double> height;  ///< m
    std::vector<double> area;    ///< m^2
};
/// At `points` heights (two at least), evenly from the ground to `up_to` in m. Every triangle that faces down counts,
/// by its area as seen from below.
AreaBelow underside_area(const SurfaceMesh& body, const Placement& placement, double up_to, std::size_t points = 400);
core::Figure figure(const AreaBelow& below);
/// Columns height [mm], area [cm^2].
core::Table table(const AreaBelow& below);

/// The gap under the base as a map seen from above (x forward to the right, y to port upward), mm.
core::Figure gap_figure(const SurfaceMesh& body, const Placement& placement);

void to_json(nlohmann::json& json, const AreaBelow& below);
void to_json(nlohmann::json& json, const Clearance& clearance);
void to_json(nlohmann::json& json, const ContactAngles& angles);

}  // namespace underbody::geometry
