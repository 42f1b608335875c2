// Whether a field looks like half of a body, for people who are asked.
#pragma once

#include <optional>
#include <string>

namespace underbody::postproc {

struct Field;

struct LikelyHalf {
    std::string symmetry;  ///< as `loads` takes it: "y", "y=0.1"
    std::string zone;      ///< the symmetry boundary that says so
};

/// The plane of the one flat boundary of the kind symmetry that is normal to an axis and has all that may be a wall on
/// one side of it. Nothing for two-dimensional cases, and where there are several such planes (a channel).
std::optional<LikelyHalf> likely_half(const Field& field);

}  // namespace underbody::postproc
