// On which side of a VTK file's surfaces the fluid is, where its volumes are in the file too.
#pragma once

#include "postproc/field/field.h"

namespace underbody::postproc {

/// Turns the faces of every surface whose side is not known into the one volume that has cells behind all of them, told
/// by the places of the nodes, and sets `normals_into_fluid`. Surfaces without such a volume, or between two, stay.
void settle_sides(Field& field, core::Progress& progress);

}  // namespace underbody::postproc
