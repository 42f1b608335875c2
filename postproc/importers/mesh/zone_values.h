// Values on ids of faces and cells become the arrays of zones. Only for .cpp files: it brings VTK's headers.
#pragma once

#include <vtkCellData.h>

#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/importers/mesh/face_cells.h"
#include "postproc/importers/mesh/face_mesh.h"

namespace underbody::postproc {

/// Adds an array to a zone and to the data of its cells or faces. The memory becomes VTK's.
void add_cell_array(Zone& zone, vtkCellData& data, ArrayInfo info, Buffer<double>&& values);

/// The value blocks of a mesh, each given to the zones whose ids it has.
class ZoneValues {
public:
    /// All must outlive this; blocks that are one zone's alone are given up to it. `dimension`: 2 for a plane case.
    ZoneValues(std::vector<ValueBlock>& values, const std::string& file, int dimension, const ReadOptions& options,
               core::Progress& progress)
        : values_(values), place_{file, {}, {}, {}}, dimension_(dimension), options_(options), progress_(progress) {}

    /// Adds what is wanted on the zone's cells, or on its faces (`ids`), under canonical names; components become
    /// vectors (array_names.h). With the faces' `areas` the force of a wall on the fluid (N) becomes the traction on
    /// the body (Pa). Values that are missing on some ids are not-a-number, and told.
    void add_to(Zone& zone, vtkCellData& data, const Ids& ids, bool on_cells, const std::vector<double>& areas,
                core::Problems& problems);

private:
    struct Key;
    struct Span;
    struct Gathered;
    [[nodiscard]] static Span span_of(const Ids& ids);
    [[nodiscard]] std::vector<Key> keys_of(const Zone& zone, bool on_cells) const;
    void add_phase(Zone& zone, vtkCellData& data, std::vector<Gathered>&& arrays, const std::string& phase,
                   core::Problems& problems) const;
    [[nodiscard]] Gathered gather(const Key& key, int zone, bool on_cells, const Ids& ids, const Span& span);

    std::vector<ValueBlock>& values_;
    core::Place place_;
    int dimension_;
    const ReadOptions& options_;
    core::Progress& progress_;
};

}  // namespace underbody::postproc
