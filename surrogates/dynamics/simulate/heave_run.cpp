#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/heave_step.h"

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
    // In a closed loop it acts on the sum with the feedback.
    Actuator actuator = plant.loop ? Actuator{} : plant.terms.actuator;
    actuator.delay -= inputs.input_advance;
    if (inputs.input_between == InputSignals::Between::held) {
        transform_held(actuator, std::move(recorded));
    } else {
        transform_linear(actuator, recorded);
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
            factors_[i * factor_count_ + k] = source.multiplier([&](Channel channel, double held) {
                return value_of(channel, half_time_[i], inputs.held.get(channel, held));
            });
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

void HeaveRun::transform_linear(const Actuator& actuator, const std::vector<double>& values) {
    input_.resize(half_time_.size());
    std::size_t hint = 0;
    for (std::size_t i = 0; i < input_.size(); ++i) {
        input_[i] = actuator.felt(interpolated(time_, values, half_time_[i] - actuator.delay, hint));
    }
    if (actuator.lag > 0) {
        apply_lag(half_time_, input_, actuator.lag);
    }
    input_end_ = input_;
}

void HeaveRun::transform_held(const Actuator& actuator, std::vector<double> values) {
    for (double& u : values) {
        u = actuator.felt(u);
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
            (integral(half_time_[half + 2] - actuator.delay) - integral(half_time_[half] - actuator.delay)) / width;
        if (actuator.lag > 0) {
            const double decay = std::exp(-0.5 * width / actuator.lag);
            input_[half] = lagged;
            input_[half + 1] = mean + (lagged - mean) * decay;
            lagged = mean + (lagged - mean) * decay * decay;
            input_end_[half + 2] = lagged;
        } else {
            input_[half] = input_[half + 1] = input_end_[half + 2] = mean;
        }
    }
    input_.back() = actuator.lag > 0 ? lagged : input_[input_.size() - 2];
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

/// The plant over one step with the moments of its begin, middle and end.
struct PlantLaw {
    const HeaveRun& run;
    const HeavePlant& plant;
    const HeavePlant::Moment &a, &b, &c;
    double dt;
    std::vector<double>& buffer;

    double operator()(double part, double h, double w, const double* memory, HeaveSlopes* slopes) const {
        if (part == 0.0 || part == 0.5 || part == 1.0) {
            return evaluate(h, w, part == 0.0 ? a : part == 0.5 ? b : c, memory, slopes);
        }
        HeavePlant::Moment between;
        run.moment(a.t + part * dt, between, buffer);
        return evaluate(h, w, between, memory, slopes);
    }

private:
    double evaluate(double h, double w, const HeavePlant::Moment& moment, const double* memory,
                    HeaveSlopes* slopes) const {
        return slopes ? plant.acceleration(h, w, moment, memory, *slopes) : plant.acceleration(h, w, moment, memory);
    }
};

}  // namespace

void HeaveRun::simulate(const HeavePlant& plant, std::size_t first, std::size_t last, double gap, double velocity,
                        std::span<double> gap_out, std::span<double> velocity_out) const {
    HeaveState s{gap, velocity, {}};
    const HeaveTerms& terms = plant.terms;
    std::vector<double> buffer;
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
            const PlantLaw law{*this, plant, a, b, c, next - t, buffer};
            HeaveStepper<PlantLaw>(law, terms.history, terms.contact_gap, terms.restitution)
                .advance(s, next - t, [&terms](const HeaveState& at, double acceleration, double dt) {
                    return fastest_rate(terms, at, acceleration, dt);
                });
        }
    }
}

void HeaveRun::sensor(const HeavePlant& plant, std::size_t first, std::span<const double> true_gap,
                      std::span<double> reading) const {
    const double delay = plant.terms.sensor_delay;
    const auto bias = [&](std::size_t i) { return plant.terms.sensor_offset(time_[first + i]); };
    if (delay == 0) {
        for (std::size_t i = 0; i < reading.size(); ++i) {
            reading[i] = true_gap[i] + bias(i);
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
            reading[i] = true_gap[0] + bias(i);
            continue;
        }
        const double t0 = time_[first + k], t1 = time_[first + k + 1];
        const double part = std::clamp((t - t0) / (t1 - t0), 0.0, 1.0);
        reading[i] = true_gap[k] + part * (true_gap[k + 1] - true_gap[k]) + bias(i);
    }
}

}  // namespace underbody::dynamics
