// Points by their place, whatever their number in the file.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace underbody::postproc {

/// Numbers places so that points nearer than the tolerance (m) get one number.
class Places {
public:
    explicit Places(double tolerance) : cell_(2 * tolerance), tolerance_(tolerance) {}

    /// The number of the place `x`, a new one where nothing lies yet.
    std::int64_t number(const double* x);
    /// Whether something lies there already.
    [[nodiscard]] bool has(const double* x) const { return find(x) >= 0; }

private:
    [[nodiscard]] std::int64_t find(const double* x) const;

    double cell_;
    double tolerance_;
    std::vector<std::array<double, 3>> points_;
    std::unordered_map<std::uint64_t, std::vector<std::int64_t>> cells_;
};

}  // namespace underbody::postproc
