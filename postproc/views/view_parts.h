// From fields to what is drawn: surfaces of the body, cuts through the volume, streamlines.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/loads/mirror_plane.h"
#include "postproc/views/views.h"

namespace underbody::postproc {

using Point = std::array<double, 3>;

/// Box of points: x0, x1, y0, y1, z0, z1; empty when x0 > x1.
using Box = std::array<double, 6>;
Box empty_box();
void widen(Box& box, const Point& point);
void widen(Box& box, const Box& other);
double diagonal(const Box& box);

/// The surfaces of the body, as `loads` chooses them: those that the patterns name, else what may be a wall
/// (`possible_walls`) without what cannot be part of the body (`walls_beside_body`: a ground, a tunnel); what fits
/// `base` always is. `half`: a half model. Throws core::InputError with the nearest name: a pattern that no surface
/// fits.
std::vector<const Zone*> surfaces_of_body(const Field& field, const std::vector<std::string>& patterns,
                                          const std::string& base, bool half);

/// The plane of a half model, by these surfaces (`place_mirror`).
PlacedMirror mirror_of(const std::string& symmetry, const std::vector<const Zone*>& body, const Field& field,
                       core::Problems& problems);

/// A zone's polygons as triangles with the array's values at their points: node values as they are, face values
/// averaged by area. Vectors give their size. Values are empty when the zone does not have the array.
DrawnSurface drawn_surface(const Zone& zone, const std::string& array);

/// The other half, put behind the first.
void mirror_into(DrawnSurface& surface, const PlacedMirror& mirror);
DrawnLine mirrored(const DrawnLine& line, const PlacedMirror& mirror);

/// All volumes that something flows through (the solid ones when there are no others) in one grid with the given arrays
/// at the points, and in the cells too where the file has them there; not-a-number in zones without them. nullptr when
/// the field has no volume with cells.
vtkSmartPointer<vtkUnstructuredGrid> volume_with(const Field& field, const std::vector<std::string>& arrays);

/// The grid cut by a plane, as triangles with values at their points.
DrawnSurface cut(vtkUnstructuredGrid& volume, const Point& through, const Point& normal, const std::string& array);

/// Height of the volume's lowest place along `up` (the ground), m; of its bounding box.
double lowest(vtkUnstructuredGrid& volume, const Point& up);

/// The cells of a two-dimensional case, as triangles with values at their points.
DrawnSurface plane_cells(vtkUnstructuredGrid& volume, const std::string& array);

/// Streamlines of `velocity` (point data) through the seeds, each one line from upstream to downstream; values are
/// speeds. No stream crosses the mirror plane of a half model.
std::vector<DrawnLine> streamlines(vtkUnstructuredGrid& volume, const std::vector<Point>& seeds, double longest,
                                   const PlacedMirror& mirror = {});

}  // namespace underbody::postproc
