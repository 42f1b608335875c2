#include "geometry/water/placement.h"

#include <cmath>

#include "core/error.h"

namespace underbody::geometry {

Vec3 placed(const Vec3& p, const Placement& placement) {
    // Roll about x (starboard, that is -y, goes down), then pitch about y (the nose, +x, goes up).
    const double cr = std::cos(placement.roll), sr = std::sin(placement.roll);
    const double y = cr * p.y - sr * p.z, z = sr * p.y + cr * p.z;
    const double cp = std::cos(placement.pitch), sp = std::sin(placement.pitch);
    return {cp * p.x - sp * z, y, sp * p.x + cp * z + placement.gap};
}

SurfaceMesh placed(const SurfaceMesh& body, const Placement& placement) {
    SurfaceMesh result = body;
    for (Vec3& p : result.points) {
        p = placed(p, placement);
    }
    return result;
}

Clearance clearance(const SurfaceMesh& body, const Placement& placement) {
    if (body.triangles.empty()) {
        throw core::InputError("empty", "a surface without triangles has no clearance");
    }
    Clearance result;
    result.smallest = HUGE_VAL;
    for (std::size_t i = 0; i < body.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p = placed(body.corner(i, k), placement);
            // Of points equally low (a flat base, a straight crest) the one nearest to the middle.
            const bool level = std::abs(p.z - result.smallest) < 1e-9;
            const auto away = [](const Vec3& v) { return std::hypot(v.x, v.y); };
            if (level ? away(body.corner(i, k)) < away(result.where_on_body) : p.z < result.smallest) {
                result.smallest = p.z;
                result.where = p;
                result.where_on_body = body.corner(i, k);
                result.patch = body.patch_names.at(static_cast<std::size_t>(body.patch[i]));
            }
        }
    }
    return result;
}

}  // namespace underbody::geometry
