#include "geometry/body/surface_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/body/shape_limits.h"

namespace underbody::geometry {

namespace {

using std::numbers::pi;

}  // namespace

EdgeLength::EdgeLength(const ExactBody& body, double base_edge, double refinement)
    : body_(body), base_(base_edge), refinement_(refinement) {
    const double radius = body.shape().edge_radius;
    const double start = radius > 0 ? body.highest_fillet() : 0.0;
    if (radius > 0) {
        const double top = std::acos(std::clamp(1 - start / radius, -1.0, 1.0));
        for (int i = 0; i < 48; ++i) {
            const double sine = std::sin(0.5 * top * i / 48);
            ascent_.height.push_back(2 * radius * sine * sine);
        }
    }
    const double low = std::asin((start - body.depth()) / body.semi_z());
    for (int i = 0; i <= 256; ++i) {
        ascent_.height.push_back(i == 0     ? start
                                 : i == 256 ? body.top()
                                            : body.depth() + body.semi_z() * std::sin(low + (pi / 2 - low) * i / 256));
    }
    for (std::size_t i = 0; i < ascent_.height.size(); ++i) {
        double step = 0;
        if (i > 0) {
            for (const double t : {0.0, pi / 4, pi / 2}) {
                step +=
                    norm(body.ellipsoid_point(ascent_.height[i - 1], t) - body.ellipsoid_point(ascent_.height[i], t)) /
                    3;
            }
        }
        ascent_.way.push_back(i == 0 ? 0.0 : ascent_.way.back() + step);
    }
    if (body.shape().protrusion) {
        const Protrusion& p = *body.shape().protrusion;
        protrusion_ = std::min(0.7 * base_, p.length / (p.profile == ProtrusionProfile::rounded ? 8 : 5));
        if (p.blend_radius > 0) {
            protrusion_ = std::min(protrusion_, std::max(0.5 * p.blend_radius, p.length / 24));
        }
        // but leave most of the triangles to the rest
        protrusion_ = std::max(protrusion_, 0.3 * base_);
    }
    if (body.shape().nozzle) {
        nozzle_ = std::clamp(pi * body.shape().nozzle->diameter / 24, 0.2 * base_, base_);
    }
}

double EdgeLength::way(double height) const {
    const auto upper = std::upper_bound(ascent_.height.begin(), ascent_.height.end(), height);
    const std::size_t i =
        std::clamp<std::size_t>(static_cast<std::size_t>(upper - ascent_.height.begin()), 1, ascent_.height.size() - 1);
    const double fraction = (height - ascent_.height[i - 1]) / (ascent_.height[i] - ascent_.height[i - 1]);
    return ascent_.way[i - 1] + fraction * (ascent_.way[i] - ascent_.way[i - 1]);
}

double EdgeLength::at_height(double height) const {
    const double x = std::min(1.0, way(height) / (0.6 * ascent_.way.back()));
    const double graded = base_ * (1 + (1 / refinement_ - 1) * x * x * (3 - 2 * x));
    const double radius = body_.shape().edge_radius;
    if (radius > 0) {  // four edges around the rounding, but no finer than a quarter of the rest
        const double fine = std::clamp(0.35 * radius, 0.25 * base_, base_);
        return std::min(graded,
                        fine + 0.25 * std::max(0.0, way(height) - way(std::min(radius, body_.highest_fillet()))));
    }
    return graded;
}

double EdgeLength::on_base(double x, double y) const {
    double length = base_;
    constexpr double slope = 0.25;
    if (protrusion_ > 0) {
        const ExactBody::Foot foot = body_.protrusion_foot();
        const double away = std::hypot(x - foot.x, std::max(0.0, std::abs(y) - foot.half_axis)) - foot.radius;
        length = std::min(length, protrusion_ + slope * std::max(0.0, away));
    }
    if (nozzle_ > 0) {
        const double away = std::hypot(x - body_.shape().base_x(body_.shape().nozzle->position), y) -
                            body_.shape().nozzle->diameter / 2;
        length = std::min(length, nozzle_ + slope * std::max(0.0, away));
    }
    if (body_.shape().edge_radius > 0) {
        const double fine = at_height(0);
        if (fine < base_) {
            // distance to the edge, near enough: the outline of the ellipse or of the rectangle, whichever is nearer
            const Vec3 nose = body_.ellipsoid_point(0, 0), port = body_.ellipsoid_point(0, pi / 2);
            double away = (1 - std::hypot(x / nose.x, y / port.y)) * std::min(nose.x, port.y);
            if (body_.cut(Side::port)) {
                away = std::min(away, body_.profile(Side::port).base_half() - std::abs(y));
                away = std::min(away, x + body_.profile(Side::back).base_half());
            }
            if (body_.cut(Side::front)) {
                away = std::min(away, body_.profile(Side::front).base_half() - x);
            }
            length = std::min(length, fine + slope * std::max(0.0, away));
        }
    }
    return length;
}

std::int32_t SurfaceBuilder::add(const Vec3& p) {
    straight.push_back(p);
    Vec3 bent = body.bent(p);
    if (p.y == 0) {
        bent.y = 0;
    }
    half.points.push_back(bent);
    return static_cast<std::int32_t>(straight.size() - 1);
}

Chain SurfaceBuilder::add(const std::vector<Vec3>& points) {
    Chain chain;
    for (const Vec3& p : points) {
        chain.push_back(add(p));
    }
    return chain;
}

std::vector<Vec3> along(const std::function<Vec3(double)>& curve, const std::function<double(const Vec3&)>& length,
                        int least) {
    constexpr int samples = 200;
    std::vector<double> steps(samples + 1, 0.0);
    Vec3 last = curve(0);
    for (int i = 1; i <= samples; ++i) {
        const Vec3 next = curve(static_cast<double>(i) / samples);
        steps[static_cast<std::size_t>(i)] =
            steps[static_cast<std::size_t>(i) - 1] + norm(next - last) / length(0.5 * (next + last));
        last = next;
    }
    const int count = std::max(least, static_cast<int>(std::lround(steps.back())));
    std::vector<Vec3> points{curve(0)};
    std::size_t j = 0;
    for (int i = 1; i < count; ++i) {
        const double target = steps.back() * i / count;
        while (j + 2 < steps.size() && steps[j + 1] < target) {
            ++j;
        }
        const double fraction = (target - steps[j]) / (steps[j + 1] - steps[j]);
        points.push_back(curve((static_cast<double>(j) + fraction) / samples));
    }
    points.push_back(curve(1));
    return points;
}

Chain SurfaceBuilder::chain(std::int32_t from, std::int32_t to, const std::function<Vec3(double)>& curve,
                            const std::function<double(const Vec3&)>& length, int least) {
    const std::vector<Vec3> points = along(curve, length, least);
    Chain result{from};
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        result.push_back(add(points[i]));
    }
    result.push_back(to);
    return result;
}

