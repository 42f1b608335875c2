// Which variables a quantity depends on: Sobol's indices and curves of one variable at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace underbody::tables {

/// Share of the variance over the unit cube, with the ends of a 95 % interval (bootstrap over the points).
struct SobolIndex {
    double value = 0;
    double lower = 0;
    double upper = 0;
};

struct SobolIndices {
    double mean = 0;
    double variance = 0;
    std::vector<SobolIndex> first;  ///< of each variable alone
    std::vector<SobolIndex> total;  ///< of each with all its interactions
};

/// Of a function on the unit cube, by Saltelli's plan with the estimators of Saltelli et al. 2010 (first) and Jansen
/// 1999 (total): points * (axes + 2) evaluations. A constant function has indices of zero.
SobolIndices sobol_indices(const std::function<double(std::span<const double>)>& f, std::size_t axes,
                           std::size_t points, std::uint64_t seed);

}  // namespace underbody::tables
