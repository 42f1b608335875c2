#include "geometry/water/panel_mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/no_limit.h"
#include "geometry/body/mass_properties.h"
#include "geometry/mesh/nearest_point.h"

namespace underbody::geometry {

namespace {

struct Traits : public OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    VertexAttributes(OpenMesh::Attributes::Status);
    EdgeAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status);
    EdgeTraits { bool feature = false; };
    FaceTraits { std::int32_t patch = 0; };
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;
using Point = Traits::Point;

Point mesh_point(const Vec3& p) { return {p.x, p.y, p.z}; }
Vec3 vec(const Point& p) { return {p[0], p[1], p[2]}; }

// Twice the area, in the direction of the normal.
Point turned(const Point& a, const Point& b, const Point& c) { return (b - a) % (c - a); }

// Angles of two triangles: their normals differ by less than 60 degrees, and the second has an area.
bool same_side(const Point& before, const Point& after) {
    return (before | after) > 0.5 * before.norm() * after.norm() && after.norm() > 1e-3 * before.norm();
}

class Remesher {
public:
    Remesher(const SurfaceMesh& surface, const PanelOptions& options, core::Progress& progress)
        : surface_(surface), options_(options), progress_(progress) {
        const Box box = bounding_box(surface);
        low_ = box.lower.z;
        height_ = core::never_zero(box.upper.z - box.lower.z);
        fill();
        for (std::size_t k = 0; k < surface.patch_names.size(); ++k) {
            on_patch_.emplace_back(surface, static_cast<std::int32_t>(k));
        }
    }

    PanelMesh run() {
        // An equilateral triangle of the edge L has the area 0.433 L^2.
        double weight = 0;
        for (std::size_t i = 0; i < surface_.triangles.size(); ++i) {
            const double share = grading(surface_.centre(i).z);
            weight += norm(surface_.area_vector(i)) / (share * share);
        }
        const auto wanted = static_cast<double>(options_.panels);
        edge_ = std::sqrt(weight / (0.4330127 * wanted));
        for (int trial = 0; trial < 4; ++trial) {
            for (int pass = 0; pass < (trial == 0 ? 8 : 4); ++pass) {
                split();
                collapse();
                flip();
                even_out();
                progress_.check();
            }
            const double ratio = static_cast<double>(mesh_.n_faces()) / wanted;
            if (ratio > 0.88 && ratio < 1.15) {
                break;
            }
            edge_ *= std::sqrt(std::clamp(ratio, 0.3, 3.0));
        }
        if (mesh_.n_faces() > 5 * options_.panels + 500) {
            throw core::InputError("size",
                                   "the sharp edges of the surface need " + std::to_string(mesh_.n_faces()) +
                                       " panels, " + std::to_string(options_.panels) + " were asked for",
                                   {}, "ask for more panels, or take a smoother surface");
        }
        return measured();
    }

private:
    void fill() {
        for (const Vec3& p : surface_.points) {
            mesh_.add_vertex(mesh_point(p));
        }
        for (std::size_t i = 0; i < surface_.triangles.size(); ++i) {
            const Triangle& t = surface_.triangles[i];
            const FaceHandle face = mesh_.add_face(VertexHandle(t[0]), VertexHandle(t[1]), VertexHandle(t[2]));
            if (!face.is_valid()) {
                throw core::InputError("surface", "the surface is not manifold", {}, "repair it first");
            }
            mesh_.data(face).patch = surface_.patch[i];
        }
        const double limit = std::cos(options_.feature_angle);
        for (const EdgeHandle edge : mesh_.edges()) {
            const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0), o = mesh_.halfedge_handle(edge, 1);
            const Point m = normal(mesh_.face_handle(h)), n = normal(mesh_.face_handle(o));
            mesh_.data(edge).feature =
                mesh_.data(mesh_.face_handle(h)).patch != mesh_.data(mesh_.face_handle(o)).patch ||
                (m | n) < limit * m.norm() * n.norm();
        }
        mesh_.delete_isolated_vertices();
        mesh_.garbage_collection();
    }

