// What a field knows beside its numbers, within the VTK files that we write: so that they give the same loads of the
// same body when they are read again.
#pragma once

#include <vtkDataObject.h>

#include <optional>
#include <vector>

#include "postproc/field/field.h"

namespace underbody::postproc {

/// One zone of a data set. `zone` has everything but its data.
struct DescribedZone {
    Zone zone;
    int mark = 0;          ///< its number in the cell array `zone`; the only zone of a data set needs none
    bool surface = false;  ///< it was a surface; else a volume
    long long points = 0;  ///< one zone after the other
    long long cells = 0;
};

struct Description {
    Field field;  ///< without zones
    std::vector<DescribedZone> zones;
};

/// The name of the field data array: JSON, as one string, or as its bytes.
constexpr const char* description_name = "underbody";
/// The cell array that tells zones apart.
constexpr const char* mark_name = "zone";

/// Puts the description into the field data. The zones are those whose data `data` holds, in their order. `as_bytes`:
/// as an array of numbers, for programs that know no other (meshio).
void describe_in(vtkDataObject& data, const Field& field, const std::vector<DescribedZone>& zones, bool as_bytes);

/// What `describe_in` wrote; nothing when there is none or it is damaged.
std::optional<Description> description_in(vtkDataObject& data);

}  // namespace underbody::postproc
