// A step of a coupled motion through time: the classical Runge-Kutta method where the motion is slow against the step,
// an L-stable Rosenbrock method with error control where the film or the friction of a contact is fast against it.
#pragma once

#include <functional>

#include "surrogates/dynamics/simulate/heave_step.h"
#include "surrogates/dynamics/simulate/measured_motion.h"

namespace underbody::dynamics {

/// rate(share of the step, state, its rate)
using MotionRate = std::function<void(double, const MotionState&, MotionState&)>;

/// Over `h`, of the first `states`, by the Rosenbrock method. NaN in the state says that no step was small enough.
void stiff_step(double h, std::size_t states, MotionState& y, const MotionRate& rate);

/// Over `h` of a motion whose states `gap` and `rise` are the gap and how fast it grows.
template <typename Rate>
void motion_step(double h, const MotionShape& shape, const HeaveTerms& terms, std::size_t gap, std::size_t rise,
                 MotionState& y, const Rate& rate) {
    constexpr double slow = 0.4;  // as of the heave motion: above it the error of the classical method is not small
    const auto film_is_fast = [&] {
        MotionState d{};
        rate(0.0, y, d);
        return h * film_rate(terms, y[gap], y[rise], d[rise], h) > slow;
    };
    if (terms.film != 0 && film_is_fast()) {
        stiff_step(h, shape.states.size(), y, rate);
    } else {
        runge_kutta(h, y, rate);
    }
}

}  // namespace underbody::dynamics
