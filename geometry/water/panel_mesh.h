// Panels for a potential flow out of any closed surface: even triangles that follow it and keep its sharp edges.
#pragma once

#include <cstddef>

#include "core/progress.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

struct PanelOptions {
    std::size_t panels = 1200;  ///< about how many (within some 15 % where the sharp edges allow it)
    double refinement = 1;      ///< edge length at the lowest point over that at the highest, in between in proportion
    double feature_angle = 0.5235987755982988;  ///< rad; sharper edges, and borders of patches, stay where they are
};

struct PanelMesh {
    SurfaceMesh mesh;             ///< closed and oriented as the surface, with its patches
    std::size_t triangles = 0;    ///< of the surface it was made from
    double distance_rms = 0;      ///< m, of panels (centres and middles of edges) from the surface, weighted by area
    double distance_largest = 0;  ///< m
    double volume_error = 0;      ///< (volume of the panels - that of the surface) over it
};

/// Long edges are split, short ones collapsed, edges flipped to Delaunay's, points evened in their tangent planes and
/// put back on the surface (Botsch and Kobbelt, "A remeshing approach to multiresolution modeling", 2004).
/// Deterministic. The surface must have passed its certificate. Throws core::InputError (kind "size") when the sharp
/// edges alone need more than five times the panels asked for.
PanelMesh panel_mesh(const SurfaceMesh& surface, const PanelOptions& options,
                     core::Progress& progress = core::Progress::none());

}  // namespace underbody::geometry
