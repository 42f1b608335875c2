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

/// The columns of a list of probes.
template <typename Probes>
std::vector<const DesignMatrix*> columns_of(const Probes& probes) {
    std::vector<const DesignMatrix*> columns;
    for (const auto& probe : probes) {
        columns.push_back(&probe.columns);
    }
    return columns;
}

}  // namespace underbody::discovery
