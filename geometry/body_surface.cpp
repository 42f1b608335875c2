#include "geometry/body_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/exact_body.h"
#include "geometry/strip.h"

namespace underbody::geometry {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double strip_height = 0.8660254037844386;  // of an equilateral triangle

// Half an outline from the nose (t = 0) over port to the tail, as points at equal distances.
template <class PointAt>
std::vector<Vec3> half_ring(const PointAt& point_at, double edge) {
    constexpr int samples = 256;
    std::vector<double> arc(samples + 1, 0.0);
    Vec3 last = point_at(0.0);
    for (int i = 1; i <= samples; ++i) {
        const Vec3 next = point_at(pi * i / samples);
        arc[static_cast<std::size_t>(i)] = arc[static_cast<std::size_t>(i) - 1] + distance(last, next);
        last = next;
    }
    const int count = std::max(2, static_cast<int>(std::lround(arc.back() / edge)));
    std::vector<Vec3> points;
    std::size_t j = 0;
    for (int i = 0; i <= count; ++i) {
        const double target = arc.back() * i / count;
        while (j + 2 < arc.size() && arc[j + 1] < target) {
            ++j;
        }
        const double fraction = (target - arc[j]) / (arc[j + 1] - arc[j]);
        Vec3 p = point_at(i == count ? pi : pi * (static_cast<double>(j) + fraction) / samples);
        if (i == 0 || i == count) {
            p.y = 0;
        }
        points.push_back(p);
    }
    return points;
}

Chain add_points(SurfaceMesh& mesh, const std::vector<Vec3>& points) {
    Chain chain;
    for (const Vec3& p : points) {
        chain.push_back(static_cast<std::int32_t>(mesh.points.size()));
        mesh.points.push_back(p);
    }
    return chain;
}

// Heights of the hull from base to top with the mean length of the way up (over three meridians) and half the
// circumference there.
struct Ascent {
    std::vector<double> height, way, half_circumference;
};

Ascent ascent_of(const ExactBody& body) {
    Ascent ascent;
    const double radius = body.shape().edge_radius;
    const double start = radius > 0 ? body.highest_fillet() : 0.0;
    if (radius > 0) {
        const double top = std::acos(std::clamp(1 - start / radius, -1.0, 1.0));
        for (int i = 0; i < 48; ++i) {
            const double sine = std::sin(0.5 * top * i / 48);
            ascent.height.push_back(2 * radius * sine * sine);
        }
    }
    const double low = std::asin((start - body.depth()) / body.semi_z());
    for (int i = 0; i <= 256; ++i) {
        ascent.height.push_back(i == 0     ? start
                                : i == 256 ? body.top()
                                           : body.depth() + body.semi_z() * std::sin(low + (pi / 2 - low) * i / 256));
    }
    for (std::size_t i = 0; i < ascent.height.size(); ++i) {
        const double u = ascent.height[i];
        double step = 0;
        if (i > 0) {
            for (const double t : {0.0, pi / 4, pi / 2}) {
                step += distance(body.ellipsoid_point(ascent.height[i - 1], t), body.ellipsoid_point(u, t)) / 3;
            }
        }
        ascent.way.push_back(i == 0 ? 0.0 : ascent.way.back() + step);
        const double x = body.ellipsoid_point(u, 0).x, y = body.ellipsoid_point(u, pi / 2).y;
        // Ramanujan's circumference of an ellipse, here only to choose sizes
        ascent.half_circumference.push_back(pi / 2 * (3 * (x + y) - std::sqrt((3 * x + y) * (x + 3 * y))));
    }
    return ascent;
}

// Edge length over that at the base, against the way up from the edge.
double growth(double way, double whole, double refinement) {
    const double x = std::min(1.0, way / (0.6 * whole));
    return 1 + (1 / refinement - 1) * x * x * (3 - 2 * x);
}

double base_edge(const Ascent& ascent, double base_area, const SurfaceOptions& options) {
    double cells = base_area / 2;  // triangles of edge 1 times sqrt(3)/4, port half
    for (std::size_t i = 1; i < ascent.way.size(); ++i) {
        const double edge =
            growth(0.5 * (ascent.way[i] + ascent.way[i - 1]), ascent.way.back(), options.edge_refinement);
        cells += 0.5 * (ascent.half_circumference[i] + ascent.half_circumference[i - 1]) *
                 (ascent.way[i] - ascent.way[i - 1]) / (edge * edge);
    }
    return std::sqrt(2 * cells / (std::sqrt(3.0) / 4 * static_cast<double>(options.triangles)));
}

void add_hull(SurfaceMesh& mesh, const ExactBody& body, const Ascent& ascent, double edge, double refinement,
              Chain below, std::int32_t patch) {
    // Rings where the number of steps taken at the local edge length is whole.
    std::vector<double> steps(ascent.way.size(), 0.0);
    for (std::size_t i = 1; i < steps.size(); ++i) {
        const double local = edge * growth(0.5 * (ascent.way[i] + ascent.way[i - 1]), ascent.way.back(), refinement);
        steps[i] = steps[i - 1] + (ascent.way[i] - ascent.way[i - 1]) / (strip_height * local);
    }
    const int rings = std::max(2, static_cast<int>(std::lround(steps.back())));
    std::size_t j = 0;
    for (int ring = 1; ring <= rings; ++ring) {
        const double target = steps.back() * ring / rings;
        while (j + 2 < steps.size() && steps[j + 1] < target) {
            ++j;
        }
        const double fraction = (target - steps[j]) / (steps[j + 1] - steps[j]);
        const double height = ascent.height[j] + fraction * (ascent.height[j + 1] - ascent.height[j]);
        const double local = edge * growth(ascent.way[j], ascent.way.back(), refinement);
        Chain above;
        if (ring == rings) {
            above = add_points(mesh, {{0, 0, body.top()}});
        } else {
            above = add_points(mesh,
                               half_ring([&](double t) { return body.bent(body.ellipsoid_point(height, t)); }, local));
        }
        fill_strip(mesh, below, above, patch);
        below = std::move(above);
    }
}

// The flat base by shrunken copies of its outline.
void add_plain_base(SurfaceMesh& mesh, const ExactBody& body, double edge, Chain outer, std::int32_t patch) {
    const double nose = body.ellipsoid_point(0, 0).x, side = body.ellipsoid_point(0, pi / 2).y;
    const int rings = std::max(1, static_cast<int>(std::lround(0.5 * (nose + side) / (strip_height * edge))));
    for (int ring = rings - 1; ring >= 0; --ring) {
        const double scale = static_cast<double>(ring) / rings;
        Chain inner;
        if (ring == 0) {
            inner = add_points(mesh, {body.bent({0, 0, 0})});
        } else {
            inner = add_points(mesh, half_ring(
                                         [&](double t) {
                                             const Vec3 p = body.ellipsoid_point(0, t);
                                             return body.bent({scale * p.x, scale * p.y, 0});
                                         },
                                         edge));
        }
        fill_strip(mesh, inner, outer, patch);
        outer = std::move(inner);
    }
}

}  // namespace

SurfaceMesh make_surface(const BodyShape& shape, const SurfaceOptions& options, core::Progress& progress) {
    check(shape);
    progress.check();
    const ExactBody body(shape);
    const Ascent ascent = ascent_of(body);
    const double nose = body.ellipsoid_point(0, 0).x, side = body.ellipsoid_point(0, pi / 2).y;
    const double edge = base_edge(ascent, pi * nose * side, options);
    SurfaceMesh half;
    half.patch_names = {"base", "hull"};
    const Chain outline =
        add_points(half, half_ring([&](double t) { return body.bent(body.ellipsoid_point(0, t)); }, edge));
    add_plain_base(half, body, edge, outline, 0);
    add_hull(half, body, ascent, edge, options.edge_refinement, outline, 1);
    return with_mirror_image(half);
}

}  // namespace underbody::geometry
