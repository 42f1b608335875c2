#include "geometry/mesh/self_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/no_limit.h"

namespace underbody::geometry {

namespace {

using ExactKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ExactPoint = ExactKernel::Point_3;

struct FloatBox {
    std::array<float, 3> low{}, high{};
    [[nodiscard]] bool meets(const FloatBox& o) const {
        return low[0] <= o.high[0] && o.low[0] <= high[0] && low[1] <= o.high[1] && o.low[1] <= high[1] &&
               low[2] <= o.high[2] && o.low[2] <= high[2];
    }
    void add(const FloatBox& o) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], o.low[k]);
            high[k] = std::max(high[k], o.high[k]);
        }
    }
};

FloatBox box_of(const SurfaceMesh& mesh, std::size_t t) {
    const auto down = [](double v) { return std::nextafter(static_cast<float>(v), -HUGE_VALF); };
    const auto up = [](double v) { return std::nextafter(static_cast<float>(v), HUGE_VALF); };
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    return {{down(std::min({a.x, b.x, c.x})), down(std::min({a.y, b.y, c.y})), down(std::min({a.z, b.z, c.z}))},
            {up(std::max({a.x, b.x, c.x})), up(std::max({a.y, b.y, c.y})), up(std::max({a.z, b.z, c.z}))}};
}

std::uint64_t spread(std::uint64_t v) {  // 21 bits to every third
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffff;
    v = (v | v << 16) & 0x1f0000ff0000ff;
    v = (v | v << 8) & 0x100f00f00f00f00f;
    v = (v | v << 4) & 0x10c30c30c30c30c3;
    return (v | v << 2) & 0x1249249249249249;
}

class Search {
public:
    Search(const SurfaceMesh& mesh, std::size_t limit, core::Progress& progress)
        : mesh_(mesh), limit_(limit), progress_(progress) {
        for (const Vec3& p : mesh.points) {
            points_.emplace_back(p.x, p.y, p.z);
        }
        order_along_curve();
        leaves_ = std::bit_ceil(std::max<std::size_t>(1, (order_.size() + leaf_size - 1) / leaf_size));
        build();
    }

    std::vector<std::pair<std::size_t, std::size_t>> run() {
        for (std::size_t t = 0; t < mesh_.triangles.size() && found_.size() < limit_; ++t) {
            const Triangle& c = mesh_.triangles[t];
            if (CGAL::collinear(at(c[0]), at(c[1]), at(c[2]))) {
                found_.emplace_back(t, t);
            }
        }
        // Pairs among flat triangles mean nothing to the tests below.
        if (found_.empty()) {
            within(1);
        }
        std::sort(found_.begin(), found_.end());
        return found_;
    }

private:
    static constexpr std::size_t leaf_size = 4;
    [[nodiscard]] const ExactPoint& at(std::int32_t i) const { return points_[static_cast<std::size_t>(i)]; }

    void order_along_curve() {
        const Box box = bounding_box(mesh_);
        const Vec3 size = box.upper - box.lower;
        const double scale = 2097151.0 / std::max({size.x, size.y, size.z, core::least_divisor});
        std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(mesh_.triangles.size());
        for (std::size_t t = 0; t < keys.size(); ++t) {
            const Vec3 p = (mesh_.centre(t) - box.lower) * scale;
            keys[t] = {spread(static_cast<std::uint64_t>(std::max(0.0, p.x))) |
                           spread(static_cast<std::uint64_t>(std::max(0.0, p.y))) << 1 |
                           spread(static_cast<std::uint64_t>(std::max(0.0, p.z))) << 2,
                       static_cast<std::uint32_t>(t)};
        }
        std::sort(keys.begin(), keys.end());
        for (const auto& [key, t] : keys) {
            order_.push_back(t);
        }
    }

    // A complete tree: node i has the children 2 i and 2 i + 1; leaves have four triangles each.
    void build() {
        constexpr float far = HUGE_VALF;
        nodes_.assign(2 * leaves_, FloatBox{{far, far, far}, {-far, -far, -far}});
        for (std::size_t i = 0; i < order_.size(); ++i) {
            boxes_.push_back(box_of(mesh_, order_[i]));
            nodes_[leaves_ + i / leaf_size].add(boxes_.back());
        }
        for (std::size_t i = leaves_; i-- > 1;) {
            nodes_[i] = nodes_[2 * i];
            nodes_[i].add(nodes_[2 * i + 1]);
        }
    }

    void within(std::size_t node) {
        if (found_.size() >= limit_) {
            return;
        }
        if (node >= leaves_) {
            const auto [first, last] = range(node);
            for (std::size_t i = first; i < last; ++i) {
                for (std::size_t j = i + 1; j < last; ++j) {
                    pair(i, j);
                }
            }
            return;
        }
        if (leaves_ / std::bit_floor(node) == 16) {
            progress_.check();
        }
        within(2 * node);
        within(2 * node + 1);
        between(2 * node, 2 * node + 1);
    }

