// SHAPE -> watertight surface with exact sharp edges.
#pragma once

#include "core/progress.h"
#include "geometry/body/body_shape.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

struct SurfaceOptions {
    /// About how many triangles the whole body gets (within some 10 %).
    std::size_t triangles = 20000;
    /// Edge length on base and edge over that on the top of the hull (graded in between).
    double edge_refinement = 0.5;
};

/// The surface of a body, watertight and oriented by construction: feature curves first, then what lies between.
/// Points lie on the exact shape; sharp edges are chains of mesh edges. Patches `base`, `hull`, and `protrusion`,
/// `nozzle` where the shape has them (the bore of a nozzle with depth belongs to `nozzle_bore`). Symmetric in y to the
/// last bit. Throws core::InputError as `check` does; core::Cancelled.
SurfaceMesh make_surface(const BodyShape& shape, const SurfaceOptions& options = {},
                         core::Progress& progress = core::Progress::none());

}  // namespace underbody::geometry
