// A simulated rig in heave and pitch, with equations and an integrator of its own, whose controller is fed the noisy
// reading.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::test {

/// What the declared tables hold: lift (N) and nose-up moment about the base's centre (N m).
inline double pitch_rig_lift(double h, double pitch) {
    return -0.04 * std::exp(-std::pow((h - 0.03) / 0.06, 2)) + 0.008 * std::exp(-std::pow((h - 0.4) / 0.25, 2)) +
           0.05 * pitch * std::exp(-h / 0.15);
}
inline double pitch_rig_moment(double h, double pitch) {
    return -0.03 * pitch * (1 + 0.5 * std::exp(-h / 0.1)) + 0.0006 * std::exp(-h / 0.1);
}

struct PitchBody {
    double mass = 3.954, inertia = 0.007364, depth = 0.05, weight = 0.03;
    double heave_linear = 0.05, heave_quadratic = 6, pitch_linear = 0.004, pitch_quadratic = 0.01;
};

/// tables.csv: lift and moment over gap and pitch.
inline void write_pitch_tables(const std::filesystem::path& folder) {
    std::string table = "gap [m], pitch [rad], lift_force [N], pitch_moment [N m]\n";
    for (int k = 0; k <= 60; ++k) {
        const double h = 0.02 + 0.6 * std::pow(k / 60.0, 2);
        for (int j = -10; j <= 10; ++j) {
            const double pitch = 0.03 * j;
            table += core::format_number(h, 9) + ", " + core::format_number(pitch, 9) + ", " +
                     core::format_number(pitch_rig_lift(h, pitch), 9) + ", " +
                     core::format_number(pitch_rig_moment(h, pitch), 9) + "\n";
        }
    }
    core::write_file(folder / "tables.csv", table);
}

/// The declared model in a folder: model.toml and tables.csv.
inline dynamics::Model pitch_rig_model(const std::filesystem::path& folder) {
    write_pitch_tables(folder);
    core::write_file(folder / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\nnet_weight = \"0.03 N\"\n"
                     "pitch_inertia = \"0.006855 kg m^2\"\nadded_inertia_pitch = \"0.000509 kg m^2\"\n"
                     "base_depth = \"50 mm\"\nbase_half_length = \"70 mm\"\nbuoyancy_height = \"0 mm\"\n"
                     "[drag.heave]\nlinear = \"0.05 N s/m\"\nquadratic = \"6 N s^2/m^2\"\n"
                     "[drag.pitch]\nlinear = \"0.004 N m s\"\nquadratic = \"0.01 N m s^2\"\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"tables.csv\"\n"
                     "[[force]]\nquantity = \"pitch_moment\"\ntable = \"tables.csv\"\n");
    return dynamics::read_model(folder / "model.toml");
}

/// The moving rig at a moment.
struct PitchMoment {
    double t, gap, rise, pitch, rate, input;  ///< rise: of the centre of gravity, m/s
};

struct PitchRig {
    double seconds = 30, frequency = 25;
    double gap_noise = 2e-4, pitch_noise = 5e-4;
    double colour = 0;  ///< correlation of the noise from reading to reading
    double gain = 1;    ///< of the controller
    bool moment_input = true;
    bool velocities = false;  ///< measured too
    std::function<double(const PitchMoment&)> force = {},
                                              moment = {};  ///< what the model lacks, about the centre of gravity
    double added_inertia = 0;
    std::size_t late = 0;                         ///< rows by which the inputs are logged after they acted
    double logged_force = 1, logged_moment = 1;   ///< of the logged inputs over those that acted
    std::function<double(std::size_t run)> zero;  ///< of the gap's sensor, m
    std::function<double(double t)> added_force, added_moment;  ///< to what the controller commands
    std::optional<std::uint64_t> again;  ///< the same starts and set points, with the sensors' noise of this seed
};

/// What is logged of an input that acted.
inline std::vector<double> logged(const std::vector<double>& acted, std::size_t late, double factor) {
    std::vector<double> out;
    for (std::size_t k = 0; k < acted.size(); ++k) {
        out.push_back(factor * acted[k >= late ? k - late : 0]);
    }
    return out;
}

