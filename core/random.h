// Random numbers with stated seeds: two runs give the same bytes on every machine.
#pragma once

#include <cstddef>
#include <cstdint>

namespace underbody::core {

/// xoshiro256** (Blackman and Vigna 2018), seeded by SplitMix64. Its own distributions, because those of the
/// standard library are not the same everywhere.
class Random {
public:
    explicit Random(std::uint64_t seed);
    /// An independent stream for part `index` of a computation, so that results do not depend on the order of work.
    Random(std::uint64_t seed, std::uint64_t index);

    std::uint64_t bits();
    /// Uniform on [0, 1).
    double uniform();
    double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }
    /// Standard normal (polar method of Marsaglia).
    double normal();
    double normal(double mean, double sigma) { return mean + sigma * normal(); }
    /// Uniform on 0 .. count - 1.
    std::size_t below(std::size_t count);

private:
    std::uint64_t state_[4];
    double spare_ = 0;
    bool has_spare_ = false;
};

}  // namespace underbody::core
