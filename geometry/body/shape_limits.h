// What a shape's numbers may be, each with its nearest allowed value.
#pragma once

#include <vector>

#include "geometry/body/body_shape.h"

namespace underbody::geometry {

/// Outline of the flat base (inside the rounded edge), unbent, port half, from the nose end to the tail end; m.
struct OutlinePoint {
    double x = 0;
    double y = 0;
};
std::vector<OutlinePoint> flat_base_outline(const BodyShape& shape, std::size_t points = 400);

/// Distance from points (y >= 0) inside the port half of a convex outline and its mirror image to its nearest edge;
/// negative outside.
class InsideDistance {
public:
    explicit InsideDistance(const std::vector<OutlinePoint>& outline);
    [[nodiscard]] double operator()(double x, double y) const;

private:
    struct Edge {
        OutlinePoint from;
        double along_x = 0, along_y = 0, length = 0;
    };
    std::vector<Edge> edges_;  ///< those that have a length
};

/// Radius of the foot of the protrusion's profile: half its length and what the blend adds.
double protrusion_foot_radius(const Protrusion& protrusion);

/// Largest edge radius that leaves a base of at least a fifth of its length and width and a regular hull.
double largest_edge_radius(const BodyShape& shape);

}  // namespace underbody::geometry
