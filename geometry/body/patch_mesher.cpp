#include "geometry/body/patch_mesher.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <stdexcept>

#include "geometry/body/patch_improver.h"

namespace underbody::geometry {

namespace {

using FlatKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct FaceInfo {
    std::int32_t label = -1;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, FlatKernel>;
using FaceInfoBase = CGAL::Triangulation_face_base_with_info_2<FaceInfo, FlatKernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<FlatKernel, FaceInfoBase>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<FlatKernel, Structure,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Face = Triangulation::Face_handle;
using FlatPoint = FlatKernel::Point_2;

double squared(const FlatPoint& a, const FlatPoint& b) {
    const double dx = a.x() - b.x(), dy = a.y() - b.y();
    return dx * dx + dy * dy;
}

class Refiner {
public:
    explicit Refiner(const PatchProblem& problem) : problem_(problem) {
        insert_given();
        label_regions();
        for (int pass = 0; pass < 60 && refine_once(); ++pass) {
        }
    }

    PatchTriangles take() {
        PatchTriangles result;
        result.points = problem_.points;
        for (auto v = triangulation_.finite_vertices_begin(); v != triangulation_.finite_vertices_end(); ++v) {
            if (v->info() < 0) {
                v->info() = static_cast<std::int32_t>(result.points.size());
                result.points.push_back({v->point().x(), v->point().y()});
            }
        }
        for (auto f = triangulation_.finite_faces_begin(); f != triangulation_.finite_faces_end(); ++f) {
            if (f->info().label >= 0) {
                result.triangles.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
                result.label.push_back(f->info().label);
            }
        }
        return result;
    }

private:
    void insert_given() {
        std::vector<Triangulation::Vertex_handle> handles;
        Face hint;
        for (std::size_t i = 0; i < problem_.points.size(); ++i) {
            const auto handle = triangulation_.insert(FlatPoint(problem_.points[i].u, problem_.points[i].v), hint);
            handle->info() = static_cast<std::int32_t>(i);
            hint = handle->face();
            handles.push_back(handle);
        }
        if (triangulation_.number_of_vertices() != problem_.points.size()) {
            throw std::logic_error("two points of a patch coincide");
        }
        for (const auto& [a, b] : problem_.segments) {
            triangulation_.insert_constraint(handles[static_cast<std::size_t>(a)],
                                             handles[static_cast<std::size_t>(b)]);
        }
    }

    // Everything that cannot be reached from outside without crossing a segment gets label 0, then the seeds theirs.
    void label_regions() {
        constexpr std::int32_t outside = -2;
        flood(triangulation_.infinite_face(), outside);
        for (auto f = triangulation_.all_faces_begin(); f != triangulation_.all_faces_end(); ++f) {
            f->info().label = f->info().label == outside ? -1 : 0;
        }
        for (const PatchProblem::Seed& seed : problem_.seeds) {
            const Face start = triangulation_.locate(FlatPoint(seed.at.u, seed.at.v));
            if (start->info().label < 0) {
                throw std::logic_error("a seed of a patch lies outside");
            }
            flood(start, seed.label);
        }
    }

    void flood(Face start, std::int32_t label) {
        std::vector<Face> open{start};
        while (!open.empty()) {
            const Face face = open.back();
            open.pop_back();
            if (face->info().label == label) {
                continue;
            }
            face->info().label = label;
            for (int k = 0; k < 3; ++k) {
                if (!face->is_constrained(k) && face->neighbor(k)->info().label != label) {
                    open.push_back(face->neighbor(k));
                }
            }
        }
    }

    struct Candidate {
        FlatPoint at;
        FlatPoint inside;  // of the triangle: the centroid
        double edge;
        bool too_large;
    };

    // Points that large or thin triangles ask for.
    std::vector<Candidate> candidates() const {
        std::vector<Candidate> found;
        for (auto f = triangulation_.finite_faces_begin(); f != triangulation_.finite_faces_end(); ++f) {
            if (f->info().label < 0) {
                continue;
            }
            const FlatPoint &a = f->vertex(0)->point(), &b = f->vertex(1)->point(), &c = f->vertex(2)->point();
            const FlatPoint middle((a.x() + b.x() + c.x()) / 3, (a.y() + b.y() + c.y()) / 3);
            const double edge = problem_.edge({middle.x(), middle.y()});
            const double ab = squared(a, b), bc = squared(b, c), ca = squared(c, a);
            const double shortest = std::min({ab, bc, ca}), longest = std::max({ab, bc, ca});
            const double twice_area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
            // circumradius R = product of edges / (4 area); sine of the smallest angle = shortest / (2 R)
            const double radius_squared = ab * bc * ca / (4 * twice_area * twice_area);
            const bool too_large = radius_squared > 0.49 * edge * edge || longest > 2.2 * edge * edge;
            const bool thin = shortest < 0.75 * radius_squared && shortest > 0.3 * edge * edge;
            if (too_large || thin) {
                found.push_back({CGAL::circumcenter(a, b, c), middle, edge, too_large});
            }
        }
        return found;
    }

    // True when the point was inserted: far enough from points and boundary, and inside.
    bool insert(const FlatPoint& p, double edge, Face& hint) {
        Triangulation::Locate_type where;
        int index = 0;
        const Face face = triangulation_.locate(p, where, index, hint);
        if (where != Triangulation::FACE && where != Triangulation::EDGE) {
            return false;
        }
        if (face->info().label < 0 || (where == Triangulation::EDGE && face->is_constrained(index))) {
            return false;
        }
        hint = face;
        if (too_near(face, p, edge)) {
            return false;
        }
        for (int k = 0; k < 3; ++k) {
            if (!face->is_constrained(k) && too_near(face->neighbor(k), p, edge)) {
                return false;
            }
        }
        const std::int32_t label = face->info().label;
        const auto vertex = triangulation_.insert(p, where, face, index);
        vertex->info() = -1;
        auto around = triangulation_.incident_faces(vertex), done = around;
        do {
            around->info().label = label;
        } while (++around != done);
        hint = vertex->face();
        return true;
    }

    bool too_near(const Face& face, const FlatPoint& p, double edge) const {
        if (triangulation_.is_infinite(face)) {
            return false;
        }
        for (int k = 0; k < 3; ++k) {
            const FlatPoint& a = face->vertex(k)->point();
            if (squared(a, p) < 0.42 * edge * edge) {
                return true;
            }
            if (face->is_constrained(k)) {
                const FlatPoint &b = face->vertex((k + 1) % 3)->point(), &c = face->vertex((k + 2) % 3)->point();
                const double twice = (c.x() - b.x()) * (p.y() - b.y()) - (c.y() - b.y()) * (p.x() - b.x());
                if (twice * twice < 0.2 * std::max(edge * edge * 0.5, squared(b, c)) * squared(b, c)) {
                    return true;
                }
            }
        }
        return false;
    }

    bool refine_once() {
        std::vector<Candidate> wanted = candidates();
        std::vector<std::ptrdiff_t> order(wanted.size());
        std::vector<FlatPoint> places;
        for (const Candidate& c : wanted) {
            places.push_back(c.at);
        }
        for (std::size_t i = 0; i < order.size(); ++i) {
            order[i] = static_cast<std::ptrdiff_t>(i);
        }
        using Map = CGAL::Spatial_sort_traits_adapter_2<FlatKernel, FlatPoint*>;
        CGAL::spatial_sort(order.begin(), order.end(), Map(places.data()));
        bool any = false;
        Face hint;
        for (const std::ptrdiff_t i : order) {
            if ((i & 1023) == 0) {
                problem_.progress->check();
            }
            const Candidate& c = wanted[static_cast<std::size_t>(i)];
            if (insert(c.at, c.edge, hint) || (c.too_large && insert(c.inside, c.edge, hint))) {
                any = true;
            }
        }
        return any;
    }

    const PatchProblem& problem_;
    Triangulation triangulation_;
};

}  // namespace

PatchTriangles fill_patch(const PatchProblem& problem) {
    PatchTriangles result;
    try {
        Refiner refiner(problem);
        result = refiner.take();
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        throw std::logic_error("edges of a patch cross");
    }
    improve_patch(result, problem);
    return result;
}

}  // namespace underbody::geometry
