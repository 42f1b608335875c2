#include "geometry/body/body_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "geometry/body/surface_builder.h"

namespace underbody::geometry {

namespace {

using std::numbers::pi;

// Half an outline of the ellipsoid piece at a height, at the local edge length.
std::vector<Vec3> half_ring(const ExactBody& body, double height, double edge) {
    return along(
        [&](double w) {
            Vec3 p = body.ellipsoid_point(height, pi * w);
            if (w == 0 || w == 1) {
                p.y = 0;
            }
            return p;
        },
        [edge](const Vec3&) { return edge; }, 2);  // with its mirror image a ring has four points at least
}

SurfaceMesh half_of(const ExactBody& body, double base_edge, double refinement, core::Progress& progress) {
    const EdgeLength edge(body, base_edge, refinement);
    SurfaceBuilder builder(body, edge, progress);
    builder.half.patch_names = {"base", "hull", "protrusion", "nozzle", "nozzle_bore"};
    if (body.shape().base == BaseKind::ellipse) {
        const Chain outline = builder.add(half_ring(body, 0, edge.at_height(0)));
        add_base(builder, outline);
        progress.check();
        add_rings(builder, 0, outline);
    } else {
        const LowerHull lower = add_cut_hull(builder);
        progress.check();
        add_base(builder, lower.base_outline);
        progress.check();
        add_rings(builder, body.depth(), lower.midplane);
    }
    return std::move(builder.half);
}

void drop_unused_patches(SurfaceMesh& mesh) {
    std::vector<std::int32_t> number(mesh.patch_names.size(), -1);
    std::vector<std::string> names;
    std::vector<char> used(number.size(), 0);
    for (const std::int32_t p : mesh.patch) {
        used[static_cast<std::size_t>(p)] = 1;
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i] != 0) {
            number[i] = static_cast<std::int32_t>(names.size());
            names.push_back(mesh.patch_names[i]);
        }
    }
    for (std::int32_t& p : mesh.patch) {
        p = number[static_cast<std::size_t>(p)];
    }
    mesh.patch_names = std::move(names);
}

}  // namespace

void add_rings(SurfaceBuilder& builder, double from, Chain below) {
    const ExactBody& body = builder.body;
    const EdgeLength::Ascent& ascent = builder.edge.ascent();
    // Heights where the number of steps, taken at the local edge length, is whole.
    std::vector<double> heights{from}, steps{0.0};
    double way = builder.edge.way(from);
    for (std::size_t i = 0; i < ascent.height.size(); ++i) {
        if (ascent.height[i] > from) {
            const double middle = 0.5 * (heights.back() + ascent.height[i]);
            steps.push_back(steps.back() + (ascent.way[i] - way) / (0.8660254 * builder.edge.at_height(middle)));
            heights.push_back(ascent.height[i]);
            way = ascent.way[i];
        }
    }
    const int rings = std::max(2, static_cast<int>(std::lround(steps.back())));
    std::size_t j = 0;
    for (int ring = 1; ring <= rings; ++ring) {
        builder.progress.check();
        const double target = steps.back() * ring / rings;
        while (j + 2 < steps.size() && steps[j + 1] < target) {
            ++j;
        }
        const double fraction = (target - steps[j]) / (steps[j + 1] - steps[j]);
        const double height = heights[j] + fraction * (heights[j + 1] - heights[j]);
        Chain above;
        if (ring == rings) {
            above = {builder.add({0, 0, body.top()})};
        } else {
            above = builder.add(half_ring(body, height, builder.edge.at_height(height)));
        }
        fill_strip(builder.half, below, above, hull_patch);
        below = std::move(above);
    }
}

SurfaceMesh make_surface(const BodyShape& shape, const SurfaceOptions& options, core::Progress& progress) {
    check(shape);
    if (options.triangles < 200 || options.triangles > 20'000'000) {
        throw core::InputError("range", "a surface of " + std::to_string(options.triangles) + " triangles", {},
                               "from 200 to 20000000 triangles");
    }
    if (!(options.edge_refinement > 0.05 && options.edge_refinement <= 1)) {
        throw core::InputError("range", "edge refinement must be above 0.05 and at most 1");
    }
    const ExactBody body(shape);
    // A coarse body tells how many triangles an edge length gives (their number grows with its inverse square).
    const double a = body.semi_x(), b = body.semi_y(), c = body.semi_z(), p = 1.6075;
    const double ellipsoid_area =
        4 * pi * std::pow((std::pow(a * b, p) + std::pow(b * c, p) + std::pow(c * a, p)) / 3, 1 / p);
    const auto wanted = static_cast<double>(options.triangles);
    double edge = 0.7 * std::sqrt(ellipsoid_area / (0.433 * std::min(wanted, 2000.0)));
    SurfaceMesh half;
    for (int trial = 0, failures = 0; trial < 5; ++trial) {
        try {
            half = half_of(body, edge, options.edge_refinement, progress);
        } catch (const std::logic_error& error) {
            // Chords of two curves cross where these run close together: shorter edges part them.
            if (++failures > 3) {
                throw core::InputError(
                    "surface",
                    "no surface of about " + std::to_string(options.triangles) + " triangles: " + error.what(), {},
                    "ask for more triangles, or take a less extreme shape");
            }
            edge *= 0.7;
            trial = 3;  // what is made with them is the surface, though it has more triangles
            continue;
        }
        const double ratio = 2 * static_cast<double>(half.triangles.size()) / wanted;
        if ((ratio > 0.93 && ratio < 1.08) || failures > 0) {
            break;
        }
        edge *= std::sqrt(ratio);
    }
    drop_unused_patches(half);
    for (Vec3& p : half.points) {
        p.x -= body.base_centre();
    }
    return with_mirror_image(half);
}

}  // namespace underbody::geometry
