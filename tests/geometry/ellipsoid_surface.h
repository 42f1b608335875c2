// A closed surface of known shape.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "geometry/body/surface_builder.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

/// The whole ellipsoid about the origin, about so many triangles, points on it, symmetric in y to the last bit; patch
/// `hull`.
inline SurfaceMesh ellipsoid_surface(double a, double b, double c, std::size_t triangles) {
    constexpr double pi = std::numbers::pi;
    SurfaceMesh half;
    half.patch_names = {"hull"};
    const double edge = std::sqrt(4 * pi / (0.433 * static_cast<double>(triangles)));  // on the unit sphere
    const int rings = std::max(4, static_cast<int>(std::lround(pi / (0.8660254 * edge))));
    const auto add = [&](const std::vector<Vec3>& points) {
        Chain chain;
        for (const Vec3& p : points) {
            chain.push_back(static_cast<std::int32_t>(half.points.size()));
            half.points.push_back(p);
        }
        return chain;
    };
    Chain below = add({{0, 0, -c}});
    for (int ring = 1; ring <= rings; ++ring) {
        const double angle = -pi / 2 + pi * ring / rings, s = std::cos(angle), z = c * std::sin(angle);
        Chain above;
        if (ring == rings) {
            above = add({{0, 0, c}});
        } else {
            const int count = std::max(3, static_cast<int>(std::lround(pi * s / edge)));
            std::vector<Vec3> points;
            for (int i = 0; i <= count; ++i) {
                const double t = pi * i / count;
                points.push_back({a * s * std::cos(t), i == 0 || i == count ? 0.0 : b * s * std::sin(t), z});
            }
            above = add(points);
        }
        fill_strip(half, below, above, 0);
        below = std::move(above);
    }
    return with_mirror_image(half);
}

}  // namespace underbody::geometry
