#include "geometry/water/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/no_limit.h"
#include "geometry/body/exact_body.h"

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

namespace {

constexpr int steps_of_section = 60;

/// The lower hull in the plane of symmetry, unbent, from the base up, most points near it: forward of its middle, or
/// aft.
std::vector<Vec3> section_of_side(const SideProfile& profile, double sign) {
    std::vector<Vec3> points;
    for (int i = 0; i <= steps_of_section; ++i) {
        const double share = static_cast<double>(i) / steps_of_section;
        const SideProfile::At at = profile.at_arc(0.5 * share * share * profile.length());
        points.push_back({sign * at.half, 0, at.height});
    }
    return points;
}

/// Likewise of the ellipsoid (semi-axes a, c, `depth` above the base) with a ball of the edge's radius between them.
std::vector<Vec3> section_of_ellipsoid(double a, double c, double depth, double radius, double sign) {
    const auto of_angle = [&](double angle, double inward) {  // below the midplane; a point so far inside
        const double nx = std::cos(angle) / a, nz = -std::sin(angle) / c, size = std::hypot(nx, nz);
        return Vec3{a * std::cos(angle) - inward * nx / size, 0, depth - c * std::sin(angle) - inward * nz / size};
    };
    double from = 0, to = std::asin(std::min(1.0, depth / c));  // where the ball touches the ellipsoid
    for (int i = 0; radius > 0 && i < 50; ++i) {
        const double middle = 0.5 * (from + to);
        (of_angle(middle, radius).z > radius ? from : to) = middle;
    }
    const Vec3 ball = of_angle(to, radius);
    std::vector<Vec3> points;
    for (int i = 0; i <= steps_of_section; ++i) {
        const double share = static_cast<double>(i) / steps_of_section;
        const Vec3 hull = of_angle(to * (1 - 0.5 * share * share), 0);
        points.push_back({sign * hull.x, 0, hull.z});
        const double turned = 0.5 * share;  // rad, of the ball from its lowest point
        if (radius > 0 && ball.z - radius * std::cos(turned) < of_angle(to, 0).z) {
            points.push_back({sign * (ball.x + radius * std::sin(turned)), 0, ball.z - radius * std::cos(turned)});
        }
    }
    return points;
}

}  // namespace

double clearance_of_base(const BodyShape& shape, double gap, double pitch) {
    return gap + clearances_of_base(shape, {pitch}).front();
}

std::vector<double> clearances_of_base(const BodyShape& shape, const std::vector<double>& pitches) {
    BodyShape sharp = shape;  // an edge that is rounded all around takes long to find
    sharp.edge_radius = 0;
    const ExactBody body(sharp);
    const double slope = std::tan(shape.base_pitch);
    std::vector<double> lowest(pitches.size(), core::no_limit), up, forward;
    for (const double pitch : pitches) {
        up.push_back(std::cos(pitch));
        forward.push_back(std::sin(pitch));
    }
    const auto take = [&](double ahead, double above) {  // of the centre of the base, bent
        for (std::size_t i = 0; i < pitches.size(); ++i) {
            lowest[i] = std::min(lowest[i], above * up[i] + ahead * forward[i]);
        }
    };
    for (const bool front : {true, false}) {
        const double sign = front ? 1 : -1;
        const bool cut = body.cut(front ? Side::front : Side::back);
        const SideProfile side =
            cut ? SideProfile(-shape.base_extent().tail, body.semi_x(), body.depth(), shape.edge_radius)
                : SideProfile();
        for (const Vec3& point :
             cut ? section_of_side(side, sign)
                 : section_of_ellipsoid(body.semi_x(), body.semi_z(), body.depth(), shape.edge_radius, sign)) {
            const Vec3 p = body.bent(point);
            take(p.x - body.base_centre(), p.z);
        }
    }
    if (const TailPlate* plate = tail_plate(shape)) {
        // It leaves the hull where that is widest.
        take(-(body.semi_x() + plate->chord * std::cos(plate->inner_angle)) - body.base_centre(), body.depth());
    }
    if (shape.protrusion) {
        const ExactBody::Foot foot = body.protrusion_foot();
        for (int i = -steps_of_section; i <= steps_of_section; ++i) {
            const double from_axis = foot.radius * i / steps_of_section, ahead = foot.x + from_axis - body.cut_centre();
            take(ahead, slope * ahead - body.profile_depth(std::abs(from_axis)));
        }
    }
    return lowest;
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
