// What the makers of the parts of a body share: the growing port half, sizes, and chains along curves. Internal.
#pragma once

#include <functional>
#include <vector>

#include "geometry/body/exact_body.h"
#include "geometry/body/patch_mesher.h"
#include "geometry/body/strip.h"

namespace underbody::geometry {

enum PatchIndex : std::int32_t { base_patch = 0, hull_patch, protrusion_patch, nozzle_patch, bore_patch };

/// Wanted edge lengths, all from one: that on the base.
class EdgeLength {
public:
    EdgeLength(const ExactBody& body, double base_edge, double refinement);
    /// On the hull at a height.
    [[nodiscard]] double at_height(double height) const;
    /// On the base plane.
    [[nodiscard]] double on_base(double x, double y) const;
    [[nodiscard]] double base() const { return base_; }
    [[nodiscard]] double protrusion() const { return protrusion_; }
    [[nodiscard]] double nozzle() const { return nozzle_; }

    /// Way up the hull (mean over meridians of the ellipsoid) at samples of the height.
    struct Ascent {
        std::vector<double> height, way;
    };
    [[nodiscard]] const Ascent& ascent() const { return ascent_; }
    [[nodiscard]] double way(double height) const;

private:
    const ExactBody& body_;
    double base_, refinement_, protrusion_ = 0, nozzle_ = 0;
    Ascent ascent_;
};

class SurfaceBuilder {
public:
    SurfaceBuilder(const ExactBody& exact_body, const EdgeLength& edge_length, core::Progress& asked)
        : body(exact_body), edge(edge_length), progress(asked) {}

    const ExactBody& body;
    const EdgeLength& edge;
    core::Progress& progress;
    /// The port half; points bent.
    SurfaceMesh half;
    /// The same points unbent.
    std::vector<Vec3> straight;

    std::int32_t add(const Vec3& unbent_point);
    Chain add(const std::vector<Vec3>& unbent_points);
    [[nodiscard]] const Vec3& at(std::int32_t i) const { return straight[static_cast<std::size_t>(i)]; }

    /// A chain along `curve` (w from 0 to 1, unbent points) between two points that are there, at the local edge
    /// length.
    Chain chain(std::int32_t from, std::int32_t to, const std::function<Vec3(double)>& curve,
                const std::function<double(const Vec3&)>& length, int least = 1);
    /// The same, on the hull.
    Chain chain(std::int32_t from, std::int32_t to, const std::function<Vec3(double)>& curve);

    /// Fills the region that the chains enclose. `to_plane` and `to_space` (unbent) are inverse to each other on the
    /// surface.
    struct Face {
        std::vector<Chain> chains;
        std::vector<PatchProblem::Seed> seeds;
        std::function<PlanePoint(std::int32_t)> to_plane;
        std::function<Vec3(const PlanePoint&)> to_space;
        std::function<double(const PlanePoint&)> edge;
        bool turned = false;  ///< the plane seen from its front is the surface seen from inside
    };
    /// Triangles with their labels; new points are added to the mesh.
    struct Filled {
        std::vector<Triangle> triangles;
        std::vector<std::int32_t> label;
    };
    Filled fill(const Face& face);
    void fill(const Face& face, std::int32_t patch);
};

/// Points along a curve where the local edge length is used up; both ends included.
std::vector<Vec3> along(const std::function<Vec3(double)>& curve, const std::function<double(const Vec3&)>& length,
                        int least = 1);

/// Hull below the midplane with its creases, and the outline of the base. Returns the chains that the other parts need.
struct LowerHull {
    Chain base_outline;  ///< from the nose over port to the tail
    Chain midplane;      ///< likewise; empty when the hull was made whole (no sides)
};
LowerHull add_cut_hull(SurfaceBuilder& builder);

/// Rings over the ellipsoid from the chain `below` (at height `from`) to the top.
void add_rings(SurfaceBuilder& builder, double from, Chain below);

/// The base inside its outline, with protrusion and nozzle.
void add_base(SurfaceBuilder& builder, const Chain& outline);

}  // namespace underbody::geometry
