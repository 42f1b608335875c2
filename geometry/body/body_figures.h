// Drawings of a body: its section and its under side, with dimensions.
#pragma once

#include <string>

#include "core/figure.h"
#include "geometry/body/body_shape.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::geometry {

/// The plane of symmetry (x forward to the right, z up), mm, with length, height, base and clearances as dimensions.
core::Figure section_figure(const SurfaceMesh& body, const std::string& name);
/// From below as it lies (x forward to the right, y to port upward): outline of the hull, edges of the patches,
/// dimensions.
core::Figure underbody_figure(const SurfaceMesh& body, const std::string& name);

/// Sections and under sides of several bodies side by side, each with its name.
struct NamedBody {
    std::string name;
    const SurfaceMesh* mesh = nullptr;
};
core::Figure sheet_figure(const std::vector<NamedBody>& bodies, const std::string& title);

}  // namespace underbody::geometry
