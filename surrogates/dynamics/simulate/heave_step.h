// Steps of the heave motion through time: the classical Runge-Kutta method where the motion is slow against the step,
// an L-stable Rosenbrock method with error control where friction, film or springs are fast against it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "surrogates/dynamics/plant/heave_equation.h"

namespace underbody::dynamics {

/// Gap, velocity and the memory of the history force.
struct HeaveState {
    double h = 0, w = 0;
    double memory[history_states] = {};
};

/// The body at the ground: stops, bounces, or leaves when it is lifted.
inline void touch_ground(double contact_gap, double restitution, HeaveState& s) {
    if (s.h < contact_gap) {
        s.h = contact_gap;
        s.w = s.w < 0 ? -restitution * s.w : s.w;
    }
}

/// Law: double law(double part, double h, double w, const double* memory, HeaveSlopes* slopes) gives dw/dt at a part
/// (0 to 1) of the step, with its slopes where asked for. `history`: N s^1/2 s/m, 0 without memory. Never throws: NaN
/// in the state says that no step was small enough.
template <class Law>
class HeaveStepper {
public:
    HeaveStepper(const Law& law, double history, double contact_gap, double restitution)
        : law_(law), history_(history), contact_gap_(contact_gap), restitution_(restitution) {}

    /// Over `dt`. `fastest`: the largest rate in 1/s that the law can show between the two ends of this step (film of a
    /// gap that closes, friction of a velocity that turns), beside the slopes where it begins.
    template <class Fastest>
    void advance(HeaveState& s, double dt, const Fastest& fastest) const {
        HeaveSlopes slopes;
        const double a = law_(0, s.h, s.w, memory(s), &slopes);
        const double rate = std::max({-slopes.velocity, std::sqrt(std::abs(slopes.gap)), fastest(s, a, dt)});
        if (dt * rate < slow_) {
            runge_kutta(s, dt, a);
            touch_ground(contact_gap_, restitution_, s);
        } else {
            rosenbrock(s, dt);
        }
    }

private:
    /// Above this product of step and rate the error of the classical method is no longer small (z^5/120).
    static constexpr double slow_ = 0.4;
    static constexpr int most_tries_ = 4000;

    [[nodiscard]] const double* memory(const HeaveState& s) const { return history_ != 0 ? s.memory : nullptr; }

    void runge_kutta(HeaveState& s, double dt, double a1) const {
        const HistoryKernel& kernel = history_kernel();
        const bool history = history_ != 0;
        const auto moved = [&](const HeaveState& by, double w_rate, double part, const double* k) {
            HeaveState at = s;
            at.h += part * by.w;
            at.w += part * w_rate;
            for (std::size_t i = 0; history && i < history_states; ++i) {
                at.memory[i] += part * k[i];
            }
            return at;
        };
        double k[4][history_states];
        const auto forget = [&](const HeaveState& at, double* rate) {
            for (std::size_t i = 0; history && i < history_states; ++i) {
                rate[i] = -kernel.rate[i] * (at.memory[i] + at.w);
            }
        };
        forget(s, k[0]);
        const HeaveState s2 = moved(s, a1, 0.5 * dt, k[0]);
        const double a2 = law_(0.5, s2.h, s2.w, memory(s2), nullptr);
        forget(s2, k[1]);
        const HeaveState s3 = moved(s2, a2, 0.5 * dt, k[1]);
        const double a3 = law_(0.5, s3.h, s3.w, memory(s3), nullptr);
        forget(s3, k[2]);
        const HeaveState s4 = moved(s3, a3, dt, k[2]);
        const double a4 = law_(1, s4.h, s4.w, memory(s4), nullptr);
        forget(s4, k[3]);
        s.h += dt / 6 * (s.w + 2 * s2.w + 2 * s3.w + s4.w);
        s.w += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        for (std::size_t i = 0; history && i < history_states; ++i) {
            s.memory[i] += dt / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
        }
    }

    /// A change of the state, or its rate.
    struct Change {
        double h, w;
        double memory[history_states];
    };
    [[nodiscard]] Change rate(double part, const HeaveState& s) const {
        Change f{s.w, law_(part, s.h, s.w, memory(s), nullptr), {}};
        for (std::size_t i = 0; history_ != 0 && i < history_states; ++i) {
            f.memory[i] = -history_kernel().rate[i] * (s.memory[i] + s.w);
        }
        return f;
    }
    [[nodiscard]] HeaveState plus(const HeaveState& s, double a, const Change& u, double b = 0,
                                  const Change& v = {}) const {
        HeaveState at = s;
        at.h += a * u.h + b * v.h;
        at.w += a * u.w + b * v.w;
        for (std::size_t i = 0; history_ != 0 && i < history_states; ++i) {
            at.memory[i] += a * u.memory[i] + b * v.memory[i];
        }
        return at;
    }

