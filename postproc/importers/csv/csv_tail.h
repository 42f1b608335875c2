// Whether the last row of a list of faces was cut.
#pragma once

#include <string_view>

class vtkPolyData;

namespace underbody::postproc {

/// Is the last face of the surface what a copy left of one that had more digits or corners? `row` is its text in the
/// file. A corner that lost its last digits is another node, and the face that was there leaves a hole whose edges
/// belong to its neighbours alone: true when the row, gone on with, fills it. A face at a rim keeps its secret.
bool last_face_is_cut(vtkPolyData& surface, std::string_view row);

}  // namespace underbody::postproc