Chain SurfaceBuilder::chain(std::int32_t from, std::int32_t to, const std::function<Vec3(double)>& curve) {
    return chain(from, to, curve, [this](const Vec3& p) { return edge.at_height(p.z); });
}

SurfaceBuilder::Filled SurfaceBuilder::fill(const Face& face) {
    PatchProblem problem;
    problem.progress = &progress;
    std::vector<std::int32_t> global;
    std::vector<std::int32_t> local(straight.size(), -1);
    for (const Chain& chain : face.chains) {
        for (std::size_t i = 0; i < chain.size(); ++i) {
            std::int32_t& number = local[static_cast<std::size_t>(chain[i])];
            if (number < 0) {
                number = static_cast<std::int32_t>(global.size());
                global.push_back(chain[i]);
                problem.points.push_back(face.to_plane(chain[i]));
            }
            if (i > 0) {
                problem.segments.push_back({local[static_cast<std::size_t>(chain[i - 1])], number});
            }
        }
    }
    problem.seeds = face.seeds;
    problem.edge = face.edge;
    problem.surface = [&](const PlanePoint& p) { return body.bent(face.to_space(p)); };
    const PatchTriangles patch = fill_patch(problem);
    for (std::size_t i = problem.points.size(); i < patch.points.size(); ++i) {
        global.push_back(add(face.to_space(patch.points[i])));
    }
    Filled filled;
    filled.label = patch.label;
    for (const Triangle& t : patch.triangles) {
        const auto number = [&](std::size_t k) { return global[static_cast<std::size_t>(t[k])]; };
        filled.triangles.push_back({number(0), number(face.turned ? 2 : 1), number(face.turned ? 1 : 2)});
    }
    return filled;
}

void SurfaceBuilder::fill(const Face& face, std::int32_t patch) {
    const Filled filled = fill(face);
    half.triangles.insert(half.triangles.end(), filled.triangles.begin(), filled.triangles.end());
    half.patch.insert(half.patch.end(), filled.triangles.size(), patch);
}

}  // namespace underbody::geometry
