// How surfaces hang together along their rims.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "postproc/field/surface_arrays.h"

namespace underbody::postproc {

/// An edge with one face, in the way that its face runs along it.
struct RimEdge {
    Index a, b;
};

/// Surfaces that were found to belong together, with the sign of each relative to the root of its group.
class SignedGroups {
public:
    explicit SignedGroups(std::size_t count);

    [[nodiscard]] std::pair<std::size_t, double> root(std::size_t i) const;
    void join(std::size_t i, std::size_t j, double relative);

private:
    std::vector<std::size_t> parent_;
    std::vector<double> sign_;
};

/// Joins surfaces that share edges by place (within 1e-6 of `size`, m): faces on both sides of an edge run along it
/// opposite ways when they look to the same side. `unmatched` gets the edges of each surface that no other has.
SignedGroups joined_along_rims(const std::vector<const SurfaceArrays*>& surfaces, double size,
                               std::vector<std::vector<RimEdge>>* unmatched = nullptr);

}  // namespace underbody::postproc
