// Small data sets for tests, made in memory or written to a folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::test {

/// A declared model over a table of lift against gap: dip near the ground, weak lift far from it.
inline double lift_of(double h) {
    return -0.04 * std::exp(-std::pow((h - 0.03) / 0.06, 2)) + 0.008 * std::exp(-std::pow((h - 0.4) / 0.25, 2));
}

inline dynamics::Model heave_model(const std::filesystem::path& folder) {
    std::string table = "gap [m], lift_force [N]\n";
    for (int k = 0; k <= 200; ++k) {
        const double h = 0.001 * std::pow(1600.0, k / 200.0);
        table += core::format_number(h, 9) + ", " + core::format_number(lift_of(h), 9) + "\n";
    }
    core::write_file(folder / "lift.csv", table);
    core::write_file(folder / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\nnet_weight = \"0.03 "
                     "N\"\n[drag.heave]\nlinear = \"0.02 N s/m\"\n"
                     "quadratic = \"6 N s^2/m^2\"\n[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
    return dynamics::read_model(folder / "model.toml");
}

/// What else the simulated rig of `heave_runs` is like.
struct HeaveRig {
    double seconds = 30;
    double noise = 2e-4;      ///< m, of a gap reading; declared so
    bool velocity = false;    ///< measured too, with a noise of 1 mm/s
    bool continuous = false;  ///< the controller follows motion and a waving set point between the samples instead of
                              ///< holding its force from step to step
    std::function<double(double)> felt = [](double u) { return u; };  ///< what the body feels of a commanded force
};

/// Heave runs under a controller's force; `extra(t, h, w)` is what the model lacks, N.
inline dynamics::Measurements heave_runs(const std::function<double(double, double, double)>& extra, int runs,
                                         double rate, std::uint64_t seed, const HeaveRig& rig = {}) {
    dynamics::Measurements data;
    data.noise["gap"] = rig.noise;
    for (int r = 0; r < runs; ++r) {
        core::Random random(seed, static_cast<std::uint64_t>(r));
        double h = 0.06 + 0.1 * random.uniform(), w = 0, target = h, next = 3;
        std::vector<double> time, gap, velocity, input;
        const double dt = 1 / rate;
        const int sub = std::max(1, static_cast<int>(dt / 0.004 + 0.5));
        for (int k = 0; k < rig.seconds * rate; ++k) {
            const double t = k * dt;
            if (t >= next) {
                target = 0.05 + 0.2 * random.uniform();
                next = t + 3 + 5 * random.uniform();
            }
            const auto controlled = [&](double hh, double ww, double tt) {
                const double wanted = rig.continuous ? 0.15 + 0.08 * std::sin(0.4 * tt + r) : target;
                return 0.03 - lift_of(hh) + 0.5 * (wanted - hh) - 1.2 * ww + 0.004 * std::sin(1.7 * tt + r);
            };
            const double u = controlled(h, w, t);
            time.push_back(t);
            gap.push_back(h + rig.noise * random.normal());
            if (rig.velocity) {
                velocity.push_back(w + 1e-3 * random.normal());
            }
            input.push_back(u);
            for (int s = 0; s < sub; ++s) {
                const double step = dt / sub;
                const auto a = [&](double hh, double ww, double tt) {
                    return (lift_of(hh) - 0.03 + rig.felt(rig.continuous ? controlled(hh, ww, tt) : u) - 0.02 * ww -
                            6 * ww * std::abs(ww) + extra(tt, hh, ww)) /
                           3.954;
                };
                const double a1 = a(h, w, t + s * step);
                const double hm = h + 0.5 * step * w, wm = w + 0.5 * step * a1;
                w += step * a(hm, wm, t + (s + 0.5) * step);
                h += step * wm;
            }
        }
        dynamics::MeasuredRun run;
        run.name = "run-" + std::to_string(r + 1);
        run.table.source = run.name + ".csv";
        run.table.add_numbers("time", "s", time);
        run.table.add_numbers("gap", "m", gap);
        run.table.add_numbers("input_force", "N", input);
        if (rig.velocity) {
            run.table.add_numbers("heave_velocity", "m/s", velocity);
        }
        data.runs.push_back(std::move(run));
    }
    return data;
}

inline std::string written(double value) { return core::format_number(value, 9); }

/// A load-cell bench in a folder: model.toml, dataset.toml, bench.csv. `measured(gap, voltage)` is the true force.
inline void write_bench(const std::filesystem::path& folder, const std::function<double(double, double)>& measured,
                        std::uint64_t seed) {
    heave_model(folder);
    core::write_file(folder / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\n[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n"
                     "scale.jet_voltage = { reference = \"10 V\", exponent = 2 }\n");
    std::string rows = "time [s], gap [mm], jet_voltage [V], approach_direction [1], lift_force [N]\n";
    core::Random random(seed);
    int k = 0;
    for (int v = 4; v <= 12; v += 2) {
        for (const int direction : {1, -1}) {
            for (const double gap : {2.0, 5.0, 10.0, 20.0, 40.0, 70.0, 100.0, 200.0, 400.0}) {
                rows += written(60.0 * k++) + ", " + written(gap) + ", " + written(v) + ", " + written(direction) +
                        ", " + written(measured(gap / 1000, v) + 1e-3 * random.normal()) + "\n";
            }
        }
    }
    core::write_file(folder / "bench.csv", rows);
    core::write_file(folder / "dataset.toml",
                     "kind = \"static\"\ntitle = \"test bench\"\n[noise]\nlift_force = \"0.001 N\"\n[[run]]\nfile = "
                     "\"bench.csv\"\n");
}

}  // namespace underbody::test
