#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/heave.h"

namespace underbody::dynamics {

namespace {

/// Linear between samples, held beyond the ends. `hint` makes ascending look-ups cheap.
double interpolated(const std::vector<double>& time, const std::vector<double>& values, double t, std::size_t& hint) {
    if (t <= time.front()) {
        return values.front();
    }
    if (t >= time.back()) {
        return values.back();
    }
    while (hint + 1 < time.size() && time[hint + 1] < t) {
        ++hint;
    }
    while (hint > 0 && time[hint] > t) {
        --hint;
    }
    const double part = (t - time[hint]) / (time[hint + 1] - time[hint]);
    return values[hint] + part * (values[hint + 1] - values[hint]);
}

/// A missing value is bridged by its neighbours.
std::vector<double> without_gaps(const std::vector<double>& time, std::vector<double> values) {
    std::vector<double> t, v;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) {
            t.push_back(time[i]);
            v.push_back(values[i]);
        }
    }
    if (t.size() == values.size() || t.empty()) {
        return values;
    }
    std::size_t hint = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = interpolated(t, v, time[i], hint);
    }
    return values;
}

void apply_lag(const std::vector<double>& time, std::vector<double>& signal, double time_constant) {
    double y = signal.front();
    double before = signal.front();
    for (std::size_t i = 1; i < signal.size(); ++i) {
        // Exact for an input that is linear between points.
        const double a = (time[i] - time[i - 1]) / time_constant;
        const double decay = std::exp(-a);
        const double now = signal[i];
        const double ramp = a > 1e-8 ? (1 - decay) / a : 1 - a / 2;
        y = y * decay + now - before * decay - (now - before) * ramp;
        before = now;
        signal[i] = y;
    }
}

}  // namespace

HeaveRun::HeaveRun(const HeavePlant& plant, const InputSignals& inputs, double max_step) : time_(inputs.time) {
    if (time_.size() < 2) {
        throw core::InputError("range", "a run needs at least two times");
    }
    start_.push_back(0);
    half_time_.push_back(time_[0]);
    for (std::size_t i = 0; i + 1 < time_.size(); ++i) {
        const double width = time_[i + 1] - time_[i];
        if (!(width > 0)) {
            throw core::InputError("range", "time does not grow in the input signals");
        }
        const auto steps = static_cast<std::size_t>(std::ceil(width / max_step * (1 - 1e-9)));
        const std::size_t halves = 2 * std::max<std::size_t>(steps, 1);
        for (std::size_t k = 1; k <= halves; ++k) {
            half_time_.push_back(k == halves ? time_[i + 1]
                                             : time_[i] + width * static_cast<double>(k) / static_cast<double>(halves));
        }
        start_.push_back(half_time_.size() - 1);
    }
    const std::size_t count = half_time_.size();
    const HeaveTerms& terms = plant.terms;
    const double held_input = inputs.held.get(Channel::input_force, plant.held().get(Channel::input_force, 0.0));
    std::vector<double> recorded;
    std::vector<const InputSignals::Signal*> others;
    std::vector<std::vector<double>> filled;
    for (const InputSignals::Signal& signal : inputs.signals) {
        std::vector<double> values = without_gaps(time_, signal.values);
        if (signal.channel == Channel::input_force) {
            recorded = std::move(values);
        } else if (std::find(plant.varying_channels_.begin(), plant.varying_channels_.end(), signal.channel) ==
                   plant.varying_channels_.end()) {
            throw core::InputError(
                "range", std::string(channel_name(signal.channel)) + " varies in the run, but the plant holds it");
        } else {
            others.push_back(&signal);
            filled.push_back(std::move(values));
        }
    }
    if (recorded.empty()) {
        recorded.assign(time_.size(), held_input);
    }
    if (inputs.input_between == InputSignals::Between::held) {
        transform_held(terms, std::move(recorded));
    } else {
        transform_linear(terms, recorded);
    }
    const auto value_of = [&](Channel channel, double t, double fallback) {
        for (std::size_t k = 0; k < others.size(); ++k) {
            if (others[k]->channel == channel) {
                std::size_t hint =
                    static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), t) - time_.begin());
                hint = hint > 0 ? hint - 1 : 0;
                return interpolated(time_, filled[k], t, hint);
            }
        }
        return fallback;
    };
    factor_count_ = plant.varying_.size();
    factors_.resize(count * factor_count_);
    for (std::size_t k = 0; k < factor_count_; ++k) {
        const HeaveSource& source = terms.sources[plant.varying_[k]];
        for (std::size_t i = 0; i < count; ++i) {
            double factor = source.factor;
            for (const HeaveSource::Scale& scale : source.scales) {
                factor *=
                    scale.factor(value_of(scale.channel, half_time_[i], inputs.held.get(scale.channel, scale.held)));
            }
            factors_[i * factor_count_ + k] = factor;
        }
    }
    if (plant.needs_channels_) {
        const Conditions held = inputs.held.over(plant.held());
        channels_.resize(count * channel_count);
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < channel_count; ++c) {
                channels_[i * channel_count + c] = value_of(static_cast<Channel>(c), half_time_[i], held.value[c]);
            }
        }
    }
}

