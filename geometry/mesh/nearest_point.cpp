#include "geometry/mesh/nearest_point.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

namespace underbody::geometry {

namespace {

using SearchKernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<SearchKernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<SearchKernel, Triangles::const_iterator>;

SearchKernel::Point_3 search_point(const Vec3& p) { return {p.x, p.y, p.z}; }

}  // namespace

struct NearestPoint::Tree {
    Triangles triangles;
    CGAL::AABB_tree<CGAL::AABB_traits<SearchKernel, Primitive>> boxes;
};

NearestPoint::NearestPoint(const SurfaceMesh& mesh, std::int32_t patch) : tree_(std::make_unique<Tree>()) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (patch < 0 || mesh.patch[i] == patch) {
            tree_->triangles.emplace_back(search_point(mesh.corner(i, 0)), search_point(mesh.corner(i, 1)),
                                          search_point(mesh.corner(i, 2)));
        }
    }
    if (!tree_->triangles.empty()) {
        tree_->boxes.insert(tree_->triangles.begin(), tree_->triangles.end());
        tree_->boxes.build();
        tree_->boxes.accelerate_distance_queries();
    }
}

NearestPoint::~NearestPoint() = default;
NearestPoint::NearestPoint(NearestPoint&&) noexcept = default;
NearestPoint& NearestPoint::operator=(NearestPoint&&) noexcept = default;

Vec3 NearestPoint::operator()(const Vec3& p) const {
    const SearchKernel::Point_3 q = tree_->boxes.closest_point(search_point(p));
    return {q.x(), q.y(), q.z()};
}

}  // namespace underbody::geometry
