// What happens to a commanded input on its way to the body: delay, dead zone, gain, first-order lag, in this order.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace underbody::dynamics {

struct Actuator {
    double delay = 0;      ///< s; of a record that lags behind what acted: negative
    double dead_zone = 0;  ///< N
    double gain = 1;
    double lag = 0;  ///< s, time constant

    /// What dead zone and gain leave of an input, N.
    [[nodiscard]] double felt(double u) const {
        return gain * std::copysign(std::max(0.0, std::abs(u) - dead_zone), u);
    }
    /// True when it has states of its own.
    [[nodiscard]] bool has_states() const { return delay != 0 || lag > 0; }
    [[nodiscard]] bool ideal() const { return !has_states() && dead_zone == 0 && gain == 1; }

    /// Recorded values at ascending `time`, held from sample to sample or linear between them, as they reach the body:
    /// out[k] is the mean from at[k - 1] to at[k], out[0] what is felt at the record's begin. Exact. Before the record
    /// its first value acts, after it the last.
    void mean_over_steps(const std::vector<double>& time, const std::vector<double>& values, bool hold,
                         const std::vector<double>& at, std::vector<double>& out) const;
};

}  // namespace underbody::dynamics
