// Quadrilaterals over half a disc: the base of the body (with its protrusion and nozzle) and the top of the hull.
// Internal to the block mesher.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/blocks/body_section.h"
#include "geometry/blocks/grading.h"

namespace underbody::geometry {

/// Points in the scaled plane with y >= 0 (exactly 0 on the middle line). Quads turn counter-clockwise.
struct PlaneGrid {
    std::vector<Point2> points;
    std::vector<std::array<std::int32_t, 4>> quads;
    std::vector<std::int32_t> rim;         ///< from the nose end (y = 0) over port to the tail end
    std::vector<char> in_nozzle;           ///< one for each quad
    std::vector<std::int32_t> nozzle_rim;  ///< in the same sense; empty without a nozzle

    std::int32_t add(const Point2& p);
};

/// How many cells lie where.
struct DiscCounts {
    int across = 14;  ///< of the core, from the middle line to port: also the rim's cells in front of the front corner,
                      ///< and aft of the back corner
    int rings = 13;   ///< between core and rim
    double rim_size = 0;   ///< size of a cell at the rim
    double core_size = 0;  ///< size of a cell of the core
};

/// Azimuths of the rim's points: what all blocks of the mesh share.
struct RimAzimuths {
    std::vector<double> azimuth;  ///< rising, 0 .. pi
    int along = 28;               ///< cells between the corners of the core; across + along + across in all
    /// X of the core's lines where these run straight across the base (a protrusion or a nozzle); else empty.
    std::vector<double> lines;
    int nozzle_line = -1;  ///< of `lines`, counted from the front: through the middle of the nozzle
    int nozzle_cells = 0;  ///< half the cells of the square that is cut out around the nozzle
};

/// Throws core::InputError (kind "mesh") where protrusion or nozzle leave no room for the core's lines: says which.
RimAzimuths rim_azimuths(const BodySection& section, const DiscCounts& counts);

/// Half a unit disc, for the top of the hull: core of near squares, rings with equal steps.
PlaneGrid disc_grid(const RimAzimuths& rim, const DiscCounts& counts, int rings);
/// The base.
PlaneGrid base_grid(const BodySection& section, const RimAzimuths& rim, const DiscCounts& counts);

}  // namespace underbody::geometry
