// Which walls of a case belong to the body whose loads are asked for, when nobody says.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/field/surface_arrays.h"
#include "postproc/loads/face_integral.h"
#include "postproc/loads/loads_result.h"

namespace underbody::postproc {

/// What a name plainly says of a zone whose kind the file does not tell ("inlet-2", "pressure_outlet", "symmetry top",
/// "Block/farField"); `unknown` for what may be a wall ("inlet duct", "hull").
ZoneKind kind_from_name(const std::string& name);

/// The kind that the file gives a zone, or else the one that its name says.
ZoneKind effective_kind(const Zone& zone);

/// Zones that may be the body when nobody names any: the walls, where the file tells which zones these are; else all
/// surfaces (and lines, the walls of plane cases) but those that are an inlet or the like by `effective_kind`, which
/// come out in `excluded_by_kind`. All, when that would leave none.
std::vector<const Zone*> possible_walls(const Field& field, std::vector<const Zone*>& excluded_by_kind);

/// What the shape of a wall tells.
struct WallShape {
    std::string name;
    std::array<double, 3> lower{}, upper{};  ///< m, bounding box
    double area = 0;                         ///< m^2
    std::array<double, 3> area_vector{};     ///< m^2, by the node order of the file
    double volume = 0;                ///< m^3, of the cones from its faces to the centre of the box, by the node order
    bool normals_into_fluid = false;  ///< the node order is known to look into the fluid
    const SurfaceArrays* surface =
        nullptr;          ///< its faces, where they may tell whether other walls lie inside; outlive the shape
    bool closed = false;  ///< it bounds a volume by itself: not so two sides of a duct, whose area vectors cancel too
};
/// `dimension` 2: strips across the plane of the case, open at their ends.
WallShape shape_of(const std::string& name, const SurfaceArrays& surface, bool normals_into_fluid, int dimension = 3);

/// Does a surface with these sums bound a volume? Its area vectors cancel, and it gives one volume along every axis
/// (along x and y, of the strips of a plane case).
bool bounds_a_volume(const FaceSums& sums, int dimension = 3);

/// Walls that cannot be part of one body with the others:
/// 1. that hang together and surround all others with the fluid inside (a tunnel, a tank, a box of far boundaries);
/// where
///    nobody knows on which side their fluid is, those in whose hollow all others lie (`surface` tells);
/// 2. that look one way (within 5 % of their area) and whose area vector is larger than anything in the box around the
///    smaller walls can balance (a ground, a floor and a lid; flat walls in one plane count as one).
/// None when that would leave no wall. An internal flow (a room, a pipe with one wall) has none either. `half`: a half
/// model.
std::vector<LeftOutZone> walls_beside_body(const std::vector<WallShape>& walls, bool half = false);

/// Names of walls that are closed bodies of their own and lie apart from each other; fewer than two: empty.
std::vector<std::string> separate_bodies(const std::vector<WallShape>& walls);

}  // namespace underbody::postproc