inline dynamics::Measurements pitch_rig_runs(const PitchRig& rig, int runs, std::uint64_t seed) {
    const PitchBody body;
    dynamics::Measurements data;
    data.motion = "heave_pitch";
    data.noise["gap"] = rig.gap_noise;
    data.noise["pitch"] = rig.pitch_noise;
    for (int r = 0; r < runs; ++r) {
        core::Random random(seed, static_cast<std::uint64_t>(r)),
            other(rig.again.value_or(0), static_cast<std::uint64_t>(r));
        const auto normal = [&] {
            const double own = random.normal();
            return rig.again ? other.normal() : own;
        };
        double y[4] = {0.1 + 0.08 * random.uniform(), 0, 0.06 * (random.uniform() - 0.5), 0};  // gap, rise, pitch, rate
        double target = y[0], lean = 0, next = 2, gap_slow = 0, pitch_slow = 0, before = y[0], before_pitch = y[2];
        const double phase = 6 * random.uniform(), dt = 1 / rig.frequency;
        std::vector<double> time, gap, pitch, input, turning, velocity, turn_rate;
        for (int k = 0; k < rig.seconds * rig.frequency; ++k) {
            const double t = k * dt;
            if (t >= next) {
                target = 0.09 + 0.16 * random.uniform();
                lean = 0.16 * (random.uniform() - 0.5);
                next = t + 2 + 3 * random.uniform();
            }
            const auto coloured = [&](double& slow, double sigma) {
                slow = rig.colour * slow + std::sqrt(1 - rig.colour * rig.colour) * normal();
                return sigma * slow;
            };
            const double zero = rig.zero ? rig.zero(static_cast<std::size_t>(r)) : 0;
            const double read_gap = y[0] + zero + coloured(gap_slow, rig.gap_noise);
            const double read_pitch = y[2] + coloured(pitch_slow, rig.pitch_noise);
            // a slow estimate of the rates out of the noisy readings, as a controller makes it
            const double rate_gap = (read_gap - before) / dt, rate_pitch = (read_pitch - before_pitch) / dt;
            before += 0.15 * (read_gap - before);
            before_pitch += 0.15 * (read_pitch - before_pitch);
            const double u = body.weight + rig.gain * (0.5 * (target - read_gap) - 0.15 * rate_gap * dt / 0.04) +
                             0.004 * std::sin(1.7 * t + phase) + (rig.added_force ? rig.added_force(t) : 0);
            const double m = rig.moment_input ? rig.gain * (0.03 * (lean - read_pitch) - 2e-4 * rate_pitch) +
                                                    (rig.added_moment ? rig.added_moment(t) : 0)
                                              : 0;
            time.push_back(t);
            gap.push_back(read_gap);
            pitch.push_back(read_pitch);
            input.push_back(u);
            turning.push_back(m);
            const double reach = body.depth * std::sin(y[2]);
            velocity.push_back(y[1] + reach * y[3] + 1e-3 * normal());
            turn_rate.push_back(y[3] + 2e-3 * normal());
            const auto rates = [&](double tt, const double* s, double* d) {
                const PitchMoment now{tt, s[0], s[1], s[2], s[3], u};
                const double a = body.depth * std::sin(s[2]), lift = pitch_rig_lift(s[0], s[2]);
                const double force = lift - body.weight + u -
                                     (body.heave_linear + body.heave_quadratic * std::abs(s[1])) * s[1] +
                                     (rig.force ? rig.force(now) : 0);
                const double moment = pitch_rig_moment(s[0], s[2]) + a * lift + m -
                                      (body.pitch_linear + body.pitch_quadratic * std::abs(s[3])) * s[3] +
                                      (rig.moment ? rig.moment(now) : 0);  // buoyancy acts at the centre of gravity
                d[0] = s[1] + a * s[3];
                d[1] = force / body.mass;
                d[2] = s[3];
                d[3] = moment / (body.inertia + rig.added_inertia);
            };
            const int parts = 8;
            for (int p = 0; p < parts; ++p) {
                const double step = dt / parts, at = t + p * step;
                double k1[4], k2[4], k3[4], k4[4], s[4];
                rates(at, y, k1);
                for (int i = 0; i < 4; ++i) s[i] = y[i] + 0.5 * step * k1[i];
                rates(at + 0.5 * step, s, k2);
                for (int i = 0; i < 4; ++i) s[i] = y[i] + 0.5 * step * k2[i];
                rates(at + 0.5 * step, s, k3);
                for (int i = 0; i < 4; ++i) s[i] = y[i] + step * k3[i];
                rates(at + step, s, k4);
                for (int i = 0; i < 4; ++i) y[i] += step / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
            }
        }
        dynamics::MeasuredRun run;
        run.name = "run-" + std::to_string(r + 1);
        run.table.source = run.name + ".csv";
        run.table.add_numbers("time", "s", time);
        run.table.add_numbers("gap", "m", gap);
        run.table.add_numbers("pitch", "rad", pitch);
        run.table.add_numbers("input_force", "N", logged(input, rig.late, rig.logged_force));
        if (rig.moment_input) {
            run.table.add_numbers("input_moment", "N m", logged(turning, rig.late, rig.logged_moment));
        }
        if (rig.velocities) {
            run.table.add_numbers("heave_velocity", "m/s", velocity);
            run.table.add_numbers("pitch_rate", "rad/s", turn_rate);
        }
        data.runs.push_back(std::move(run));
    }
    return data;
}

}  // namespace underbody::test
