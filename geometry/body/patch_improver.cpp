#include "geometry/body/patch_improver.h"

#include <algorithm>
#include <span>
#include <unordered_set>

namespace underbody::geometry {

namespace {

// Quality of a triangle in space: area over the sum of squared edges, 1 when equilateral, 0 when flat. Cheaper than an
// angle and ordered much like the smallest one.
double roundness(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, bc = c - b;
    const double edges = dot(ab, ab) + dot(ac, ac) + dot(bc, bc);
    return edges > 0 ? 3.4641016151377544 * norm(cross(ab, ac)) / edges : 0.0;
}

class Improver {
public:
    Improver(PatchTriangles& patch, const PatchProblem& problem) : patch_(patch), problem_(problem) {
        for (const PlanePoint& p : patch.points) {
            space_.push_back(problem.surface(p));
        }
        for (const auto& [a, b] : problem.segments) {
            fixed_edges_.insert(key(a, b));
        }
    }

    void run() {
        link();
        for (int round = 0; round < 3; ++round) {
            flip_all();
            smooth();
        }
        flip_all();
    }

private:
    static std::uint64_t key(std::int32_t a, std::int32_t b) {
        return std::uint64_t{static_cast<std::uint32_t>(std::min(a, b))} << 32 |
               static_cast<std::uint32_t>(std::max(a, b));
    }
    [[nodiscard]] const Vec3& space(std::int32_t i) const { return space_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] const PlanePoint& plane(std::int32_t i) const { return patch_.points[static_cast<std::size_t>(i)]; }
    [[nodiscard]] double roundness_of(std::int32_t a, std::int32_t b, std::int32_t c) const {
        return roundness(space(a), space(b), space(c));
    }
    [[nodiscard]] static double turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
        return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
    }

