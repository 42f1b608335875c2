// Where a measured motion begins: one estimate for filters, predictions and discovery.
#pragma once

#include <cstddef>
#include <vector>

namespace underbody::dynamics {

struct StartState {
    double gap = 0, velocity = 0;  ///< m and m/s, at the first time
    std::size_t readings = 0;
    double range = 0;  ///< m, highest less lowest reading
    double gap_factor = 0,
           slope_factor = 0;  ///< variances of gap and velocity over that of one reading; slope in 1/s^2
    /// False with fewer than three readings, or all at one time.
    [[nodiscard]] bool found() const { return readings >= 3 && slope_factor > 0; }
};

/// Least-squares line through the finite readings within half a second from sample `first`, five at least, none after
/// sample `last`.
StartState start_state(const std::vector<double>& time, const std::vector<double>& gap, std::size_t first,
                       std::size_t last);

}  // namespace underbody::dynamics
