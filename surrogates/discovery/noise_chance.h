// How likely noise alone surprises as much as what was found.
#pragma once

#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/flexible.h"

namespace underbody::discovery {

/// Chance that noise alone would surprise as much as `observed` (-log10 of a nominal chance) in any of the probes, each
/// orthonormal columns of answers: `noise_like` innovations reordered in blocks with random signs, so that colour that
/// is left survives. At least 1 in 200 draws, less beyond all of them.
double chance_among(const std::vector<const DesignMatrix*>& probes, const std::vector<double>& noise_like,
                    double observed, std::size_t block, std::uint64_t seed, core::Progress& progress);

}  // namespace underbody::discovery
