// Heave runs of a rig whose controller is fed what is logged, as that of a real one is: the noisy reading, its speed by
// differences through a low pass.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/random.h"
#include "make_data.h"
#include "surrogates/dynamics/model/measurements.h"

namespace underbody::test {

struct ReadingRig {
    double seconds = 40, noise = 2e-4;                                ///< m, of a reading; declared so
    double drift = 0;                                                 ///< m/s, of the sensor, from each run's begin
    std::function<double(double)> felt = [](double u) { return u; };  ///< what the body feels of a commanded force
    /// N, what the model lacks: of time, gap and velocity, asked for in the order of time, anew in each run.
    std::function<double(double, double, double)> extra = [](double, double, double) { return 0.0; };
};

/// One run of it at 50 Hz; empty where the body touches the ground or flies away.
inline dynamics::MeasuredRun reading_run(const ReadingRig& rig, core::Random& random) {
    constexpr double step = 0.02, weight = 0.03, mass = 3.954, limit = 0.15, nearest = 0.006, farthest = 0.6;
    constexpr int parts = 8;
    double h = random.uniform(0.03, 0.25), w = 0, last = 0, rate = 0;
    const double middle = random.uniform(0.04, 0.2), wave = random.uniform(0.01, 0.04),
                 slow = random.uniform(0.03, 0.2), phase = random.uniform(0, 2 * std::numbers::pi);
    std::vector<double> time, gap, input;
    for (int k = 0; k * step < rig.seconds; ++k) {
        const double t = k * step, reading = h + rig.drift * t + rig.noise * random.normal();
        rate = 0.9 * rate + (k > 0 ? 0.1 * (reading - last) / step : 0);
        last = reading;
        const double wanted = middle + wave * std::sin(2 * std::numbers::pi * slow * t + phase) +
                              (static_cast<int>(t / 8 + phase) % 2 != 0 ? 0.02 : -0.02);
        const double u = std::clamp(weight - lift_of(wanted) + 0.6 * (wanted - reading) - 0.6 * rate, -limit, limit);
        time.push_back(t);
        gap.push_back(reading);
        input.push_back(u);
        for (int s = 0; s < parts; ++s) {  // the middle of each part
            const double part = step / parts, at = t + (s + 0.5) * part;
            const auto acceleration = [&](double hh, double ww) {
                return (lift_of(hh) - weight + rig.felt(u) - 0.02 * ww - 6 * ww * std::abs(ww) +
                        rig.extra(at, hh, ww)) /
                       mass;
            };
            const double hm = h + 0.5 * part * w, wm = w + 0.5 * part * acceleration(h, w);
            w += part * acceleration(hm, wm);
            h += part * wm;
        }
        if (h < nearest || h > farthest) {
            return {};
        }
    }
    dynamics::MeasuredRun run;
    run.table.add_numbers("time", "s", time);
    run.table.add_numbers("gap", "m", gap);
    run.table.add_numbers("input_force", "N", input);
    return run;
}

/// Eight runs that stay clear of the ground.
inline dynamics::Measurements reading_runs(const ReadingRig& rig, std::uint64_t seed) {
    dynamics::Measurements data;
    data.noise["gap"] = rig.noise;
    for (std::uint64_t draw = 0; data.runs.size() < 8; ++draw) {
        core::Random random(seed, draw);
        dynamics::MeasuredRun run = reading_run(rig, random);
        if (run.table.rows() > 0) {
            run.name = "run-" + std::to_string(data.runs.size() + 1);
            run.table.source = run.name + ".csv";
            data.runs.push_back(std::move(run));
        }
    }
    return data;
}

}  // namespace underbody::test
