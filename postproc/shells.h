// The connected parts of a surface.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "postproc/surface_arrays.h"

namespace underbody::postproc {

/// Which connected part each face belongs to, numbered from 0 in the order of the faces. Faces are connected that have a
/// node in common, by number or by place (to 1e-6 of the size of the surface); empty: all of them are.
std::vector<std::uint32_t> connected_parts(const SurfaceArrays& surface);

/// A surface of some faces, with the points that these use and the values of both. `arrays` are those of `surface`.
vtkSmartPointer<vtkPolyData> surface_of_faces(vtkPolyData& surface, const SurfaceArrays& arrays, std::span<const std::size_t> faces);

}  // namespace underbody::postproc
