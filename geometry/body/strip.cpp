#include "geometry/body/strip.h"

namespace underbody::geometry {

void fill_strip(SurfaceMesh& mesh, const Chain& lower, const Chain& upper, std::int32_t patch) {
    const auto at = [&](std::int32_t i) -> const Vec3& { return mesh.points[static_cast<std::size_t>(i)]; };
    const auto squared = [&](std::int32_t i, std::int32_t j) {
        const Vec3 d = at(i) - at(j);
        return dot(d, d);
    };
    std::size_t i = 0, j = 0;
    while (i + 1 < lower.size() || j + 1 < upper.size()) {
        bool along_lower = j + 1 >= upper.size();
        if (!along_lower && i + 1 < lower.size()) {
            along_lower = squared(lower[i + 1], upper[j]) < squared(lower[i], upper[j + 1]);
        }
        if (along_lower) {
            mesh.triangles.push_back({lower[i], lower[i + 1], upper[j]});
            ++i;
        } else {
            mesh.triangles.push_back({lower[i], upper[j + 1], upper[j]});
            ++j;
        }
        mesh.patch.push_back(patch);
    }
}

}  // namespace underbody::geometry
