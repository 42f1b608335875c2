// Zones out of lists of elements with nodes: what EnSight, CGNS and Tecplot have in common.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

/// The elements of one part of a file. Nodes count from 0 within `points`.
struct ElementPart {
    std::string name;
    int id = 0;
    ZoneKind kind = ZoneKind::unknown;
    std::string original_kind;
    Buffer<double> points;              ///< 3 per node
    std::vector<unsigned char> types;   ///< VTK cell types
    std::vector<std::int64_t> offsets;  ///< one more than elements
    std::vector<std::int64_t> nodes;
    /// Faces of the polyhedra, in the order of the elements: number of faces, then per face its number of nodes and
    /// these.
    std::vector<std::int64_t> polyhedra;

    ElementPart() { offsets.push_back(0); }
    /// Dimension of the highest element: 0 points ... 3 cells.
    [[nodiscard]] int dimension() const;
    [[nodiscard]] std::size_t elements() const { return types.size(); }
    void add(unsigned char type, const std::int64_t* first, std::size_t count) {
        types.push_back(type);
        nodes.insert(nodes.end(), first, first + count);
        offsets.push_back(static_cast<std::int64_t>(nodes.size()));
    }
};

/// Values on the nodes or the elements of a part.
struct PartValues {
    std::string variable;  ///< the file's name
    bool on_nodes = true;
    int components = 1;
    Buffer<double> values;
};

/// Turns all linear cells of a kind if most of them have negative volumes (writers differ in the order of wedges);
/// says how many.
std::int64_t turn_inverted_cells(ElementPart& part);

/// A volume zone if the part has cells of `volume_dimension` (3, or 2 in a plane case), else a surface zone.
/// Values become arrays with canonical names (array_names.h): `options.units` are applied, with `options.arrays` only
/// those asked for are kept, components are joined. Cells that no volume or surface can hold are left out and told.
Zone zone_from(ElementPart&& part, std::vector<PartValues>&& values, int volume_dimension, const ReadOptions& options,
               const std::string& file, core::Problems& problems);

/// Scales points by `options.length_unit`; without one metres are taken, and a note says so.
void scale_parts(std::vector<ElementPart>& parts, const ReadOptions& options, Field& field);

}  // namespace underbody::postproc
