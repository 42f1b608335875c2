// Cells and boundaries of a structured zone.
#pragma once

#include <string>

#include "postproc/importers/cgns/cgns_boundary_values.h"
#include "postproc/importers/cgns/cgns_file.h"

namespace underbody::postproc {

/// The cells of a block, or of a plane one.
ElementPart cells_of_block(const CgnsZone& zone, int dimension, core::Progress& progress);

/// What a condition names: quadrilaterals of a block, lines of a plane one.
struct BlockFaces {
    CgnsSurface surface;
    std::string told;  ///< what to say of the condition: that it has none, and why; "" where all is well
};

/// Throws InputError (through `file`) for a condition that lies outside the zone.
BlockFaces faces_of_block(const CgnsFile& file, const CgnsZone& zone, const CgnsCondition& condition);

}  // namespace underbody::postproc
