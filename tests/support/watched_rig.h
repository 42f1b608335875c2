// A rig that is its model until something changes: a body of 4 kg on a spring of 8 N/m about a gap of 0.1 m with linear
// damping, a controller fed with the noisy reading, steps of its set point. For tests and benches of the watch.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/random.h"
#include "surrogates/discovery/watch/watch.h"

namespace underbody::test {

struct WatchedRig {
    static constexpr double mass = 4, stiffness = 8, middle = 0.1, damping = 0.5;
    double step = 0.05;      ///< s between readings
    double noise = 2e-4;     ///< m, of a reading
    double colour = 0;       ///< autocorrelation of the noise from one reading to the next
    double disturbance = 0;  ///< N sqrt(s), white force
    double wild = 0;         ///< share of readings that are anything within 0.5 m
    double lost = 0;       ///< share of readings that are lost, half of them one by one, half in silences of up to 20 s
    double lost_rows = 0;  ///< share of rows that are lost one by one, with the input that is logged in them
    double text = 0;       ///< share of fields that hold no number, of the reading and of the input
    double spring = stiffness;  ///< N/m; 0: a free body
    // What changes:
    double force = 0;         ///< N, constant
    double bias = 0;          ///< m, of a reading
    double friction = 0;      ///< N, against the motion
    double gain = 1;          ///< of the input
    double more_damping = 0;  ///< N s/m

    explicit WatchedRig(std::uint64_t seed) : random(seed) {}

    static dynamics::Model model() {
        return dynamics::read_model_text(
            "[vehicle]\nmass = 4\nnet_weight = 0\n[drag.heave]\nlinear = 0.5\nquadratic = "
            "0\n[[effect]]\nname = \"tether_stiffness\"\nstiffness = 8\ngap = 0.1\n",
            "rig.toml", ".");
    }

    double time = 0, input = 0, reading = 0;
    bool silent = false;  ///< the row was lost: the reading and the input that was logged beside it
    bool missed = false;  ///< the reading alone was lost
    bool unread = false;  ///< the input alone was lost

    /// To the next reading; the input acts from the reading before on.
    void advance() {
        const double kick = disturbance > 0 ? random.normal(0, disturbance / std::sqrt(step)) : 0;
        const int parts = friction > 0 ? 5 : 1;  // fourth order: 1e-8 of the motion's size in one step without friction
        for (int i = 0; i < parts; ++i) {
            const double dt = step / parts;
            const auto slope = [&](double h, double w) {
                const double guide = friction > 0 ? friction * std::tanh(w / 5e-4) : 0;
                return (gain * input + kick + force - guide - spring * (h - middle) - (damping + more_damping) * w) /
                       mass;
            };
            const double a1 = slope(gap, velocity), a2 = slope(gap + 0.5 * dt * velocity, velocity + 0.5 * dt * a1);
            const double w2 = velocity + 0.5 * dt * a1, w3 = velocity + 0.5 * dt * a2;
            const double a3 = slope(gap + 0.5 * dt * w2, w3);
            const double w4 = velocity + dt * a3, a4 = slope(gap + dt * w3, w4);
            gap += dt / 6 * (velocity + 2 * w2 + 2 * w3 + w4);
            velocity += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        }
        time += step;
        error = colour * error + std::sqrt(1 - colour * colour) * random.normal(0, noise);
        reading = gap + error + bias;
        if (wild > 0 && random.uniform() < wild) {
            reading += random.uniform(-0.5, 0.5);
        }
        if (lost > 0) {
            if (random.uniform() < lost * step / 20) {
                silent_until = time + random.uniform(0, 20);
            }
            silent = time < silent_until;
            missed = random.uniform() < 0.5 * lost;
        }
        if (lost_rows > 0) {
            silent = time < silent_until || random.uniform() < lost_rows;
        }
        if (text > 0) {
            missed = random.uniform() < text;
            unread = random.uniform() < text;
        }
        if (random.uniform() < step / 10) {
            target = middle + random.uniform(-0.02, 0.02);
        }
        input = std::clamp(3 * (target - reading), -0.3, 0.3);
    }

    /// The next reading goes to a watch.
    std::optional<discovery::WatchAlarm> show(discovery::Watch& watch) {
        advance();
        if (silent) {
            return {};
        }
        std::optional<discovery::WatchAlarm> alarm;
        if (!missed) {
            alarm = watch.gap(time, reading);
        }
        if (!unread) {
            watch.input(time, input);
        }
        return alarm;
    }

private:
    core::Random random;
    double gap = 0.11, velocity = 0, error = 0, target = middle, silent_until = 0;
};

/// Alarms of a rig that stays its model.
inline int false_alarms(WatchedRig rig, double hours, double per_day) {
    discovery::WatchOptions options;
    options.false_alarms_per_day = per_day;
    discovery::Watch watch(WatchedRig::model(), options);
    int alarms = 0;
    while (rig.time < 3600 * hours) {
        if (rig.show(watch)) {
            ++alarms;
            watch.reset();
        }
    }
    return alarms;
}

}  // namespace underbody::test
