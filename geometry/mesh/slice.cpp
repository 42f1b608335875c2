#include "geometry/mesh/slice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "core/angle.h"

namespace underbody::geometry {

namespace {

double coordinate(const Vec3& p, Axis axis) { return axis == Axis::x ? p.x : axis == Axis::y ? p.y : p.z; }

std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
    return std::uint64_t{static_cast<std::uint32_t>(std::min(a, b))} << 32 | static_cast<std::uint32_t>(std::max(a, b));
}

}  // namespace

std::vector<std::vector<Vec3>> slice(const SurfaceMesh& mesh, Axis axis, double at) {
    const Box box = bounding_box(mesh);
    const double hair = 1e-9 * norm(box.upper - box.lower);
    const auto touches = [&] {
        return std::any_of(mesh.points.begin(), mesh.points.end(),
                           [&](const Vec3& p) { return coordinate(p, axis) == at; });
    };
    for (int i = 0; i < 20 && touches(); ++i) {
        at += hair;
    }
    // Each cut triangle leads from the edge by which the curve enters to that by which it leaves.
    std::unordered_map<std::uint64_t, std::pair<std::uint64_t, Vec3>> next;
    std::vector<std::uint64_t> order;
    for (const Triangle& t : mesh.triangles) {
        std::uint64_t enters = 0, leaves = 0;
        Vec3 point;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &p = mesh.points[static_cast<std::size_t>(t[k])],
                       &q = mesh.points[static_cast<std::size_t>(t[(k + 1) % 3])];
            const double a = coordinate(p, axis) - at, b = coordinate(q, axis) - at;
            if (a < 0 && b > 0) {
                leaves = edge_key(t[k], t[(k + 1) % 3]);
            } else if (a > 0 && b < 0) {
                enters = edge_key(t[k], t[(k + 1) % 3]);
                point = p + (a / (a - b)) * (q - p);
            }
        }
        if (enters != 0) {
            next[enters] = {leaves, point};
            order.push_back(enters);
        }
    }
    std::vector<std::vector<Vec3>> curves;
    for (const std::uint64_t start : order) {
        std::vector<Vec3> curve;
        for (auto found = next.find(start); found != next.end();) {
            curve.push_back(found->second.second);
            const std::uint64_t onward = found->second.first;
            next.erase(found);
            found = next.find(onward);
        }
        if (curve.size() > 2) {
            curve.push_back(curve.front());
            curves.push_back(std::move(curve));
        }
    }
    return curves;
}

namespace {

using PointPair = std::array<std::int32_t, 2>;

std::vector<PointPair> feature_edges(const SurfaceMesh& mesh, double angle) {
    struct Side {
        std::uint64_t edge;
        std::size_t triangle;
    };
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            sides.push_back({edge_key(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]), t});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
    });
    const double facet = std::max(angle, 40 * core::degree);
    std::vector<PointPair> edges;
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        if (sides[i].edge != sides[i + 1].edge) {
            continue;
        }
        const std::size_t s = sides[i].triangle, t = sides[i + 1].triangle;
        const Vec3 m = mesh.area_vector(s), n = mesh.area_vector(t);
        const bool small = mesh.patch_names[static_cast<std::size_t>(mesh.patch[s])] == "protrusion";
        if (mesh.patch[s] != mesh.patch[t] || dot(m, n) < std::cos(small ? facet : angle) * norm(m) * norm(n)) {
            edges.push_back({static_cast<std::int32_t>(sides[i].edge >> 32),
                             static_cast<std::int32_t>(sides[i].edge & 0xffffffffu)});
        }
    }
    return edges;
}

}  // namespace

std::vector<std::vector<Vec3>> feature_lines(const SurfaceMesh& mesh, double angle) {
    const std::vector<PointPair> edges = feature_edges(mesh, angle);
    std::map<std::int32_t, std::vector<std::size_t>> at;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        at[edges[i][0]].push_back(i);
        at[edges[i][1]].push_back(i);
    }
    std::vector<char> used(edges.size(), 0);
    std::vector<std::vector<Vec3>> lines;
    const auto follow = [&](std::int32_t point, std::size_t edge) {
        std::vector<Vec3> line{mesh.points[static_cast<std::size_t>(point)]};
        for (bool more = true; more;) {
            used[edge] = 1;
            point = edges[edge][0] == point ? edges[edge][1] : edges[edge][0];
            line.push_back(mesh.points[static_cast<std::size_t>(point)]);
            const auto& around = at[point];
            more = around.size() == 2 && used[around[0]] + used[around[1]] == 1;
            if (more) {
                edge = used[around[0]] != 0 ? around[1] : around[0];
            }
        }
        lines.push_back(std::move(line));
    };
    // Open lines and those between forks first; what is left are closed ones.
    for (const bool closed : {false, true}) {
        for (const auto& [point, around] : at) {
            for (const std::size_t edge : around) {
                if (used[edge] == 0 && (closed || around.size() != 2)) {
                    follow(point, edge);
                }
            }
        }
    }
    return lines;
}

}  // namespace underbody::geometry
