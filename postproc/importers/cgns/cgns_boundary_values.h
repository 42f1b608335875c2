// Values that boundary conditions hold for themselves (BCDataSet), on the surfaces that they name.
#pragma once

#include <optional>
#include <vector>

#include "postproc/importers/cgns/cgns_file.h"

namespace underbody::postproc {

/// A surface of a zone, its nodes numbered as the zone's.
struct CgnsSurface {
    ElementPart part;
    const CgnsCondition* condition = nullptr;  ///< that it belongs to
    std::vector<std::int64_t> entries;  ///< by face: which of the faces that the condition names, from 0; else empty
};

/// One value for all faces, one each of the faces or the vertices that the condition of the surface names, or that the
/// values name: on the faces, or on `nodes` (of the zone, from 0). Nothing where they are as many as none of these.
std::optional<PartValues> values_on(const CgnsFile& file, const CgnsSurface& surface,
                                    const std::vector<std::int64_t>& nodes, const CgnsZone& zone,
                                    const CgnsBoundaryValues& stated);

}  // namespace underbody::postproc
