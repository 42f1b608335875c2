// Faces that stand twice in a case: an export may hold a wall by its name and once more within a group of walls.
#pragma once

#include <cstddef>
#include <vector>

#include "postproc/loads/loads_parts.h"

namespace underbody::postproc {

/// A zone of whose faces some or all lie on those of other zones.
struct DoubledZone {
    std::size_t zone = 0;             ///< index
    std::size_t faces = 0;            ///< of this zone, that stand in others too
    std::vector<std::size_t> others;  ///< indices
    bool whole = false;               ///< all its faces do: without it nothing is missing
};

/// Zones whose faces stand in others too: same corners to a millionth of the size of all, the same way
/// round, with the same pressure (the two sides of a thin wall lie on each other too, and are no doubles). Whole ones
/// are looked for from the last, each left away before the next, so that what is left has its faces once.
std::vector<DoubledZone> doubled_zones(const std::vector<SummedZone>& zones);

}  // namespace underbody::postproc