namespace {

double through_dead_zone(const HeaveTerms& terms, double u) {
    return terms.input_gain * std::copysign(std::max(0.0, std::abs(u) - terms.input_dead_zone), u);
}

}  // namespace

void HeaveRun::transform_linear(const HeaveTerms& terms, const std::vector<double>& values) {
    input_.resize(half_time_.size());
    std::size_t hint = 0;
    for (std::size_t i = 0; i < input_.size(); ++i) {
        input_[i] = through_dead_zone(terms, interpolated(time_, values, half_time_[i] - terms.input_delay, hint));
    }
    if (terms.input_lag > 0) {
        apply_lag(half_time_, input_, terms.input_lag);
    }
    input_end_ = input_;
}

void HeaveRun::transform_held(const HeaveTerms& terms, std::vector<double> values) {
    for (double& u : values) {
        u = through_dead_zone(terms, u);
    }
    // The mean over a step is exact whatever the delay: from the integral of the steps, which is linear between
    // samples.
    std::vector<double> sum(time_.size(), 0.0);
    for (std::size_t i = 0; i + 1 < time_.size(); ++i) {
        sum[i + 1] = sum[i] + values[i] * (time_[i + 1] - time_[i]);
    }
    std::size_t hint = 0;
    const auto integral = [&](double t) {
        if (t <= time_.front()) {
            return values.front() * (t - time_.front());
        }
        if (t >= time_.back()) {
            return sum.back() + values.back() * (t - time_.back());
        }
        return interpolated(time_, sum, t, hint);
    };
    input_.resize(half_time_.size());
    input_end_.resize(half_time_.size());
    double lagged = values.front();
    for (std::size_t half = 0; half + 2 < half_time_.size(); half += 2) {
        const double width = half_time_[half + 2] - half_time_[half];
        const double mean =
            (integral(half_time_[half + 2] - terms.input_delay) - integral(half_time_[half] - terms.input_delay)) /
            width;
        if (terms.input_lag > 0) {
            const double decay = std::exp(-0.5 * width / terms.input_lag);
            input_[half] = lagged;
            input_[half + 1] = mean + (lagged - mean) * decay;
            lagged = mean + (lagged - mean) * decay * decay;
            input_end_[half + 2] = lagged;
        } else {
            input_[half] = input_[half + 1] = input_end_[half + 2] = mean;
        }
    }
    input_.back() = terms.input_lag > 0 ? lagged : input_[input_.size() - 2];
}

HeavePlant::Moment HeaveRun::moment_at(std::size_t half, double t) const {
    return {t, input_[half], factor_count_ ? &factors_[half * factor_count_] : nullptr,
            channels_.empty() ? nullptr : &channels_[half * channel_count]};
}

