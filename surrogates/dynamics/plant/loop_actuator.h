// The command of a closed loop on its way through an actuator with delay, dead zone, gain and lag.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

/// Integrators tell it every accepted step; between steps the past motion is the cubic through states and rates. No
/// step may be longer than the delay. Before the start the command is that of the start. N: states that the command
/// depends on.
template <std::size_t N>
class LoopActuator {
public:
    using State = std::array<double, N>;
    /// What the controller and whoever else commands ask for in a state at a time, N.
    using Command = std::function<double(double t, const double* y)>;

    LoopActuator(const HeaveTerms& terms, Command command) : terms_(&terms), command_(std::move(command)) {}

    [[nodiscard]] bool delayed() const { return terms_->actuator.delay > 0; }
    [[nodiscard]] bool lagged() const { return terms_->actuator.lag > 0; }
    /// The longest step that looks back on known motion only, s.
    [[nodiscard]] double max_step() const { return terms_->actuator.delay; }

    void start(double t, const double* y, const double* rate) {
        past_.clear();
        accept(t, y, rate);
    }
    /// An accepted step (or the state after an impact, at the same time) that ends here.
    void accept(double t, const double* y, const double* rate) {
        if (delayed() || past_.empty()) {
            Knot knot{t, {}, {}};
            std::copy_n(y, N, knot.state.begin());
            std::copy_n(rate, N, knot.rate.begin());
            past_.push_back(knot);
        }
    }
    /// What drives the lag, or reaches the body where there is none, N.
    [[nodiscard]] double driven(double t, const double* y) const {
        if (!delayed()) {
            return terms_->actuator.felt(command_(t, y));
        }
        const double then = t - terms_->actuator.delay;
        const State state = at(then);
        return terms_->actuator.felt(command_(std::max(then, past_.front().t), state.data()));
    }

private:
    struct Knot {
        double t;
        State state, rate;
    };
    [[nodiscard]] State at(double t) const {
        if (t <= past_.front().t) {
            return past_.front().state;
        }
        if (t >= past_.back().t) {
            return past_.back().state;
        }
        const auto after =
            std::upper_bound(past_.begin(), past_.end(), t, [](double l, const Knot& r) { return l < r.t; });
        const Knot &a = *(after - 1), &b = *after;
        const double h = b.t - a.t, p = (t - a.t) / h, q = 1 - p;
        State state;
        for (std::size_t i = 0; i < N; ++i) {
            state[i] = a.state[i] * q * q * (1 + 2 * p) + b.state[i] * p * p * (3 - 2 * p) +
                       h * p * q * (a.rate[i] * q - b.rate[i] * p);
        }
        return state;
    }
    const HeaveTerms* terms_;
    Command command_;
    std::vector<Knot> past_;
};

}  // namespace underbody::dynamics
