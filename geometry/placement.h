// A body over flat ground: where it stands, how near it comes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "geometry/surface_mesh.h"

namespace underbody::geometry {

/// Of the body-as-made (origin at the centre of the base) over the ground plane z = 0.
struct Placement {
    double gap = 0;    ///< m, from the ground up to the centre of the base
    double pitch = 0;  ///< rad, nose up positive, about the centre of the base
    double roll = 0;   ///< rad, starboard down positive, about the centre of the base; pitch is applied after roll
};

/// Rotates about the centre of the base (the origin) and lifts by the gap: ground at z = 0.
Vec3 placed(const Vec3& point, const Placement& placement);
SurfaceMesh placed(const SurfaceMesh& body, const Placement& placement);

struct Clearance {
    double smallest = 0;  ///< m, from the ground to the lowest point; negative: below the ground
    Vec3 where;           ///< that point, placed
    Vec3 where_on_body;   ///< the same in the axes of the body
    std::string patch;    ///< of a triangle that has it
};
Clearance clearance(const SurfaceMesh& body, const Placement& placement);

}  // namespace underbody::geometry