void HeaveRun::moment(double t, HeavePlant::Moment& out, std::vector<double>& buffer) const {
    const auto above = std::upper_bound(half_time_.begin(), half_time_.end(), t);
    std::size_t i = above == half_time_.begin() ? 0 : static_cast<std::size_t>(above - half_time_.begin()) - 1;
    i = std::min(i, half_time_.size() - 2);
    const double part = std::clamp((t - half_time_[i]) / (half_time_[i + 1] - half_time_[i]), 0.0, 1.0);
    const std::size_t channels = channels_.empty() ? 0 : channel_count;
    buffer.resize(factor_count_ + channels);
    out.t = t;
    const double right = (i + 1) % 2 == 0 ? input_end_[i + 1] : input_[i + 1];
    out.input = input_[i] + part * (right - input_[i]);
    for (std::size_t k = 0; k < factor_count_; ++k) {
        const double a = factors_[i * factor_count_ + k], b = factors_[(i + 1) * factor_count_ + k];
        buffer[k] = a + part * (b - a);
    }
    for (std::size_t k = 0; k < channels; ++k) {
        const double a = channels_[i * channel_count + k], b = channels_[(i + 1) * channel_count + k];
        buffer[factor_count_ + k] = a + part * (b - a);
    }
    out.factors = factor_count_ ? buffer.data() : nullptr;
    out.channels = channels ? buffer.data() + factor_count_ : nullptr;
}

namespace {

struct State {
    double h, w;
    double memory[history_states];
};

/// How fast friction and film alone would stop the body, 1/s: what limits an explicit step.
double stopping_rate(const HeaveTerms& terms, double h, double w) {
    double slope = terms.linear + std::abs(terms.extra_linear) +
                   2 * (terms.quadratic + std::abs(terms.extra_quadratic)) * std::abs(w - terms.current);
    if (terms.friction != 0) {
        const double width = terms.friction_width;
        // The worst velocity that the step can pass through.
        const double size = w * w + width * width;
        slope += terms.friction * width * width / (size * std::sqrt(size));
    }
    if (terms.film != 0) {
        const double gap = std::max(h, 1e-5);
        slope += terms.film / (gap * gap * gap);
    }
    return slope / terms.mass;
}

template <bool WithHistory>
void step(const HeavePlant& plant, State& s, double dt, const HeavePlant::Moment& a, const HeavePlant::Moment& b,
          const HeavePlant::Moment& c) {
    const HistoryKernel& kernel = history_kernel();
    const double* memory = WithHistory ? s.memory : nullptr;
    const double w1 = s.w;
    const double a1 = plant.acceleration(s.h, w1, a, memory);
    const double w2 = s.w + 0.5 * dt * a1;
    double m2[history_states], m3[history_states], m4[history_states], k1[history_states], k2[history_states],
        k3[history_states];
    if constexpr (WithHistory) {
        for (std::size_t i = 0; i < history_states; ++i) {
            k1[i] = -kernel.rate[i] * (s.memory[i] + w1);
            m2[i] = s.memory[i] + 0.5 * dt * k1[i];
        }
    }
    const double a2 = plant.acceleration(s.h + 0.5 * dt * w1, w2, b, WithHistory ? m2 : nullptr);
    const double w3 = s.w + 0.5 * dt * a2;
    if constexpr (WithHistory) {
        for (std::size_t i = 0; i < history_states; ++i) {
            k2[i] = -kernel.rate[i] * (m2[i] + w2);
            m3[i] = s.memory[i] + 0.5 * dt * k2[i];
        }
    }
    const double a3 = plant.acceleration(s.h + 0.5 * dt * w2, w3, b, WithHistory ? m3 : nullptr);
    const double w4 = s.w + dt * a3;
    if constexpr (WithHistory) {
        for (std::size_t i = 0; i < history_states; ++i) {
            k3[i] = -kernel.rate[i] * (m3[i] + w3);
            m4[i] = s.memory[i] + dt * k3[i];
        }
    }
    const double a4 = plant.acceleration(s.h + dt * w3, w4, c, WithHistory ? m4 : nullptr);
    s.h += dt / 6 * (w1 + 2 * w2 + 2 * w3 + w4);
    s.w += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if constexpr (WithHistory) {
        for (std::size_t i = 0; i < history_states; ++i) {
            const double k4 = -kernel.rate[i] * (m4[i] + w4);
            s.memory[i] += dt / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4);
        }
    }
}

