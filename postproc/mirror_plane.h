// The plane of a half model.
#pragma once

#include <optional>
#include <string>

namespace underbody::postproc {

struct MirrorPlane {
    int axis = -1;             ///< 0, 1, 2: its normal; -1: the model is whole
    std::optional<double> at;  ///< m, along the axis, when it was stated

    [[nodiscard]] bool is_half() const { return axis >= 0; }
};

/// "y", "y=0.1", "z=-5 mm"; "" and "none": a whole model. Throws core::UsageError for anything else.
MirrorPlane mirror_plane_from(const std::string& text);

}  // namespace underbody::postproc
