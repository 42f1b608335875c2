// A body of the family over the ground in blocks of hexahedra: many cells in a gap of any thinness.
//
// Under the base the blocks are columns from base to ground, around it an O-grid of lines from the flank of the hull to
// the ground, above it lines from the hull to the far field, which is a dome on a cylinder. Blocks are laid out for the
// body without pitch, roll and bend; then the body and the water about it are moved to where it stands, and the columns
// under it are stretched.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/progress.h"
#include "geometry/blocks/mesh_quality.h"
#include "geometry/blocks/poly_mesh.h"
#include "geometry/body/body_shape.h"
#include "geometry/water/placement.h"

namespace underbody::geometry {

/// Draft is for the many first cases of a search: its loads differ from the coarse ones by up to a tenth of the
/// resultant.
enum class MeshDensity { draft, coarse, medium, fine };
const std::vector<std::string>& density_names();
std::string name_of(MeshDensity density);

struct BlockMeshOptions {
    Placement placement;
    MeshDensity density = MeshDensity::medium;  ///< of EVIE's half: about 22,000, 57,000, 138,000, 374,000 cells
    bool half = true;                           ///< only y > 0; a rolled body needs both halves
    double speed = 0.5;                         ///< m/s; with the viscosity it says how thin the first cell is
    double kinematic_viscosity = 1e-6;          ///< m^2/s
};

struct BlockMesh {
    PolyMesh mesh;  ///< ground at z = 0, x forward; patches: the body's, ground, symmetry (half), farfield
    std::vector<std::string> walls;  ///< patches of the body, named as in its surface
    MeshQuality quality;
    int cells_in_gap = 0;           ///< from base to ground, everywhere under the base
    double smallest_clearance = 0;  ///< m
    double wall_units_mean = 0;  ///< estimate of y+ in the first cells of the body, by a friction coefficient of 0.005
    double tail_plate_area = 0;  ///< m^2, of one side of the whole plate as it is in the mesh
    double far_volume = 0;       ///< m^3, inside far field and over the ground (and half), without the body
};

/// Makes and measures a mesh. Throws core::InputError: kind "contact" (the body touches the ground; says the nearest
/// gap), "symmetry" (a rolled half), "mesh" (no mesh of this kind that holds the limits of mesh_quality.h: says why and
/// what could be had instead), and as `check`; core::Cancelled.
BlockMesh make_block_mesh(const BodyShape& shape, const BlockMeshOptions& options,
                          core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const BlockMesh& mesh);

}  // namespace underbody::geometry
