#include "geometry/mesh/surface_mesh.h"

#include <algorithm>
#include <limits>

#include "core/error.h"

namespace underbody::geometry {

Box bounding_box(const SurfaceMesh& mesh) {
    if (mesh.points.empty()) {
        return {};
    }
    Box box{mesh.points.front(), mesh.points.front()};
    for (const Vec3& p : mesh.points) {
        box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
        box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
    }
    return box;
}

std::vector<PatchSummary> patches(const SurfaceMesh& mesh) {
    std::vector<PatchSummary> result(mesh.patch_names.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i].name = mesh.patch_names[i];
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        PatchSummary& patch = result.at(static_cast<std::size_t>(mesh.patch[i]));
        patch.area += norm(mesh.area_vector(i));
        ++patch.faces;
    }
    return result;
}

double area(const SurfaceMesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        sum += norm(mesh.area_vector(i));
    }
    return sum;
}

namespace {

// The triangles for which `keep` holds, with the points they use.
template <class Keep>
SurfaceMesh part_of(const SurfaceMesh& mesh, const Keep& keep) {
    SurfaceMesh part;
    part.patch_names = mesh.patch_names;
    std::vector<std::int32_t> number(mesh.points.size(), -1);
    std::vector<char> used(mesh.points.size(), 0);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (keep(i)) {
            for (const std::int32_t p : mesh.triangles[i]) {
                used[static_cast<std::size_t>(p)] = 1;
            }
        }
    }
    for (std::size_t p = 0; p < used.size(); ++p) {
        if (used[p]) {
            number[p] = static_cast<std::int32_t>(part.points.size());
            part.points.push_back(mesh.points[p]);
        }
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (keep(i)) {
            Triangle t = mesh.triangles[i];
            for (std::int32_t& p : t) {
                p = number[static_cast<std::size_t>(p)];
            }
            part.triangles.push_back(t);
            part.patch.push_back(mesh.patch[i]);
        }
    }
    return part;
}

}  // namespace

SurfaceMesh patch_of(const SurfaceMesh& mesh, const std::string& name) {
    const auto found = std::find(mesh.patch_names.begin(), mesh.patch_names.end(), name);
    if (found == mesh.patch_names.end()) {
        throw core::InputError("name", "the surface has no patch '" + name + "'", {},
                               core::did_you_mean(name, mesh.patch_names));
    }
    const auto index = static_cast<std::int32_t>(found - mesh.patch_names.begin());
    SurfaceMesh part = part_of(mesh, [&](std::size_t i) { return mesh.patch[i] == index; });
    part.patch_names = {name};
    std::fill(part.patch.begin(), part.patch.end(), 0);
    return part;
}

SurfaceMesh with_mirror_image(const SurfaceMesh& half) {
    SurfaceMesh whole = half;
    std::vector<std::int32_t> image(half.points.size());
    for (std::size_t i = 0; i < half.points.size(); ++i) {
        const Vec3& p = half.points[i];
        if (p.y == 0) {
            image[i] = static_cast<std::int32_t>(i);
        } else {
            image[i] = static_cast<std::int32_t>(whole.points.size());
            whole.points.push_back({p.x, -p.y, p.z});
        }
    }
    const auto at = [&](std::int32_t p) { return image[static_cast<std::size_t>(p)]; };
    for (std::size_t i = 0; i < half.triangles.size(); ++i) {
        const Triangle& t = half.triangles[i];
        whole.triangles.push_back({at(t[0]), at(t[2]), at(t[1])});
        whole.patch.push_back(half.patch[i]);
    }
    return whole;
}

SurfaceMesh port_half(const SurfaceMesh& whole) {
    for (std::size_t i = 0; i < whole.triangles.size(); ++i) {
        double lower = std::numeric_limits<double>::max(), upper = -lower;
        for (std::size_t k = 0; k < 3; ++k) {
            lower = std::min(lower, whole.corner(i, k).y);
            upper = std::max(upper, whole.corner(i, k).y);
        }
        if (lower < 0 && upper > 0) {
            throw core::InputError("symmetry", "triangle " + std::to_string(i) + " crosses the plane y = 0");
        }
    }
    return part_of(whole, [&](std::size_t i) { return whole.centre(i).y > 0; });
}

bool is_watertight(const SurfaceMesh& mesh) {
    std::vector<std::uint64_t> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto from = static_cast<std::uint32_t>(t[k]), to = static_cast<std::uint32_t>(t[(k + 1) % 3]);
            if (from == to) {
                return false;
            }
            // The direction is the lowest bit, so that the two sides of an edge are neighbours after sorting.
            edges.push_back(std::uint64_t{std::min(from, to)} << 33 | std::uint64_t{std::max(from, to)} << 1 |
                            (from > to));
        }
    }
    std::sort(edges.begin(), edges.end());
    if (edges.empty() || edges.size() % 2 != 0) {
        return false;
    }
    for (std::size_t i = 0; i < edges.size(); i += 2) {
        if (edges[i] + 1 != edges[i + 1] || (edges[i] & 1) != 0 || (i > 0 && edges[i] >> 1 == edges[i - 1] >> 1)) {
            return false;
        }
    }
    return true;
}

}  // namespace underbody::geometry
