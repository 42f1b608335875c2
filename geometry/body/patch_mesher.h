// Triangles inside a plane region with given boundary points: constrained Delaunay refinement that never splits the
// boundary, judged on the surface that the plane stands for.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/progress.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

struct PlanePoint {
    double u = 0;
    double v = 0;
};

struct PatchProblem {
    /// Boundary and feature points; they stay where they are.
    std::vector<PlanePoint> points;
    /// Boundary and feature edges between them; they must not cross.
    std::vector<std::array<std::int32_t, 2>> segments;
    /// What the segments enclose is filled, with label 0 unless a point of the region (regions are separated by
    /// segments) is given here with another.
    struct Seed {
        PlanePoint at;
        std::int32_t label = 0;
    };
    std::vector<Seed> seeds;
    /// Wanted edge length in the plane.
    std::function<double(const PlanePoint&)> edge;
    /// The point of space that a point of the plane stands for.
    std::function<Vec3(const PlanePoint&)> surface;
    /// Asked whether to stop while it works.
    core::Progress* progress = &core::Progress::none();
};

struct PatchTriangles {
    std::vector<PlanePoint> points;   ///< those of the problem first
    std::vector<Triangle> triangles;  ///< counter-clockwise in the plane
    std::vector<std::int32_t> label;
};

/// Deterministic. Throws std::logic_error when segments cross or a seed lies outside: the caller's construction is
/// wrong.
PatchTriangles fill_patch(const PatchProblem& problem);

}  // namespace underbody::geometry
