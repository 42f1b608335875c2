// Boundaries of an unstructured zone: which faces belong to which condition.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "postproc/importers/cgns/cgns_boundary_values.h"
#include "postproc/importers/cgns/cgns_file.h"

namespace underbody::postproc {

/// By section and element: how many cells have a polygon; empty for a section without polygons, or without cells of
/// these.
using CellsOfPolygons = std::vector<std::vector<unsigned char>>;

struct CgnsSurfaces {
    std::vector<CgnsSurface> parts;  ///< no points yet; some may be empty
    std::vector<std::pair<const CgnsCondition*, std::string>>
        told;  ///< condition -> what to say of it: what has no faces
};

/// A surface for each condition with the faces that it names: by their numbers, else by the section of its name, else
/// by vertices, which stand for the faces that have no others. Then the faces that no condition names, by section.
/// `sections` in order of their numbers; faces have one dimension less than `dimension`.
CgnsSurfaces surfaces_of(const std::vector<CgnsSection>& sections, const std::vector<CgnsCondition>& conditions,
                         const CellsOfPolygons& cells_of_polygons, int dimension);

}  // namespace underbody::postproc
