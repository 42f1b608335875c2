// Which side of each zone the fluid is on, where the file does not say.
#pragma once

#include <string>
#include <vector>

#include "core/error.h"
#include "postproc/loads/face_integral.h"

namespace underbody::postproc {

/// One zone whose faces agree among themselves.
struct FacingZone {
    std::string name;
    const SurfaceArrays* surface = nullptr;
    FaceSums sums;       ///< as in the file, positions relative to one origin for all zones
    bool known = false;  ///< the importer vouches for its normals
};

struct Facing {
    std::vector<double> signs;  ///< +1: as in the file, -1: turned
    std::string how;            ///< for people
    bool guessed = false;       ///< the side of some zone cannot be told from these zones alone
    core::Problems problems;
};

/// Chooses the signs so that the zones together bound a body with the fluid outside:
/// 1. known zones stay; 2. the signs that close the surface (axis `symmetry`, 0..2 or -1, need not close);
/// 3. for open surfaces, zones that share edges by place run along them opposite ways;
/// 4. then the enclosed volume is positive (open edges are closed toward their own centre, which is exact for half
/// models). A duct's walls are open although their area vectors cancel: taken as a body's, with a warning. `origin` is
/// the one of the sums; `dimension` 2: strips across a plane case.
Facing settle_facing(const std::vector<FacingZone>& zones, int symmetry, const std::array<double, 3>& origin,
                     int dimension = 3);

}  // namespace underbody::postproc
