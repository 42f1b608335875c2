// A surface of few faces in the place of one of millions, for while it is turned; normals for smooth shading.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <cstddef>
#include <vector>

#include "core/progress.h"

namespace underbody::postproc {

/// Side of the cubes, m, that leave about `faces` faces of all the surfaces together.
double stand_in_size(const std::vector<vtkPolyData*>& surfaces, std::size_t faces);

/// The points within a cube become one, laid where the planes of the faces around it meet and on the rim where the
/// surface has one [Lindstrom, "Out-of-core simplification of large polygonal models", SIGGRAPH 2000]; faces that lie
/// within one or two cubes are gone. Edges, corners and rims so stay within a fraction of a cube. Values on points are
/// means, of faces those of a face that stayed. Nothing of the surface is shared; normals are left out.
vtkSmartPointer<vtkPolyData> stand_in(vtkPolyData& surface, double size,
                                      core::Progress& progress = core::Progress::none());

/// The same faces, points and values, with normals on the points: the mean of the faces around each, weighed by their
/// areas. Nothing is copied.
vtkSmartPointer<vtkPolyData> with_normals(vtkPolyData& surface);

}  // namespace underbody::postproc
