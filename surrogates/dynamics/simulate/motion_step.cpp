#include "surrogates/dynamics/simulate/motion_step.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace underbody::dynamics {

namespace {

constexpr auto most = static_cast<int>(most_states);
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;

/// Rodas3 (Sandu, Verwer, Blom, Spee, Carmichael and Potra 1997): order 3, L-stable, embedded order 2.
class Rodas3 {
public:
    Rodas3(double whole, std::size_t states, const MotionRate& rate)
        : whole_(whole), states_(static_cast<Eigen::Index>(states)), rate_(rate) {}

    [[nodiscard]] Column rate(double t, const Column& y) const {
        MotionState state{}, out{};
        std::copy(y.data(), y.data() + y.size(), state.begin());
        rate_(t / whole_, state, out);
        return Eigen::Map<const Column>(out.data(), states_);
    }

    /// From `t` over `dt`; `error` in tolerances.
    [[nodiscard]] Column step(const Column& y, double t, double dt, double& error) const {
        constexpr double absolute = 1e-8, relative = 1e-5;  // far below what a reading of a coupled motion tells
        const Column f0 = rate(t, y);
        const double nudge = (t < 0.5 * whole_ ? 1e-6 : -1e-6) * whole_;
        const Column in_time = (rate(t + nudge, y) - f0) / nudge;
        const Eigen::PartialPivLU<Square> solver(2 / dt * Square::Identity(states_, states_) - slopes(t, y, f0));
        const Column u1 = solver.solve(f0 + 0.5 * dt * in_time),
                     u2 = solver.solve(f0 + 1.5 * dt * in_time + 4 / dt * u1),
                     u3 = solver.solve(rate(t + dt, y + 2 * u1) + (u1 - u2) / dt), y4 = y + 2 * u1 + u3,
                     u4 = solver.solve(rate(t + dt, y4) + (u1 - u2 - 8.0 / 3 * u3) / dt);
        const Column next = y4 + u4;
        error = 0;
        for (Eigen::Index i = 0; i < states_; ++i) {
            const double own = std::abs(u4[i]) / (absolute + relative * std::max(std::abs(y[i]), std::abs(next[i])));
            error = std::isfinite(own) ? std::max(error, own) : INFINITY;
        }
        return next;
    }

private:
    [[nodiscard]] Square slopes(double t, const Column& y, const Column& f0) const {
        constexpr double small = 1e-7;
        Square slope(states_, states_);
        for (Eigen::Index j = 0; j < states_; ++j) {
            Column moved = y;
            moved[j] += small;
            slope.col(j) = (rate(t, moved) - f0) / small;
        }
        return slope;
    }

    double whole_;
    Eigen::Index states_;
    const MotionRate& rate_;
};

}  // namespace

void stiff_step(double h, std::size_t states, MotionState& y, const MotionRate& rate) {
    constexpr int most_tries = 2000;
    const Rodas3 method(h, states, rate);
    Column at = Eigen::Map<const Column>(y.data(), static_cast<Eigen::Index>(states));
    double t = 0, width = h;
    for (int tries = 0; t < h * (1 - 1e-12); ++tries) {
        if (tries > most_tries) {
            at.setConstant(std::nan(""));
            break;
        }
        width = std::min(width, h - t);
        double error = 0;
        const Column next = method.step(at, t, width, error);
        const double factor =
            std::isfinite(error) ? std::clamp(0.9 / std::cbrt(std::max(error, 1e-12)), 0.2, 5.0) : 0.1;
        if (error <= 1) {
            at = next;
            t += width;
        }
        width *= error <= 1 ? factor : std::min(factor, 0.9);
    }
    std::copy(at.data(), at.data() + at.size(), y.begin());
}

}  // namespace underbody::dynamics
