// The plane of a half model.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "postproc/field/vector_math.h"

namespace underbody::postproc {

class SurfaceArrays;

struct MirrorPlane {
    int axis = -1;             ///< 0, 1, 2: its normal; -1: the model is whole
    std::optional<double> at;  ///< m, along the axis, when it was stated

    [[nodiscard]] bool is_half() const { return axis >= 0; }
};

/// "y", "y=0.1", "z=-5 mm"; "" and "none": a whole model. Throws core::UsageError for anything else.
MirrorPlane mirror_plane_from(const std::string& text);

/// True where a plane across that axis of the file lies across the vehicle's up or forward axis.
bool mirrors_motion(std::size_t axis, const Vector& forward, const Vector& up);

/// Throws core::UsageError for such a plane: every lift, or every drag, would be zero.
void check_mirror_lies_along(const MirrorPlane& plane, const Vector& forward, const Vector& up);

/// A half model's plane in its place; axis -1: none.
struct PlacedMirror {
    int axis = -1;
    double at = 0;  ///< m, along the axis
};

/// Where the plane of a half model lies, by the surfaces of its body (file axes, m): where it was stated, else at the
/// end of the body that is open, else at the end nearer to 0. A plane that is not at 0 and that nobody stated comes out
/// as a warning. Throws core::InputError: a body on both sides of the plane, a body that is open elsewhere than at the
/// stated plane (closed bodies may lie off it: they are two, side by side).
PlacedMirror place_mirror(const MirrorPlane& plane, const std::vector<const SurfaceArrays*>& body,
                          const core::Place& place, core::Problems& problems);

}  // namespace underbody::postproc