    void between(std::size_t a, std::size_t b) {
        if (!nodes_[a].meets(nodes_[b]) || found_.size() >= limit_) {
            return;
        }
        if (a < leaves_) {
            between(2 * a, 2 * b);
            between(2 * a, 2 * b + 1);
            between(2 * a + 1, 2 * b);
            between(2 * a + 1, 2 * b + 1);
            return;
        }
        const auto [a_first, a_last] = range(a);
        const auto [b_first, b_last] = range(b);
        for (std::size_t i = a_first; i < a_last; ++i) {
            for (std::size_t j = b_first; j < b_last; ++j) {
                pair(i, j);
            }
        }
    }

    [[nodiscard]] std::pair<std::size_t, std::size_t> range(std::size_t leaf) const {
        const std::size_t first = std::min(order_.size(), (leaf - leaves_) * leaf_size);
        return {first, std::min(order_.size(), first + leaf_size)};
    }

    void pair(std::size_t i, std::size_t j) {
        if (!boxes_[i].meets(boxes_[j])) {
            return;
        }
        const std::size_t s = order_[i], t = order_[j];
        if (intersect(mesh_.triangles[s], mesh_.triangles[t]) && found_.size() < limit_) {
            found_.emplace_back(std::min(s, t), std::max(s, t));
        }
    }

    [[nodiscard]] bool intersect(const Triangle& s, const Triangle& t) const {
        std::array<std::size_t, 3> in_s{}, in_t{};
        std::size_t shared = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                if (s[i] == t[j] && shared < 3) {
                    in_s[shared] = i;
                    in_t[shared++] = j;
                }
            }
        }
        switch (shared) {
            case 0:
                return apart(s, t);
            case 1:
                return at_corner(s, in_s[0], t, in_t[0]);
            case 2:
                return at_edge(s, 3 - in_s[0] - in_s[1], t, 3 - in_t[0] - in_t[1]);
            default:
                return true;  // the same triangle twice
        }
    }

    // True when all other corners of t lie strictly on one side of the plane of s.
    [[nodiscard]] bool one_side(const Triangle& s, const Triangle& t, std::int32_t except) const {
        int side = 0;
        for (const std::int32_t p : t) {
            if (p == except) {
                continue;
            }
            const int o = CGAL::orientation(at(s[0]), at(s[1]), at(s[2]), at(p));
            if (o == 0 || (side != 0 && o != side)) {
                return false;
            }
            side = o;
        }
        return true;
    }

    [[nodiscard]] bool apart(const Triangle& s, const Triangle& t) const {
        if (one_side(s, t, -1) || one_side(t, s, -1)) {
            return false;
        }
        return CGAL::do_intersect(ExactKernel::Triangle_3(at(s[0]), at(s[1]), at(s[2])),
                                  ExactKernel::Triangle_3(at(t[0]), at(t[1]), at(t[2])));
    }

    [[nodiscard]] bool at_corner(const Triangle& s, std::size_t i, const Triangle& t, std::size_t j) const {
        if (one_side(s, t, s[i]) || one_side(t, s, s[i])) {
            return false;
        }
        // They have more in common than the corner exactly when the far edge of one meets the other.
        const ExactKernel::Segment_3 far_s(at(s[(i + 1) % 3]), at(s[(i + 2) % 3])),
            far_t(at(t[(j + 1) % 3]), at(t[(j + 2) % 3]));
        return CGAL::do_intersect(far_s, ExactKernel::Triangle_3(at(t[0]), at(t[1]), at(t[2]))) ||
               CGAL::do_intersect(far_t, ExactKernel::Triangle_3(at(s[0]), at(s[1]), at(s[2])));
    }

    [[nodiscard]] bool at_edge(const Triangle& s, std::size_t i, const Triangle& t, std::size_t j) const {
        const ExactPoint &p = at(s[(i + 1) % 3]), &q = at(s[(i + 2) % 3]), &a = at(s[i]), &b = at(t[j]);
        return CGAL::orientation(p, q, a, b) == CGAL::COPLANAR &&
               CGAL::coplanar_orientation(p, q, a, b) == CGAL::POSITIVE;
    }

    const SurfaceMesh& mesh_;
    std::size_t limit_;
    core::Progress& progress_;
    std::vector<ExactPoint> points_;
    std::vector<std::uint32_t> order_;
    std::vector<FloatBox> boxes_, nodes_;
    std::size_t leaves_ = 1;
    std::vector<std::pair<std::size_t, std::size_t>> found_;
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> self_intersections(const SurfaceMesh& mesh, std::size_t limit,
                                                                    core::Progress& progress) {
    return mesh.triangles.empty() ? std::vector<std::pair<std::size_t, std::size_t>>{}
                                  : Search(mesh, limit, progress).run();
}

}  // namespace underbody::geometry