    [[nodiscard]] Point normal(FaceHandle face) const {
        auto v = mesh_.cfv_iter(face);
        const Point a = mesh_.point(*v++), b = mesh_.point(*v++), c = mesh_.point(*v);
        return turned(a, b, c);
    }
    [[nodiscard]] double grading(double z) const {
        return options_.refinement + (1 - options_.refinement) * std::clamp((z - low_) / height_, 0.0, 1.0);
    }
    [[nodiscard]] double wanted(const Point& p) const { return edge_ * grading(p[2]); }

    enum class Kind { free, line, corner };
    [[nodiscard]] Kind kind(VertexHandle v) const {
        std::array<Point, 2> ways{};
        std::size_t features = 0;
        for (auto h = mesh_.cvoh_iter(v); h.is_valid(); ++h) {
            if (mesh_.data(mesh_.edge_handle(*h)).feature) {
                if (features < 2) {
                    ways[features] = mesh_.point(mesh_.to_vertex_handle(*h)) - mesh_.point(v);
                }
                ++features;
            }
        }
        if (features == 0) {
            return Kind::free;
        }
        // A line that turns by more than 40 degrees has a corner there.
        return features == 2 && (ways[0] | ways[1]) < -0.766 * ways[0].norm() * ways[1].norm() ? Kind::line
                                                                                               : Kind::corner;
    }

    [[nodiscard]] double length(EdgeHandle edge) const {
        const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
        return (mesh_.point(mesh_.to_vertex_handle(h)) - mesh_.point(mesh_.from_vertex_handle(h))).norm();
    }
    [[nodiscard]] Point middle(EdgeHandle edge) const {
        const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
        return (mesh_.point(mesh_.to_vertex_handle(h)) + mesh_.point(mesh_.from_vertex_handle(h))) * 0.5;
    }
    [[nodiscard]] EdgeHandle between(VertexHandle a, VertexHandle b) const {
        return mesh_.edge_handle(mesh_.find_halfedge(a, b));
    }

    void split() {
        for (bool again = true; again;) {
            again = false;
            const auto count = static_cast<int>(mesh_.n_edges());
            for (int i = 0; i < count; ++i) {
                const EdgeHandle edge(i);
                const Point at = middle(edge);
                if (length(edge) > 4.0 / 3 * wanted(at)) {
                    split(edge, at);
                    again = true;
                }
            }
            progress_.check();
        }
    }

