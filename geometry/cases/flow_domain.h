// A body over the ground as a case for a solver: OpenFOAM as written, ANSYS as surfaces, journal and CCL.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/water.h"
#include "geometry/blocks/block_mesh.h"
#include "geometry/body/body_shape.h"
#include "geometry/mesh/surface_mesh.h"
#include "geometry/water/placement.h"

namespace underbody::geometry {

/// What makes the mesh of an OpenFOAM case. Blocks of hexahedra (geometry/blocks) for bodies of the family: many cells
/// in a gap of any thinness, wall units about 1. snappyHexMesh for any surface, about four cells across the smallest
/// gap.
enum class CaseMesher { blocks, snappy };
const std::vector<std::string>& mesher_names();

/// Steady flow past the body, in axes fixed to it: x forward, y to port, z up, ground at z = 0. Water and ground come
/// from ahead at `speed` (toward -x).
struct FlowOptions {
    Placement placement;                           ///< gap, pitch (roll must be 0 for a half model)
    double speed = 0.5;                            ///< m/s
    double density = core::default_water_density;  ///< kg/m^3
    double kinematic_viscosity = 1e-6;             ///< m^2/s
    double turbulence_intensity = 0.01;
    double viscosity_ratio = 5;                      ///< eddy over molecular viscosity at the inlet
    bool half = true;                                ///< only y > 0, with the plane y = 0 as symmetry
    CaseMesher mesher = CaseMesher::blocks;          ///< of a body of the family; a surface has snappy alone
    MeshDensity mesh_density = MeshDensity::medium;  ///< of blocks
    /// m^3/s through the nozzle of the whole body, straight out of its opening: blocks only. 0: the nozzle is a wall.
    double jet_flow = 0;
    // Of snappy:
    double upstream = 3, downstream = 6, side = 3, above = 3;  ///< in body lengths from the body
    double cell = 0.125;                                       ///< of the background mesh, in body lengths
    int surface_level = 3;                                     ///< halvings of the cell at the body
    int layers = 3;                                            ///< prism layers on the body
    int iterations = 0;                                        ///< at most; 0: 400, with blocks 800
};
int iterations_of(const FlowOptions& options);

/// The box and the names of its boundaries: inlet, outlet, ground, top, side, and symmetry (half) or side_starboard;
/// the body's patches keep their names.
struct FlowDomain {
    Box box;
    std::vector<std::string> boundaries;
    std::vector<std::string> walls;
    int gap_level = 0;  ///< halvings of the cell that put about four cells across the smallest clearance (at most 6)
    double cells_in_gap = 0;  ///< what they come to
    Clearance clearance;
};

/// Throws core::InputError: the body touches the ground, a box that does not hold it, sizes that are not positive, a
/// half model of a body that is rolled or not symmetric.
FlowDomain flow_domain(const SurfaceMesh& body, const FlowOptions& options);

/// Writes a case for OpenFOAM 1912 into a new or empty folder: its script Allrun makes the mesh (blockMesh,
/// surfaceFeatureExtract, snappyHexMesh), checks it and runs simpleFoam with k-omega SST and forces; nothing else is
/// needed but Debian's package `openfoam`. The surface is written in metres, one region a patch. Returns the files.
/// Throws also core::InputError (kind "exists") when the folder holds something.
std::vector<std::filesystem::path> write_openfoam_case(const SurfaceMesh& body, const FlowOptions& options,
                                                       const std::filesystem::path& folder);

/// The same of a body of the family by `options.mesher`.
std::vector<std::filesystem::path> write_openfoam_case(const BodyShape& shape, const FlowOptions& options,
                                                       const std::filesystem::path& folder,
                                                       core::Progress& progress = core::Progress::none());

/// A case with its mesh of blocks (constant/polyMesh, its measures in constant/mesh.json); Allrun checks the mesh and
/// runs simpleFoam: k-omega SST down to the wall, first some iterations with upwind schemes from the undisturbed stream
/// (potentialFoam of Debian's build is broken), then SIMPLEC in second order. A file `settled` in the folder ends the
/// run. Boundaries: those of the body, ground, symmetry (half), farfield.
/// Throws as make_block_mesh; core::InputError (kind "missing") for a jet of a body without a nozzle, (kind
/// "exists") when the folder holds something.
struct BlockCase {
    std::vector<std::filesystem::path> files;
    BlockMesh mesh;
};
BlockCase write_block_case(const BodyShape& shape, const FlowOptions& options, const std::filesystem::path& folder,
                           core::Progress& progress = core::Progress::none());

/// Smallest gap at which cases of such meshes were solved and held against something else, m: EVIE from 1 mm
/// (cases/evie/equal_mesh.csv), films of jets over 1 mm (docs/guide/sweep.md).
inline constexpr double smallest_tried_gap = 1e-3;
/// What a mesh under a smaller one means; empty from it up.
std::string doubt_of_gap(double gap);

/// Writes for ANSYS: each patch and each boundary of the box as STL and OBJ in metres (`surfaces/`), a Fluent journal
/// (`fluent.jou`: reads the mesh made from them, sets materials, moving ground, inlet, SST, force and moment reports,
/// runs, exports), the same for CFX (`cfx.ccl`), and a CFD-Post session (`export.cse`) that writes the CSV Underbody
/// reads.
std::vector<std::filesystem::path> write_ansys_case(const SurfaceMesh& body, const FlowOptions& options,
                                                    const std::filesystem::path& folder);

}  // namespace underbody::geometry
