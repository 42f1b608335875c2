// A simulated body on the ground, driven by three jets, with equations and an integrator of its own, whose controller
// is fed the noisy reading.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::test {

/// Two jets aft beside each other push forward, one in the bow pushes to starboard or back.
struct SurfaceBody {
    double mass_x = 2.4, mass_y = 3.1, inertia = 0.0087, pressed = 1, friction = 0.05;
    double surge_linear = 0.5, surge_quadratic = 4, sway_linear = 1, sway_quadratic = 12, yaw_linear = 0.01,
           yaw_quadratic = 0.02;
    double aft = 0.1, aside = 0.06, bow = 0.1;
};

/// The declared model in a folder: model.toml.
inline dynamics::Model surface_rig_model(const std::filesystem::path& folder) {
    core::write_file(folder / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_surge = \"0.2 kg\"\nadded_mass_sway = \"0.9 kg\"\n"
                     "net_weight = \"1 N\"\nyaw_inertia = \"0.0075 kg m^2\"\nadded_inertia_yaw = \"0.0012 kg m^2\"\n"
                     "[drag.surge]\nlinear = \"0.5 N s/m\"\nquadratic = \"4 N s^2/m^2\"\n"
                     "[drag.sway]\nlinear = \"1 N s/m\"\nquadratic = \"12 N s^2/m^2\"\n"
                     "[drag.yaw]\nlinear = \"0.01 N m s\"\nquadratic = \"0.02 N m s^2\"\n"
                     "[contact]\nfriction = 0.05\n"
                     "[[jet]]\nname = \"port\"\nposition = [\"-100 mm\", \"-60 mm\", \"0 mm\"]\n"
                     "direction = [1, 0, 0]\nmaximum = \"0.5 N\"\n"
                     "[[jet]]\nname = \"starboard\"\nposition = [\"-100 mm\", \"60 mm\", \"0 mm\"]\n"
                     "direction = [1, 0, 0]\nmaximum = \"0.5 N\"\n"
                     "[[jet]]\nname = \"bow\"\nposition = [\"100 mm\", \"0 mm\", \"0 mm\"]\n"
                     "direction = [0, 1, 0]\nminimum = \"-0.3 N\"\nmaximum = \"0.3 N\"\n");
    return dynamics::read_model(folder / "model.toml");
}

/// The moving rig at a moment: speeds along and across the body, yaw rate, heading.
struct SurfaceMoment {
    double t, speed, across, rate, heading;
};

struct SurfaceRig {
    double seconds = 20, frequency = 25;
    double place_noise = 1e-3, heading_noise = 2e-3;
    double colour = 0;  ///< correlation of the noise from reading to reading
    double gain = 1;    ///< of the controller
    double thrust_gain = 1, jet_angle = 0, more_friction = 0;
    std::function<double(const SurfaceMoment&)> surge = {}, sway = {}, turn = {};  ///< what the model lacks, body axes
};