    void split(EdgeHandle edge, const Point& at) {
        const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0), o = mesh_.halfedge_handle(edge, 1);
        const VertexHandle a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h),
                           left = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)),
                           right = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o));
        const bool feature = mesh_.data(edge).feature;
        const std::int32_t left_patch = mesh_.data(mesh_.face_handle(h)).patch,
                           right_patch = mesh_.data(mesh_.face_handle(o)).patch;
        const VertexHandle v = mesh_.add_vertex(feature ? at : mesh_point(on_patch_[index(left_patch)](vec(at))));
        mesh_.split(edge, v);
        for (const VertexHandle end : {a, b}) {
            mesh_.data(between(v, end)).feature = feature;
        }
        for (const VertexHandle end : {left, right}) {
            mesh_.data(between(v, end)).feature = false;
        }
        for (auto f = mesh_.vf_iter(v); f.is_valid(); ++f) {
            bool of_left = false;
            for (auto w = mesh_.cfv_iter(*f); w.is_valid(); ++w) {
                of_left = of_left || *w == left;
            }
            mesh_.data(*f).patch = of_left ? left_patch : right_patch;
        }
    }

    void collapse() {
        const auto count = static_cast<int>(mesh_.n_edges());
        for (int i = 0; i < count; ++i) {
            const EdgeHandle edge(i);
            if (mesh_.status(edge).deleted() || length(edge) > 0.8 * wanted(middle(edge))) {
                continue;
            }
            for (const unsigned side : {0u, 1u}) {
                const HalfedgeHandle h = mesh_.halfedge_handle(edge, side);
                if (may_collapse(h)) {
                    collapse(h);
                    break;
                }
            }
            if (i % 4096 == 0) {
                progress_.check();
            }
        }
        mesh_.garbage_collection();
    }

    // The point that h comes from goes into the point it leads to.
    [[nodiscard]] bool may_collapse(HalfedgeHandle h) {
        const VertexHandle from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
        const Kind what = kind(from);
        if (what == Kind::corner || (what == Kind::line && !mesh_.data(mesh_.edge_handle(h)).feature) ||
            !mesh_.is_collapse_ok(h)) {
            return false;
        }
        const Point target = mesh_.point(to);
        for (auto f = mesh_.cvf_iter(from); f.is_valid(); ++f) {
            std::array<Point, 3> before, after;
            bool goes = false;
            std::size_t k = 0;
            for (auto v = mesh_.cfv_iter(*f); v.is_valid(); ++v, ++k) {
                before[k] = after[k] = mesh_.point(*v);
                if (*v == from) {
                    after[k] = target;
                } else {
                    goes = goes || *v == to;
                    const Point way = before[k] - target;
                    if (way.norm() > 4.0 / 3 * wanted(0.5 * (before[k] + target))) {
                        return false;
                    }
                }
            }
            if (!goes && !same_side(turned(before[0], before[1], before[2]), turned(after[0], after[1], after[2]))) {
                return false;
            }
        }
        return true;
    }

    void collapse(HalfedgeHandle h) {
        const HalfedgeHandle o = mesh_.opposite_halfedge_handle(h);
        const VertexHandle from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
        // The edges from both ends to a common neighbour become one.
        std::array<std::pair<VertexHandle, bool>, 2> sides;
        for (std::size_t k = 0; k < 2; ++k) {
            const VertexHandle other = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(k == 0 ? h : o));
            sides[k] = {other, mesh_.data(between(from, other)).feature || mesh_.data(between(to, other)).feature};
        }
        mesh_.collapse(h);
        for (const auto& [other, feature] : sides) {
            mesh_.data(between(to, other)).feature = feature;
        }
    }

    // Cosine of the angle at the point opposite to a half-edge, and its sine (not normalised).
    [[nodiscard]] std::pair<double, double> opposite_angle(HalfedgeHandle h) const {
        const Point a = mesh_.point(mesh_.from_vertex_handle(h)), b = mesh_.point(mesh_.to_vertex_handle(h)),
                    c = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
        return {(a - c) | (b - c), ((a - c) % (b - c)).norm()};
    }

    void flip() {
        for (int pass = 0; pass < 4; ++pass) {
            bool any = false;
            for (const EdgeHandle edge : mesh_.edges()) {
                if (!mesh_.data(edge).feature && mesh_.is_flip_ok(edge) && flip_helps(edge)) {
                    mesh_.flip(edge);
                    any = true;
                }
            }
            progress_.check();
            if (!any) {
                return;
            }
        }
    }

    [[nodiscard]] bool flip_helps(EdgeHandle edge) const {
        const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0), o = mesh_.halfedge_handle(edge, 1);
        const auto [c0, s0] = opposite_angle(h);
        const auto [c1, s1] = opposite_angle(o);
        if (c0 * s1 + s0 * c1 > -1e-9 * (std::abs(c0 * s1) + std::abs(s0 * c1))) {
            return false;  // the two angles make less than pi: Delaunay
        }
        const Point a = mesh_.point(mesh_.from_vertex_handle(h)), b = mesh_.point(mesh_.to_vertex_handle(h)),
                    l = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h))),
                    r = mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o)));
        const Point before = turned(a, b, l) + turned(b, a, r), first = turned(r, b, l), second = turned(l, a, r);
        return same_side(before, first) && same_side(before, second);
    }

    // Points of the faces to the middle of what is around them, in their tangent planes, then back to the surface.
    void even_out() {
        for (const VertexHandle v : mesh_.vertices()) {
            if (kind(v) != Kind::free) {
                continue;
            }
            Point sum(0, 0, 0), up(0, 0, 0);
            double weights = 0;
            for (auto f = mesh_.cvf_iter(v); f.is_valid(); ++f) {
                Point centre(0, 0, 0);
                for (auto w = mesh_.cfv_iter(*f); w.is_valid(); ++w) {
                    centre += mesh_.point(*w) / 3.0;
                }
                const Point n = normal(*f);
                const double size = wanted(centre), weight = n.norm() / (size * size);
                sum += weight * centre;
                weights += weight;
                up += n;
            }
            if (!(weights > 0) || !(up.norm() > 0)) {
                continue;
            }
            const Point here = mesh_.point(v), way = sum / weights - here, n = up / up.norm();
            const std::int32_t patch = mesh_.data(*mesh_.cvf_iter(v)).patch;
            const Point there = mesh_point(on_patch_[index(patch)](vec(here + way - (way | n) * n)));
            if (may_move(v, there)) {
                mesh_.set_point(v, there);
            }
        }
    }

    [[nodiscard]] bool may_move(VertexHandle moved, const Point& to) const {
        for (auto f = mesh_.cvf_iter(moved); f.is_valid(); ++f) {
            std::array<Point, 3> before, after;
            std::size_t k = 0;
            for (auto v = mesh_.cfv_iter(*f); v.is_valid(); ++v, ++k) {
                before[k] = mesh_.point(*v);
                after[k] = *v == moved ? to : before[k];
            }
            if (!same_side(turned(before[0], before[1], before[2]), turned(after[0], after[1], after[2]))) {
                return false;
            }
        }
        return true;
    }

    PanelMesh measured() {
        PanelMesh result;
        result.triangles = surface_.triangles.size();
        result.mesh.patch_names = surface_.patch_names;
        for (const VertexHandle v : mesh_.vertices()) {
            result.mesh.points.push_back(vec(mesh_.point(v)));
        }
        double squares = 0, weights = 0;
        for (const FaceHandle face : mesh_.faces()) {
            Triangle t{};
            std::size_t k = 0;
            for (auto v = mesh_.cfv_iter(face); v.is_valid(); ++v) {
                t[k++] = v->idx();
            }
            result.mesh.triangles.push_back(t);
            result.mesh.patch.push_back(mesh_.data(face).patch);
            const std::size_t i = result.mesh.triangles.size() - 1;
            const Vec3 &a = result.mesh.corner(i, 0), &b = result.mesh.corner(i, 1), &c = result.mesh.corner(i, 2);
            const double weight = norm(result.mesh.area_vector(i));
            for (const Vec3& p : {(a + b + c) / 3, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)}) {
                const double off = distance(p, on_patch_[index(mesh_.data(face).patch)](p));
                squares += weight * off * off;
                weights += weight;
                result.distance_largest = std::max(result.distance_largest, off);
            }
        }
        result.distance_rms = std::sqrt(squares / weights);
        result.volume_error = mass_properties(result.mesh).volume / mass_properties(surface_).volume - 1;
        return result;
    }

    static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

    const SurfaceMesh& surface_;
    PanelOptions options_;
    core::Progress& progress_;
    HalfEdges mesh_;
    std::vector<NearestPoint> on_patch_;
    double low_ = 0, height_ = 1, edge_ = 0;
};

}  // namespace

PanelMesh panel_mesh(const SurfaceMesh& surface, const PanelOptions& options, core::Progress& progress) {
    if (options.panels < 100 || !(options.refinement > 0.05 && options.refinement <= 1)) {
        throw core::InputError("range", "panels of a surface: at least 100, refinement above 0.05 and at most 1");
    }
    return Remesher(surface, options, progress).run();
}

}  // namespace underbody::geometry