    /// (d - J) u = right, J of (gap, velocity, memory) with `slopes`: the memory is eliminated by hand.
    [[nodiscard]] Change solve(double d, const HeaveSlopes& slopes, const Change& right) const {
        const HistoryKernel& kernel = history_kernel();
        double diagonal = d - slopes.velocity - slopes.gap / d, sum = right.w + slopes.gap * right.h / d;
        for (std::size_t i = 0; history_ != 0 && i < history_states; ++i) {
            const double pull = -history_ * kernel.weight[i] / slopes.mass;
            diagonal += pull * kernel.rate[i] / (d + kernel.rate[i]);
            sum += pull * right.memory[i] / (d + kernel.rate[i]);
        }
        Change u{};
        u.w = sum / diagonal;
        u.h = (right.h + u.w) / d;
        for (std::size_t i = 0; history_ != 0 && i < history_states; ++i) {
            u.memory[i] = (right.memory[i] - kernel.rate[i] * u.w) / (d + kernel.rate[i]);
        }
        return u;
    }

    /// Rodas3 (Sandu, Verwer, Blom, Spee, Carmichael and Potra 1997): order 3, L-stable, embedded order 2.
    [[nodiscard]] HeaveState try_step(const HeaveState& s, double t, double dt, double whole, double& error) const {
        HeaveSlopes slopes;
        const double part = t / whole, width = dt / whole, nudge = part + 1e-6 < 1 ? 1e-6 : -1e-6;
        Change f0 = rate(part, s);
        f0.w = law_(part, s.h, s.w, memory(s), &slopes);
        const double in_time = (law_(part + nudge, s.h, s.w, memory(s), nullptr) - f0.w) / (nudge * whole);
        const double d = 2 / dt;
        const auto with = [&](Change f, double of_time, double a, const Change& u, double b = 0, const Change& v = {},
                              double c = 0, const Change& x = {}) {
            f.h += (a * u.h + b * v.h + c * x.h) / dt;
            f.w += (a * u.w + b * v.w + c * x.w) / dt + of_time * dt * in_time;
            for (std::size_t i = 0; history_ != 0 && i < history_states; ++i) {
                f.memory[i] += (a * u.memory[i] + b * v.memory[i] + c * x.memory[i]) / dt;
            }
            return f;
        };
        const Change u1 = solve(d, slopes, with(f0, 0.5, 0, {}));
        const Change u2 = solve(d, slopes, with(f0, 1.5, 4, u1));
        const Change u3 = solve(d, slopes, with(rate(part + width, plus(s, 2, u1)), 0, 1, u1, -1, u2));
        const HeaveState s4 = plus(s, 2, u1, 1, u3);
        const Change u4 = solve(d, slopes, with(rate(part + width, s4), 0, 1, u1, -1, u2, -8.0 / 3, u3));
        const HeaveState next = plus(s4, 1, u4);
        const double scale_h = 1e-10 + 1e-7 * std::max(std::abs(s.h), std::abs(next.h));
        const double scale_w = 1e-9 + 1e-6 * std::max(std::abs(s.w), std::abs(next.w));
        error = std::max(std::abs(u4.h) / scale_h, std::abs(u4.w) / scale_w);
        return next;
    }

    void rosenbrock(HeaveState& s, double dt) const {
        double t = 0, step = dt;
        for (int tries = 0; t < dt; ++tries) {
            if (tries > most_tries_ || !(step > 1e-14)) {
                s.h = s.w = std::nan("");
                return;
            }
            const bool last = t + step >= dt * (1 - 1e-12);
            const double width = last ? dt - t : step;
            double error = 0;
            const HeaveState next = try_step(s, t, width, dt, error);
            const double factor =
                std::isfinite(error) ? std::clamp(0.9 / std::cbrt(std::max(error, 1e-12)), 0.2, 5.0) : 0.1;
            if (error <= 1) {
                s = next;
                touch_ground(contact_gap_, restitution_, s);
                t = last ? dt : t + width;
                step = width * factor;
            } else {
                step = width * std::min(factor, 0.9);
            }
        }
    }

    const Law& law_;
    double history_, contact_gap_, restitution_;
};

/// The largest rate, 1/s, that the film can show over a step: at the lowest gap that it can reach.
inline double film_rate(const HeaveTerms& terms, double h, double w, double acceleration, double dt) {
    const double down = std::min({0.0, w, w + dt * acceleration}) * dt;
    const double gap = std::max({h + down, 0.5 * h, least_film_gap});
    return terms.film / (gap * gap * gap * terms.mass);
}

/// The largest rate, 1/s, that film and guide can show over a step: the latter at rest where the velocity may turn.
inline double fastest_rate(const HeaveTerms& terms, const HeaveState& s, double acceleration, double dt) {
    double rate = terms.film != 0 ? film_rate(terms, s.h, s.w, acceleration, dt) : 0;
    if (terms.friction != 0) {
        const double reach = std::abs(dt * acceleration) + 3 * terms.friction_width;
        rate += std::abs(s.w) < reach ? terms.friction / (terms.friction_width * terms.mass) : 0;
    }
    return rate;
}

}  // namespace underbody::dynamics
