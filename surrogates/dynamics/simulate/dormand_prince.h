// The explicit pair of Dormand and Prince (1980), orders 5 and 4, for a few states, in registers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/no_limit.h"

namespace underbody::dynamics {

/// rate(t, y, dydt). Error per step below 1 in units of scale[i], which is an absolute error per state.
template <std::size_t N, class Rate>
class DormandPrince {
public:
    using State = std::array<double, N>;

    DormandPrince(const Rate& rate, double t, const State& y, const State& scale, double first_step)
        : rate_(rate), t_(t), y_(y), scale_(scale), step_(first_step) {
        rate_(t_, y_.data(), k1_.data());
    }

    [[nodiscard]] double t() const { return t_; }
    [[nodiscard]] const State& y() const { return y_; }
    [[nodiscard]] const State& rate() const { return k1_; }
    [[nodiscard]] double before_t() const { return t_before_; }
    [[nodiscard]] const State& before() const { return before_; }
    [[nodiscard]] long tries() const { return tries_; }

    /// One accepted step, not beyond t_end. False when the step became too small or the state not finite.
    bool step(double t_end) {
        for (int attempt = 0; attempt < 60; ++attempt) {
            ++tries_;
            double h = step_;
            const bool last = t_ + h >= t_end;
            if (last) {
                h = t_end - t_;
            }
            State y2, k2, k3, k4, k5, k6, k7, next;
            const auto at = [&](auto&& sum) {
                for (std::size_t i = 0; i < N; ++i) {
                    y2[i] = y_[i] + h * sum(i);
                }
            };
            at([&](std::size_t i) { return c2 * k1_[i]; });
            rate_(t_ + c2 * h, y2.data(), k2.data());
            at([&](std::size_t i) { return 3.0 / 40 * k1_[i] + 9.0 / 40 * k2[i]; });
            rate_(t_ + c3 * h, y2.data(), k3.data());
            at([&](std::size_t i) { return 44.0 / 45 * k1_[i] - 56.0 / 15 * k2[i] + 32.0 / 9 * k3[i]; });
            rate_(t_ + c4 * h, y2.data(), k4.data());
            at([&](std::size_t i) {
                return 19372.0 / 6561 * k1_[i] - 25360.0 / 2187 * k2[i] + 64448.0 / 6561 * k3[i] - 212.0 / 729 * k4[i];
            });
            rate_(t_ + 8.0 / 9 * h, y2.data(), k5.data());
            at([&](std::size_t i) {
                return 9017.0 / 3168 * k1_[i] - 355.0 / 33 * k2[i] + 46732.0 / 5247 * k3[i] + 49.0 / 176 * k4[i] -
                       5103.0 / 18656 * k5[i];
            });
            rate_(t_ + h, y2.data(), k6.data());
            for (std::size_t i = 0; i < N; ++i) {
                next[i] = y_[i] + h * (35.0 / 384 * k1_[i] + 500.0 / 1113 * k3[i] + 125.0 / 192 * k4[i] -
                                       2187.0 / 6784 * k5[i] + 11.0 / 84 * k6[i]);
            }
            rate_(t_ + h, next.data(), k7.data());
            double error = 0;
            for (std::size_t i = 0; i < N; ++i) {
                const double e = h * (71.0 / 57600 * k1_[i] - 71.0 / 16695 * k3[i] + 71.0 / 1920 * k4[i] -
                                      17253.0 / 339200 * k5[i] + 22.0 / 525 * k6[i] - 1.0 / 40 * k7[i]);
                error = std::max(error, std::abs(e) / scale_[i]);
            }
            if (!(error < core::no_limit)) {
                step_ = h * most_shrink;
                if (step_ < least_step) {
                    return false;
                }
                continue;
            }
            const double factor = error > 1e-10 ? safety * std::exp2(-0.2 * std::log2(error)) : 5.0;
            if (error <= 1) {
                before_ = y_;
                before_rate_ = k1_;
                t_before_ = t_;
                y_ = next;
                k1_ = k7;
                t_ = last ? t_end : t_ + h;
                step_ = h * std::clamp(factor, shrink, 5.0);
                return true;
            }
            step_ = h * std::clamp(factor, most_shrink, safety);
        }
        return false;
    }

    /// Between the last two points: cubic through values and rates.
    [[nodiscard]] double between(double part, std::size_t i) const {
        const double h = t_ - t_before_;
        const double q = 1 - part;
        return before_[i] * q * q * (1 + 2 * part) + y_[i] * part * part * (3 - 2 * part) +
               h * part * q * (before_rate_[i] * q - k1_[i] * part);
    }

private:
    static constexpr double c2 = 0.2, c3 = 0.3, c4 = 0.8;  // of the step, where the rate is asked
    static constexpr double safety = 0.9, shrink = 0.2, most_shrink = 0.1, least_step = 1e-14;  // of steps; s
    const Rate& rate_;
    double t_;
    double t_before_ = 0;
    State y_, before_{}, before_rate_{}, k1_{}, scale_;
    double step_;
    long tries_ = 0;
};

}  // namespace underbody::dynamics
