#include "surrogates/dynamics/plant/actuator.h"

namespace underbody::dynamics {

namespace {

/// The integral of what the body feels, from the record's begin to each of its samples; `lagged` is left at the lag's
/// end.
std::vector<double> integral_of(const Actuator& actuator, const std::vector<double>& time,
                                const std::vector<double>& felt, bool hold, double& lagged) {
    std::vector<double> integral(time.size(), 0);
    lagged = felt.front();
    for (std::size_t i = 1; i < time.size(); ++i) {
        const double dt = time[i] - time[i - 1];
        const double area = dt * (hold ? felt[i - 1] : 0.5 * (felt[i - 1] + felt[i]));
        double out = area;
        if (actuator.lag > 0) {
            // area of the lagged signal = area of the input - time constant * growth of the lagged signal
            const double a = dt / actuator.lag;
            const double decay = std::exp(-a);
            const double ramp = a > 1e-6 ? (1 - decay) / a : 1 - 0.5 * a;
            const double before = lagged;
            lagged = hold ? lagged * decay + felt[i - 1] * (1 - decay)
                          : lagged * decay + felt[i] - felt[i - 1] * decay - (felt[i] - felt[i - 1]) * ramp;
            out = area - actuator.lag * (lagged - before);
        }
        integral[i] = integral[i - 1] + out;
    }
    return integral;
}

}  // namespace

void Actuator::mean_over_steps(const std::vector<double>& time, const std::vector<double>& values, bool hold,
                               const std::vector<double>& at, std::vector<double>& out) const {
    std::vector<double> passed = values;
    if (dead_zone != 0 || gain != 1) {
        std::transform(passed.begin(), passed.end(), passed.begin(), [this](double u) { return felt(u); });
    }
    double lagged = 0;
    const std::vector<double> integral = integral_of(*this, time, passed, hold, lagged);
    const std::size_t n = time.size();
    std::size_t sample = 0;
    const auto integral_at = [&](double t) {
        if (t <= time.front()) {
            return (t - time.front()) * passed.front();
        }
        if (t >= time.back()) {
            return integral.back() + (t - time.back()) * (lag > 0 ? lagged : passed.back());
        }
        while (sample + 2 < n && time[sample + 1] < t) {
            ++sample;
        }
        const double dt = time[sample + 1] - time[sample];
        const double part = t - time[sample];
        if (lag > 0 || hold) {
            return integral[sample] + (integral[sample + 1] - integral[sample]) * part / dt;
        }
        return integral[sample] + part * (passed[sample] + 0.5 * (passed[sample + 1] - passed[sample]) * part / dt);
    };
    out.resize(at.size());
    double before = integral_at(at.front() - delay);
    out[0] = passed.front();
    for (std::size_t k = 1; k < out.size(); ++k) {
        const double now = integral_at(at[k] - delay);
        out[k] = (now - before) / (at[k] - at[k - 1]);
        before = now;
    }
}

}  // namespace underbody::dynamics
