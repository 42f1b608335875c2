// The nearest point of a triangulated surface.
#pragma once

#include <memory>

#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

/// A tree over triangles of a mesh; copies what it needs. Safe to ask from one thread at a time.
class NearestPoint {
public:
    /// Of all triangles, or of one patch (which must have some before a point is asked for).
    explicit NearestPoint(const SurfaceMesh& mesh, std::int32_t patch = -1);
    ~NearestPoint();
    NearestPoint(NearestPoint&&) noexcept;
    NearestPoint& operator=(NearestPoint&&) noexcept;

    [[nodiscard]] Vec3 operator()(const Vec3& p) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace underbody::geometry