    // neighbour_[t][k]: the triangle across the edge opposite corner k; -1 at the boundary and at segments.
    void link() {
        struct Side {
            std::uint64_t edge;
            std::int32_t triangle;
            std::int32_t corner;
        };
        std::vector<Side> sides;
        neighbour_.assign(patch_.triangles.size(), {-1, -1, -1});
        for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Triangle& corners = patch_.triangles[t];
                sides.push_back({key(corners[(k + 1) % 3], corners[(k + 2) % 3]), static_cast<std::int32_t>(t),
                                 static_cast<std::int32_t>(k)});
            }
        }
        std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
            return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
        });
        for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
            const Side &a = sides[i], &b = sides[i + 1];
            if (a.edge == b.edge && !fixed_edges_.contains(a.edge)) {
                neighbour_[static_cast<std::size_t>(a.triangle)][static_cast<std::size_t>(a.corner)] = b.triangle;
                neighbour_[static_cast<std::size_t>(b.triangle)][static_cast<std::size_t>(b.corner)] = a.triangle;
            }
        }
    }

    void replace_neighbour(std::int32_t triangle, std::int32_t old, std::int32_t with) {
        if (triangle >= 0) {
            auto& list = neighbour_[static_cast<std::size_t>(triangle)];
            *std::find(list.begin(), list.end(), old) = with;
        }
    }

    bool flip(std::int32_t t, std::size_t k) {
        const std::int32_t o = neighbour_[static_cast<std::size_t>(t)][k];
        if (o < 0) {
            return false;
        }
        Triangle& left = patch_.triangles[static_cast<std::size_t>(t)];
        Triangle& right = patch_.triangles[static_cast<std::size_t>(o)];
        auto& left_links = neighbour_[static_cast<std::size_t>(t)];
        auto& right_links = neighbour_[static_cast<std::size_t>(o)];
        const std::size_t m =
            static_cast<std::size_t>(std::find(right_links.begin(), right_links.end(), t) - right_links.begin());
        const std::int32_t a = left[k], b = left[(k + 1) % 3], c = left[(k + 2) % 3], d = right[m];
        const double now = std::min(roundness_of(a, b, c), roundness_of(d, c, b));
        const double then = std::min(roundness_of(a, b, d), roundness_of(a, d, c));
        if (then <= now * (1 + 1e-9) || turn(plane(a), plane(b), plane(d)) <= 0 ||
            turn(plane(a), plane(d), plane(c)) <= 0) {
            return false;
        }
        // t = (a, b, d), o = (a, d, c)
        const std::int32_t across_ab = left_links[(k + 2) % 3], across_ca = left_links[(k + 1) % 3];
        const std::int32_t across_bd = right_links[(m + 1) % 3], across_dc = right_links[(m + 2) % 3];
        left = {a, b, d};
        right = {a, d, c};
        // right was (d, c, b) from m on: opposite c lies edge b-d, opposite b lies edge d-c
        left_links = {across_bd, o, across_ab};
        right_links = {across_dc, across_ca, t};
        replace_neighbour(across_bd, o, t);
        replace_neighbour(across_ca, t, o);
        return true;
    }

    void flip_all() {
        for (int sweep = 0; sweep < 6; ++sweep) {
            problem_.progress->check();
            bool any = false;
            for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
                for (std::size_t k = 0; k < 3; ++k) {
                    if (neighbour_[t][k] > static_cast<std::int32_t>(t) && flip(static_cast<std::int32_t>(t), k)) {
                        any = true;
                    }
                }
            }
            if (!any) {
                return;
            }
        }
    }

    // Smart Laplacian: to the middle of the neighbours when the worst triangle around gets rounder.
    void smooth() {
        const std::size_t fixed = problem_.points.size(), count = patch_.points.size();
        std::vector<std::int32_t> start(count + 1, 0), around(3 * patch_.triangles.size());
        for (const Triangle& t : patch_.triangles) {
            for (const std::int32_t p : t) {
                ++start[static_cast<std::size_t>(p) + 1];
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            start[i + 1] += start[i];
        }
        std::vector<std::int32_t> fill(start.begin(), start.end() - 1);
        for (std::size_t t = 0; t < patch_.triangles.size(); ++t) {
            for (const std::int32_t p : patch_.triangles[t]) {
                around[static_cast<std::size_t>(fill[static_cast<std::size_t>(p)]++)] = static_cast<std::int32_t>(t);
            }
        }
        for (std::size_t i = fixed; i < count; ++i) {
            const std::span<const std::int32_t> ring(around.data() + start[i],
                                                     static_cast<std::size_t>(start[i + 1] - start[i]));
            move(static_cast<std::int32_t>(i), ring);
        }
    }

    void move(std::int32_t i, std::span<const std::int32_t> ring) {
        if (ring.empty()) {
            return;
        }
        PlanePoint target;
        double now = 1;
        for (const std::int32_t t : ring) {
            const Triangle& corners = patch_.triangles[static_cast<std::size_t>(t)];
            for (const std::int32_t p : corners) {
                if (p != i) {  // each neighbour comes twice
                    target.u += plane(p).u;
                    target.v += plane(p).v;
                }
            }
            now = std::min(now, roundness_of(corners[0], corners[1], corners[2]));
        }
        target.u /= 2 * static_cast<double>(ring.size());
        target.v /= 2 * static_cast<double>(ring.size());
        const auto index = static_cast<std::size_t>(i);
        const PlanePoint old_plane = patch_.points[index];
        const Vec3 old_space = space_[index];
        patch_.points[index] = target;
        space_[index] = problem_.surface(target);
        for (const std::int32_t t : ring) {
            const Triangle& corners = patch_.triangles[static_cast<std::size_t>(t)];
            if (turn(plane(corners[0]), plane(corners[1]), plane(corners[2])) <= 0 ||
                roundness_of(corners[0], corners[1], corners[2]) < now) {
                patch_.points[index] = old_plane;
                space_[index] = old_space;
                return;
            }
        }
    }

    PatchTriangles& patch_;
    const PatchProblem& problem_;
    std::vector<Vec3> space_;
    std::unordered_set<std::uint64_t> fixed_edges_;
    std::vector<std::array<std::int32_t, 3>> neighbour_;
};

}  // namespace

void improve_patch(PatchTriangles& patch, const PatchProblem& problem) { Improver(patch, problem).run(); }

}  // namespace underbody::geometry
