// Plans of points in the unit cube.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace underbody::tables {

/// [point][axis], each in [0, 1).
using Plan = std::vector<std::vector<double>>;

/// Points `first` .. first + count - 1 of Sobol's sequence (directions of Joe and Kuo 2008, by Boost), with a random
/// digital shift by `seed`: a plan that is continued later fills the gaps of what was there.
Plan sobol_plan(std::size_t count, std::size_t axes, std::uint64_t seed, std::size_t first = 0);

/// Latin hypercube: one point in each of `count` slices of every axis; of fifty, the one with the largest smallest
/// distance (McKay, Beckman and Conover 1979; Johnson, Moore and Ylvisaker 1990).
Plan latin_hypercube(std::size_t count, std::size_t axes, std::uint64_t seed);

/// Smallest distance of two points.
double smallest_distance(const Plan& plan);

}  // namespace underbody::tables
