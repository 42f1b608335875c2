// A mesh of hexahedra as faces with owner and neighbour, as OpenFOAM keeps it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh/vec3.h"

namespace underbody::geometry {

using Quad = std::array<std::int32_t, 4>;
/// Corners 0 1 2 3 and, above them, 4 5 6 7: 0 1 2 3 turn clockwise seen from outside of the cell, that is their normal
/// points into it.
using Hexahedron = std::array<std::int32_t, 8>;

/// Points in metres. Cells are all hexahedra; a boundary face that no one has named stays in no patch.
struct HexMesh {
    std::vector<Vec3> points;
    std::vector<Hexahedron> cells;
    struct NamedFace {
        Quad corners;
        std::int32_t patch;
    };
    std::vector<std::string> patch_names;
    std::vector<NamedFace> named;
    std::int32_t sheet = -1;  ///< patch whose faces lie between two cells: a wall without thickness, with two sides
};

/// Faces in OpenFOAM's order: inner ones by owner, then neighbour (upper triangular), then patch by patch. A face's
/// normal points from its owner to its neighbour, or out of the domain.
struct PolyMesh {
    struct Patch {
        std::string name;
        std::size_t first = 0;
        std::size_t count = 0;
    };
    std::vector<Vec3> points;
    std::vector<Quad> faces;
    std::vector<std::int32_t> owner;
    std::vector<std::int32_t> neighbour;  ///< of the inner faces
    std::vector<Patch> patches;
    std::size_t cells = 0;

    [[nodiscard]] std::size_t inner_faces() const { return neighbour.size(); }
    /// Throws core::InputError with the nearest name.
    [[nodiscard]] const Patch& patch(const std::string& name) const;
};

/// Throws std::logic_error when a face belongs to three cells, or a boundary face to no patch.
PolyMesh faces_of(const HexMesh& mesh);

/// constant/polyMesh of an OpenFOAM case (points, faces, owner, neighbour, boundary; ascii). Patches are walls but for
/// `symmetry`, `farfield` and those of `openings`.
std::vector<std::filesystem::path> write_poly_mesh(const PolyMesh& mesh, const std::filesystem::path& folder,
                                                   const std::vector<std::string>& openings = {});

}  // namespace underbody::geometry