inline dynamics::Measurements surface_rig_runs(const SurfaceRig& rig, int runs, std::uint64_t seed) {
    using State = std::array<double, 6>;  // X, Y, heading, speed, across, rate
    const SurfaceBody body;
    dynamics::Measurements data;
    data.motion = "surface";
    data.noise["position_x"] = data.noise["position_y"] = rig.place_noise;
    data.noise["heading"] = rig.heading_noise;
    for (int r = 0; r < runs; ++r) {
        core::Random random(seed, static_cast<std::uint64_t>(r));
        State y{0, 0, 6 * random.uniform() - 3, 0.2, 0, 0};
        double course = y[2], push = 0.4, side = 0, next = 1;
        std::array<double, 3> slow{}, before{y[0], y[1], y[2]};
        const double dt = 1 / rig.frequency;
        std::array<std::vector<double>, 3> read, thrust;
        std::vector<double> time;
        for (int k = 0; k < rig.seconds * rig.frequency; ++k) {
            const double t = k * dt;
            if (t >= next) {
                course += 3 * (random.uniform() - 0.5);
                push = 0.25 + 0.5 * random.uniform();
                side = 0.4 * (random.uniform() - 0.5);
                next = t + 1.5 + 2 * random.uniform();
            }
            time.push_back(t);
            for (std::size_t i = 0; i < 3; ++i) {
                slow[i] = rig.colour * slow[i] + std::sqrt(1 - rig.colour * rig.colour) * random.normal();
                read[i].push_back(y[i] + (i < 2 ? rig.place_noise : rig.heading_noise) * slow[i]);
            }
            const double change = (read[2].back() - before[2]) / dt;
            before[2] += 0.15 * (read[2].back() - before[2]);
            const double turning = rig.gain * (0.02 * (course - read[2].back()) - 3e-4 * change);
            const std::array<double, 3> acts{std::clamp(push / 2 + turning / (2 * body.aside), 0.0, 0.5),
                                             std::clamp(push / 2 - turning / (2 * body.aside), 0.0, 0.5),
                                             std::clamp(side, -0.3, 0.3)};
            for (std::size_t j = 0; j < 3; ++j) {
                thrust[j].push_back(acts[j]);
            }
            const auto rates = [&](double tt, const State& s) {
                const SurfaceMoment now{tt, s[3], s[4], s[5], s[2]};
                const double ahead = rig.thrust_gain * (acts[0] + acts[1]), bow = rig.thrust_gain * acts[2];
                const double c = std::cos(rig.jet_angle), d = std::sin(rig.jet_angle);
                const double grip = (body.friction + rig.more_friction) * body.pressed, slip = std::hypot(s[3], s[4]),
                             rub = slip > 0 ? grip * std::tanh(slip / 1e-3) / slip : 0;
                const double x = c * ahead - d * bow -
                                 (body.surge_linear + body.surge_quadratic * std::abs(s[3])) * s[3] - rub * s[3] +
                                 (rig.surge ? rig.surge(now) : 0);
                const double across = d * ahead + c * bow -
                                      (body.sway_linear + body.sway_quadratic * std::abs(s[4])) * s[4] - rub * s[4] +
                                      (rig.sway ? rig.sway(now) : 0);
                const double left = rig.thrust_gain * acts[0], right = rig.thrust_gain * acts[1];
                const double turn =
                    body.aside * c * (left - right) - body.aft * d * (left + right) + body.bow * c * bow -
                    (body.yaw_linear + body.yaw_quadratic * std::abs(s[5])) * s[5] + (rig.turn ? rig.turn(now) : 0);
                return State{s[3] * std::cos(s[2]) - s[4] * std::sin(s[2]),
                             s[3] * std::sin(s[2]) + s[4] * std::cos(s[2]),
                             s[5],
                             (x + body.mass_y * s[5] * s[4]) / body.mass_x,
                             (across - body.mass_x * s[5] * s[3]) / body.mass_y,
                             (turn + (body.mass_x - body.mass_y) * s[3] * s[4]) / body.inertia};
            };
            constexpr int parts = 16;  // the middle of each part: second order, 1e-7 of the motion
            const double step = dt / parts;
            for (int p = 0; p < parts; ++p) {
                const State begin = rates(t + p * step, y);
                State middle = y;
                for (std::size_t i = 0; i < 6; ++i) {
                    middle[i] += 0.5 * step * begin[i];
                }
                const State slope = rates(t + (p + 0.5) * step, middle);
                for (std::size_t i = 0; i < 6; ++i) {
                    y[i] += step * slope[i];
                }
            }
        }
        dynamics::MeasuredRun run;
        run.name = "run-" + std::to_string(r + 1);
        run.table.source = run.name + ".csv";
        run.table.add_numbers("time", "s", time);
        run.table.add_numbers("position_x", "m", read[0]);
        run.table.add_numbers("position_y", "m", read[1]);
        run.table.add_numbers("heading", "rad", read[2]);
        run.table.add_numbers("thrust_port", "N", thrust[0]);
        run.table.add_numbers("thrust_starboard", "N", thrust[1]);
        run.table.add_numbers("thrust_bow", "N", thrust[2]);
        data.runs.push_back(std::move(run));
    }
    return data;
}

}  // namespace underbody::test
