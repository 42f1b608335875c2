// Where a body lies, and the point that its moments are taken about when nobody says.
#pragma once

#include <string>
#include <vector>

#include "postproc/field/vector_math.h"
#include "postproc/loads/loads_parts.h"
#include "postproc/loads/mirror_plane.h"

namespace underbody::postproc {

/// Bounding box, m, file axes; lower above upper when there is nothing.
struct Extent {
    Vector lower, upper;
    Extent();
    void widen(const SummedZone& part);
};
Extent extent_of(const std::vector<SummedZone>& parts);

/// Mean of a face's corners, m.
Vector centre_of(const SummedZone& part, std::size_t face);

struct MomentReference {
    Vector point{};    ///< m, file axes
    std::string from;  ///< for people
    bool base_found = true;
};

/// Mid-length and mid-width of the zones that fit `base`, in the plane of the flat base (most of its area lies in it; a
/// protrusion does not move it). Without such a zone: the lowest point under the centre of the bounding box.
MomentReference reference_from_base(const std::vector<SummedZone>& parts, const std::string& base, const Vector& up,
                                    const PlacedMirror& mirror);

}  // namespace underbody::postproc
