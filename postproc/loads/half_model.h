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

/// What the loads advise where the surface looks cut across `axis` ("x", "y", "z"; `LoadsResult::cut_across`), in the
/// words of their options. A front with a way of its own puts that in the place of these words.
std::string half_model_advice(const std::string& axis);

}  // namespace underbody::postproc