/// The body at the ground: stops, bounces, or leaves when it is lifted.
void touch(const HeaveTerms& terms, State& s) {
    if (s.h < terms.contact_gap) {
        s.h = terms.contact_gap;
        s.w = s.w < 0 ? -terms.restitution * s.w : s.w;
    }
}

template <bool WithHistory>
void advance(const HeavePlant& plant, State& s, double dt, const HeavePlant::Moment& a, const HeavePlant::Moment& b,
             const HeavePlant::Moment& c) {
    const double stiff = dt * stopping_rate(plant.terms, s.h, s.w);
    if (stiff < 1.2) {
        step<WithHistory>(plant, s, dt, a, b, c);
        touch(plant.terms, s);
        return;
    }
    const int parts = static_cast<int>(std::min(std::ceil(stiff), 64.0));
    const double part = dt / parts;
    for (int i = 0; i < parts; ++i) {
        // Inputs within a stiff step: taken from the nearer of its two halves.
        const HeavePlant::Moment& near = i < parts / 3 ? a : i < 2 * parts / 3 + 1 ? b : c;
        const double rate = stopping_rate(plant.terms, s.h, s.w);
        if (part * rate < 2) {
            step<WithHistory>(plant, s, part, near, near, near);
        } else {
            // Linearly implicit in the velocity: damped as the film damps, whatever the step.
            const double now = plant.acceleration(s.h, s.w, near, WithHistory ? s.memory : nullptr);
            const double w = s.w + part * now / (1 + part * rate);
            s.h += part * 0.5 * (s.w + w);
            s.w = w;
        }
        touch(plant.terms, s);
    }
}

}  // namespace

void HeaveRun::simulate(const HeavePlant& plant, std::size_t first, std::size_t last, double gap, double velocity,
                        std::span<double> gap_out, std::span<double> velocity_out) const {
    State s{gap, velocity, {}};
    const bool history = plant.terms.history != 0;
    for (double& memory : s.memory) {
        memory = -velocity;
    }
    for (std::size_t sample = first;; ++sample) {
        gap_out[sample - first] = s.h;
        if (!velocity_out.empty()) {
            velocity_out[sample - first] = s.w;
        }
        if (sample >= last) {
            return;
        }
        for (std::size_t half = start_[sample]; half < start_[sample + 1]; half += 2) {
            const double t = half_time_[half], next = half_time_[half + 2];
            const HeavePlant::Moment a = moment_at(half, t);
            const HeavePlant::Moment b = moment_at(half + 1, half_time_[half + 1]);
            HeavePlant::Moment c = moment_at(half + 2, next);
            c.input = input_end_[half + 2];
            if (history) {
                advance<true>(plant, s, next - t, a, b, c);
            } else {
                advance<false>(plant, s, next - t, a, b, c);
            }
        }
    }
}

void HeaveRun::sensor(const HeavePlant& plant, std::size_t first, std::span<const double> true_gap,
                      std::span<double> reading) const {
    const double delay = plant.terms.sensor_delay, bias = plant.terms.sensor_bias;
    if (delay == 0) {
        for (std::size_t i = 0; i < reading.size(); ++i) {
            reading[i] = true_gap[i] + bias;
        }
        return;
    }
    std::size_t k = 0;
    for (std::size_t i = 0; i < reading.size(); ++i) {
        const double t = time_[first + i] - delay;
        while (k + 2 < true_gap.size() && time_[first + k + 1] < t) {
            ++k;
        }
        if (t <= time_[first] || true_gap.size() < 2) {
            reading[i] = true_gap[0] + bias;
            continue;
        }
        const double t0 = time_[first + k], t1 = time_[first + k + 1];
        const double part = std::clamp((t - t0) / (t1 - t0), 0.0, 1.0);
        reading[i] = true_gap[k] + part * (true_gap[k + 1] - true_gap[k]) + bias;
    }
}

}  // namespace underbody::dynamics
