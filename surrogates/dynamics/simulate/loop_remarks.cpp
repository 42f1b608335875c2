// What is said of a feedback before its loop runs.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/told.h"
#include "surrogates/dynamics/linear/trim_error.h"
#include "surrogates/dynamics/model/matrix_algebra.h"
#include "surrogates/dynamics/plant/resting_gaps.h"
#include "surrogates/dynamics/simulate/feedback.h"

namespace underbody::dynamics {

namespace {

/// Differentiation at the Chebyshev points cos(i pi/n), i = 0 to n (Trefethen 2000, chapter 6).
Matrix chebyshev(std::size_t n) {
    const auto x = [n](std::size_t i) {
        return std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
    };
    const auto weight = [n](std::size_t i) { return (i == 0 || i == n ? 2.0 : 1.0) * (i % 2 == 0 ? 1 : -1); };
    Matrix d(n + 1, n + 1);
    for (std::size_t i = 0; i <= n; ++i) {
        for (std::size_t j = 0; j <= n; ++j) {
            if (i != j) {
                d(i, j) = weight(i) / weight(j) / (x(i) - x(j));
                d(i, i) -= d(i, j);
            }
        }
    }
    return d;
}

/// Of dx/dt = now x(t) + then x(t - delay).
std::complex<double> rightmost_delayed(const Matrix& now, const Matrix& then, double delay) {
    constexpr std::size_t points = 20;
    const std::size_t n = now.rows();
    const Matrix d = chebyshev(points);
    Matrix all((points + 1) * n, (points + 1) * n);
    all.set_block(0, 0, now);
    all.set_block(0, points * n, then);
    for (std::size_t i = 1; i <= points; ++i) {
        for (std::size_t j = 0; j <= points; ++j) {
            for (std::size_t k = 0; k < n; ++k) {
                all(i * n + k, j * n + k) = 2 / delay * d(i, j);
            }
        }
    }
    return eigenvalues(all).front();
}

void warn(core::Problems& remarks, std::string text) {
    remarks.push_back({core::Problem::Severity::warning, std::move(text), {}});
}

/// Of the gap to hold.
void remark_on_reference(core::Problems& remarks, const HeavePlant& plant, double gap) {
    const auto [lower, upper] = resting_range(plant);
    if (gap < plant.contact_gap()) {
        warn(remarks, "the feedback's reference " + core::told(gap, "m") +
                          " lies in the ground, below the contact gap " + core::told(plant.contact_gap(), "m"));
    } else if (gap < lower || gap > upper) {
        const double milli = 1e-3 * gap;
        warn(remarks, "the feedback's reference " + core::told(gap, "m") + " lies outside the force tables, " +
                          core::told_range(lower, upper, "m") +
                          (milli >= lower && milli <= upper ? ": " + core::told(milli, "m") + " would fit" : ""));
    }
}

void remark_on_sign(core::Problems& remarks, const char* name, double gain, const char* unit, const char* what) {
    if (gain < 0) {
        warn(remarks,
             std::string(name) + " " + core::told(gain, unit) + " is negative as it reaches the body: " + what);
    }
}

/// Of gains that know no delay, lag and dead zone. `about`: small motions about the reference `where`, and what a
/// commanded force does there; `k`: its gains.
void remark_on_actuator(core::Problems& remarks, const Actuator& actuator, const LinearSystem& about, const Matrix& k,
                        const std::string& where, bool designed) {
    if (designed && actuator.dead_zone > 0) {
        warn(remarks, "the gains are designed without the actuator's dead zone of " +
                          core::told(actuator.dead_zone, "N") + ": what they ask for within it does nothing" +
                          (k.largest() > 0 && about.a.rows() == 2
                               ? ", at rest up to " + core::told(actuator.dead_zone / std::abs(k(0, 1)), "m") +
                                     " off the reference"
                               : ""));
    }
    const double delay = std::max(0.0, actuator.delay);  // one of a record that lags behind is none of the loop
    if (delay == 0 && actuator.lag == 0) {
        return;
    }
    const double growth =
        rightmost_pole(about.a, about.b.block(0, 0, about.b.rows(), 1), k, delay, actuator.lag).real();
    if (!designed && growth < no_growth) {
        return;
    }
    const std::string what = std::string(delay > 0 ? "delay of " + core::told(delay, "s") : "") +
                             (delay > 0 && actuator.lag > 0 ? " and " : "") +
                             (actuator.lag > 0 ? "lag of " + core::told(actuator.lag, "s") : "");
    const std::string loop =
        growth < no_growth
            ? "the loop is stable about " + where + ", its slowest part decays with " + core::told(-growth, "1/s")
            : "the loop is unstable about " + where + ", it grows with " + core::told(growth, "1/s");
    warn(remarks, designed ? "the gains are designed without the actuator's " + what + "; with it " + loop
                           : "with the actuator's " + what + " " + loop);
}

}  // namespace

std::complex<double> rightmost_pole(const Matrix& a, const Matrix& b, const Matrix& k, double delay, double lag) {
    const std::size_t n = a.rows(), all = n + (lag > 0 ? 1 : 0);
    Matrix now(all, all), then(all, all);
    now.set_block(0, 0, a);
    if (lag > 0) {  // the last state is the force
        for (std::size_t i = 0; i < n; ++i) {
            now(i, n) = -b(i, 0);
            then(n, i) = k(0, i) / lag;
        }
        now(n, n) = -1 / lag;
    } else {
        then = Matrix(n, n) - b * k;
    }
    return delay > 0 ? rightmost_delayed(now, then, delay) : eigenvalues(now + then).front();
}

core::Problems loop_remarks(const HeavePlant& plant, const HeaveFeedback& feedback, bool designed) {
    core::Problems remarks;
    const double gap = feedback.reference, passed = plant.terms.actuator.gain * (1 - plant.terms.thrust_lost(gap));
    remark_on_reference(remarks, plant, gap);
    remark_on_sign(remarks, "gap_gain", passed * feedback.gap_gain, "N/m", "it drives away from the reference");
    remark_on_sign(remarks, "velocity_gain", passed * feedback.velocity_gain, "N s/m", "it feeds the motion");
    if (passed == 0) {
        warn(remarks, "nothing of a commanded force reaches the body: the feedback holds nothing");
    }
    LinearSystem about = heave_system(plant, gap);
    about.b(0, 0) *= passed;
    remark_on_actuator(remarks, plant.terms.actuator, about, Matrix{{feedback.velocity_gain, feedback.gap_gain}},
                       core::told(gap, "m"), designed);
    return remarks;
}

core::Problems loop_remarks(const HeavePitch& plant, const PitchFeedback& feedback, bool designed) {
    core::Problems remarks;
    const HeaveTerms& terms = plant.vertical().terms;
    const double gap = feedback.reference[0], passed = terms.actuator.gain * (1 - terms.thrust_lost(gap));
    remark_on_reference(remarks, plant.vertical(), gap);
    if (!designed) {  // a regulator may trade one state for the other
        remark_on_sign(remarks, "gap_gain", passed * feedback.force_gain[0], "N/m",
                       "it drives away from the reference");
        remark_on_sign(remarks, "velocity_gain", passed * feedback.force_gain[1], "N s/m", "it feeds the motion");
        remark_on_sign(remarks, "pitch_gain", feedback.moment_gain[2], "N m/rad", "it drives away from the reference");
        remark_on_sign(remarks, "pitch_rate_gain", feedback.moment_gain[3], "N m s/rad", "it feeds the motion");
    }
    LinearSystem about = plant.linearised(gap, feedback.reference[2]);
    Matrix force(1, 4), moment(1, 4);
    for (std::size_t i = 0; i < 4; ++i) {
        force(0, i) = feedback.force_gain[i];
        moment(0, i) = feedback.moment_gain[i];
        about.b(i, 0) *= passed;
    }
    about.a = about.a - about.b.block(0, 1, 4, 1) * moment;  // the moment passes no actuator
    remark_on_actuator(remarks, terms.actuator, about, force,
                       core::told(gap, "m") + " and " + core::told(feedback.reference[2], "rad", 4) + " nose up",
                       designed);
    return remarks;
}

}  // namespace underbody::dynamics
