// A mesh as Fluent and OpenFOAM store it: faces with the two cells beside them, and values on zones of faces and cells.
// Their importers fill it; `field_from` turns it into zones with VTK data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

/// A range of faces that follow one another, all of one zone. Ids count from 1, over all zones.
/// The right-hand normal of a face's node order points into c0; in 2-D, (-dy, dx) of n0 -> n1 does.
struct FaceBlock {
    int zone = 0;
    int kind = 0;             ///< Fluent's boundary code: 2 interior, 3 wall, ...
    std::uint64_t first = 1;  ///< id of the first face
    std::uint64_t count = 0;
    std::uint32_t per_face = 0;     ///< nodes per face; 0: they differ, see `offsets`
    Buffer<std::uint32_t> nodes;    ///< ids from 1
    Buffer<std::uint32_t> offsets;  ///< count + 1 places in `nodes`, only if per_face is 0
    Buffer<std::uint32_t> c0, c1;   ///< cell ids from 1; 0: none. c1 may be empty: none anywhere

    [[nodiscard]] std::uint32_t begin_of(std::size_t face) const {
        return per_face != 0 ? static_cast<std::uint32_t>(face) * per_face : offsets[face];
    }
    [[nodiscard]] std::uint32_t size_of(std::size_t face) const {
        return per_face != 0 ? per_face : offsets[face + 1] - offsets[face];
    }
};

struct CellBlock {
    int zone = 0;
    std::uint64_t first = 1;
    std::uint64_t count = 0;
    int element = 0;  ///< Fluent's code for all its cells: 1 triangle ... 7 polyhedron; 0: mixed or not said
    Buffer<unsigned char> elements;  ///< codes of mixed cells, may be empty
    bool parents = false;            ///< the file declares the whole zone hidden (type 32: cells split by adaption)
};

/// Sections 39/45, or the zone topology of HDF5.
struct ZoneLabel {
    int id = 0;
    std::string type;  ///< "wall", "velocity-inlet", "fluid", ...
    std::string name;
};

/// Values of one variable on ids that follow one another within one zone, as the file has them.
struct ValueBlock {
    std::string variable;   ///< "SV_P"
    std::string canonical;  ///< with `unit`: what it is, where the file says more than the name; "": by the name
    std::string unit;
    int zone = 0;  ///< 0: the file does not say, the ids do
    bool on_cells = false;
    int phase = 1;  ///< 1: the mixture, or the only one
    std::uint64_t first = 1;
    std::uint64_t count = 0;
    int components = 1;
    Buffer<double> values;  ///< count x components
};

struct IdRange {
    std::uint64_t first = 1;
    std::uint64_t last = 0;
};

/// Which faces each cell has: `uses[starts[id]]` up to `uses[starts[id + 1]]`.
struct CellFaces {
    Buffer<std::uint32_t> starts;  ///< cells + 2: id 0 has none
    Buffer<std::uint32_t> uses;    ///< 2 * place of the face among those of all blocks, + 1 for the cell in c1
};

struct FaceMesh {
    std::string file;
    int dimension = 0;
    std::uint64_t nodes = 0;           ///< how many there are, stored or not
    std::uint64_t declared_nodes = 0;  ///< of the file, when only those of the surfaces are kept
    std::uint64_t faces = 0;
    std::uint64_t cells = 0;
    Buffer<double> points;               ///< 3 per node (z = 0 in 2-D), in `length_unit`
    std::string length_unit;             ///< as the file says; "" when it does not
    bool length_unit_known = false;      ///< nobody may say otherwise
    std::vector<FaceBlock> face_blocks;  ///< only boundary zones when surfaces alone are asked for
    std::vector<CellBlock> cell_blocks;
    std::vector<ZoneLabel> labels;
    std::vector<IdRange> hidden_cells;  ///< parents of adapted cells: their children are the mesh
    std::vector<IdRange> hidden_faces;
    /// Faces of mesh interfaces (id ranges) that stand in for the parents they were cut from.
    std::vector<IdRange> interface_children;
    CellFaces cell_faces;  ///< made by `gather_cell_faces`

    [[nodiscard]] const ZoneLabel* label(int zone) const;
    /// Is the cell of that number in a solid zone?
    [[nodiscard]] bool is_solid(std::uint32_t cell) const;
    /// Are all cells beside the faces of a zone solid? The shadow of a wall between fluid and metal lies in the metal.
    [[nodiscard]] bool bounds_solids(int zone) const;
};

/// Fluent's boundary code or zone type, in words and as a kind.
std::string type_of_code(int code);
ZoneKind kind_of_type(const std::string& type);

/// True for the faces inside the mesh and those that only keep its history: no surface is made of them.
bool is_inner_code(int code);
bool is_hidden_code(int code);

/// Faces that the solver made where two meshes meet lie on top of those that the cells were made with: no cell gets
/// them.
void hide_generated_faces(FaceMesh& mesh);

/// Finds the faces of every cell. Nodes need not be there yet. c0 and c1 of the faces inside the mesh are given up:
/// nobody needs them after that. Throws InputError where ranges or cell ids are not consistent.
void gather_cell_faces(FaceMesh& mesh, core::Progress& progress);

/// Checks that ranges and the cells beside faces are consistent, of all zones; throws InputError that names zone and
/// face.
void check_cells_beside(const FaceMesh& mesh, core::Progress& progress);

/// What an importer understood before it failed: ", zones inlet, hull, ..."; "" while none is known.
std::string listed_zones(const FaceMesh& mesh);

/// Checks that ranges, node ids and cell ids are consistent; throws InputError that names zone and face.
void check_mesh(const FaceMesh& mesh, bool surfaces_only, core::Progress& progress);

/// Zones with VTK data: one volume per cell zone, one surface per boundary zone (normals into the fluid, also where the
/// file has them otherwise). Values become canonical: SV_WALL_SHEAR (the wall's force on the fluid) becomes
/// `wall_shear`, the traction on the body in Pa; components become vectors. The volume by the divergence theorem goes
/// to `field.metadata`, inverted or open cells to `field.problems`. The mesh's memory is given up on the way.
Field field_from(FaceMesh&& mesh, std::vector<ValueBlock>&& values, const ReadOptions& options,
                 core::Progress& progress);

}  // namespace underbody::postproc
