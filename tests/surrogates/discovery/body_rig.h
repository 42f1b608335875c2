// A simulated vehicle off the ground, driven by five jets, with equations and an integrator of its own (six speeds, the
// moment that holds the roll as a multiplier), whose controller is fed the noisy reading.
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
#include "pitch_rig.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::test {

/// The declared model in a folder: model.toml and tables.csv. Two jets aft push forward, one in the bow to starboard or
/// back, one ahead and one astern of the middle up or down.
inline dynamics::Model body_rig_model(const std::filesystem::path& folder) {
    write_pitch_tables(folder);
    core::write_file(folder / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_surge = \"0.2 kg\"\nadded_mass_sway = \"0.9 kg\"\n"
                     "added_mass_heave = \"1.7 kg\"\nnet_weight = \"0.05 N\"\nroll_inertia = \"0.006 kg m^2\"\n"
                     "pitch_inertia = \"0.007 kg m^2\"\nadded_inertia_pitch = \"0.002 kg m^2\"\n"
                     "yaw_inertia = \"0.0075 kg m^2\"\nadded_inertia_yaw = \"0.0012 kg m^2\"\n"
                     "base_depth = \"50 mm\"\nbase_half_length = \"70 mm\"\nbuoyancy_height = \"4 mm\"\n"
                     "[drag.surge]\nlinear = \"0.5 N s/m\"\nquadratic = \"4 N s^2/m^2\"\n"
                     "[drag.sway]\nlinear = \"1 N s/m\"\nquadratic = \"12 N s^2/m^2\"\n"
                     "[drag.heave]\nlinear = \"0.3 N s/m\"\nquadratic = \"6 N s^2/m^2\"\n"
                     "[drag.pitch]\nlinear = \"0.012 N m s\"\nquadratic = \"0.02 N m s^2\"\n"
                     "[drag.yaw]\nlinear = \"0.01 N m s\"\nquadratic = \"0.02 N m s^2\"\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"tables.csv\"\n"
                     "[[force]]\nquantity = \"pitch_moment\"\ntable = \"tables.csv\"\n"
                     "[[jet]]\nname = \"port\"\nposition = [\"-100 mm\", \"-60 mm\", \"0 mm\"]\n"
                     "direction = [1, 0, 0]\nmaximum = \"0.5 N\"\n"
                     "[[jet]]\nname = \"starboard\"\nposition = [\"-100 mm\", \"60 mm\", \"0 mm\"]\n"
                     "direction = [1, 0, 0]\nmaximum = \"0.5 N\"\n"
                     "[[jet]]\nname = \"bow\"\nposition = [\"100 mm\", \"0 mm\", \"0 mm\"]\n"
                     "direction = [0, 1, 0]\nminimum = \"-0.3 N\"\nmaximum = \"0.3 N\"\n"
                     "[[jet]]\nname = \"fore\"\nposition = [\"80 mm\", \"0 mm\", \"0 mm\"]\n"
                     "direction = [0, 0, -1]\nminimum = \"-0.3 N\"\nmaximum = \"0.3 N\"\n"
                     "[[jet]]\nname = \"aft\"\nposition = [\"-80 mm\", \"0 mm\", \"0 mm\"]\n"
                     "direction = [0, 0, -1]\nminimum = \"-0.3 N\"\nmaximum = \"0.3 N\"\n");
    return dynamics::read_model(folder / "model.toml");
}

/// The moving rig at a moment; rates about the body's own axes, `rise` of the base's centre.
struct BodyMoment {
    double t, speed, across, rise, gap, pitch, heading, nose_rate, turn_rate;
};
/// Beside what the model has, about the centre of gravity: along the ground forward, to starboard, up; nose up, bow to
/// starboard.
using BodyLoads = std::array<double, 5>;

struct BodyRig {
    double seconds = 20, frequency = 25;
    double place_noise = 1e-3, gap_noise = 2e-4, pitch_noise = 1e-3, heading_noise = 2e-3;
    double colour = 0;  ///< correlation of the noise from reading to reading
    double thrust_gain = 1, jet_angle = 0;
    double mass_forward = 0, mass_aside = 0;  ///< m, of the centre of gravity
    double lift_factor = 1, added_mass = 0;
    bool linear = false;      ///< thrusts go to the next command by the next sample, as a line
    bool rates_only = false;  ///< speeds and rates logged in the place of the places along the ground and the heading
    std::function<BodyLoads(const BodyMoment&)> missing = {};
};

namespace body_rig {

using Vector = std::array<double, 3>;
/// u, v, w, p, q, r; pitch, heading; X, Y, Z of the centre of gravity.
using State = std::array<double, 11>;

inline Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Body {
    std::array<double, 6> inertia{2.4, 3.1, 3.9, 0.006, 0.009, 0.0087};
    double mass = 2.2, weight = 0.05, depth = 0.05, buoyancy_height = 0.004;
};

/// Six equations of motion and the constraint that the roll stays zero, solved with its multiplier: the roll's rate is
/// p + r tan(pitch).
inline State rates(const BodyRig& rig, const Body& body, const State& s, const std::array<double, 5>& thrust,
                   double t) {
    const double st = std::sin(s[6]), ct = std::cos(s[6]), sp = std::sin(s[7]), cp = std::cos(s[7]);
    const Vector v{s[0], s[1], s[2]}, w{s[3], s[4], s[5]};
    std::array<double, 6> inertia = body.inertia;
    inertia[2] += rig.added_mass;
    const double forward = rig.mass_forward, aside = rig.mass_aside;
    Vector force{}, moment{};
    const auto add = [&](const Vector& at, const Vector& f) {
        const Vector turn = cross({at[0] - forward, at[1] - aside, at[2]}, f);
        for (std::size_t i = 0; i < 3; ++i) {
            force[i] += f[i];
            moment[i] += turn[i];
        }
    };
    const Vector centre{forward, aside, 0};
    const auto level = [&](double along, double up) { return Vector{along * ct + up * st, 0, along * st - up * ct}; };
    const double c = std::cos(rig.jet_angle), d = std::sin(rig.jet_angle), g = rig.thrust_gain;
    add({-0.1, -0.06, 0}, {g * c * thrust[0], g * d * thrust[0], 0});
    add({-0.1, 0.06, 0}, {g * c * thrust[1], g * d * thrust[1], 0});
    add({0.1, 0, 0}, {-g * d * thrust[2], g * c * thrust[2], 0});
    add({0.08, 0, 0}, {0, 0, -g * thrust[3]});
    add({-0.08, 0, 0}, {0, 0, -g * thrust[4]});
    // the base's centre below the declared centre of gravity
    const double down = -s[0] * st + s[2] * ct, gap = -s[10] - forward * st - body.depth * ct;
    const double reach = -forward * ct + body.depth * st, rise = -down + reach * s[4];
    const Vector base{0, 0, body.depth};
    add(base, level(0, rig.lift_factor * pitch_rig_lift(gap, s[6])));
    moment[1] += pitch_rig_moment(gap, s[6]);
    add(centre, level(0, -body.weight));
    const Vector buoyancy = level(0, body.mass * 9.80665 - body.weight),
                 upright = cross({-forward, -aside, -body.buoyancy_height}, buoyancy);
    const auto law = [](double linear, double quadratic, double x) { return -(linear + quadratic * std::abs(x)) * x; };
    add({forward, 0, 0}, {law(0.5, 4, s[0]), 0, 0});
    add(centre, {0, law(1, 12, s[1]), law(0.3, 6, s[2])});
    moment[1] += law(0.012, 0.02, s[4]);
    moment[2] += law(0.01, 0.02, s[5]);
    if (rig.missing) {
        const BodyLoads more = rig.missing({t, s[0] * ct + s[2] * st, s[1], rise, gap, s[6], s[7], s[4], s[5]});
        add(centre, level(more[0], more[2]));
        add(centre, {0, more[1], 0});
        moment[1] += more[3];
        moment[2] += more[4];
    }
    const Vector momentum{inertia[0] * v[0], inertia[1] * v[1], inertia[2] * v[2]},
        spin{inertia[3] * w[0], inertia[4] * w[1], inertia[5] * w[2]};
    const Vector swept = cross(w, momentum), gyration = cross(w, spin), munk = cross(v, momentum);
    Vector rest{};
    State rate{};
    for (std::size_t i = 0; i < 3; ++i) {
        rate[i] = (force[i] - swept[i]) / inertia[i];
        rest[i] = moment[i] + upright[i] - gyration[i] - munk[i];
    }
    // inertia times turning = rest + hold (1, 0, tan), turning_x + tan turning_z = -q r/cos^2
    const double tangent = st / ct, wanted = -s[4] * s[5] / (ct * ct);
    const double hold = (wanted - rest[0] / inertia[3] - tangent * rest[2] / inertia[5]) /
                        (1 / inertia[3] + tangent * tangent / inertia[5]);
    rate[3] = (rest[0] + hold) / inertia[3];
    rate[4] = rest[1] / inertia[4];
    rate[5] = (rest[2] + hold * tangent) / inertia[5];
    rate[6] = s[4];
    rate[7] = s[5] / ct;
    const double along = s[0] * ct + s[2] * st;
    rate[8] = along * cp - s[1] * sp;
    rate[9] = along * sp + s[1] * cp;
    rate[10] = down;
    return rate;
}

inline void step(const BodyRig& rig, const Body& body, State& y, const std::array<double, 5>& thrust, double t,
                 double h) {
    const auto moved = [&](const State& d, double by) {
        State s = y;
        for (std::size_t i = 0; i < s.size(); ++i) {
            s[i] += by * d[i];
        }
        return s;
    };
    const State k1 = rates(rig, body, y, thrust, t), k2 = rates(rig, body, moved(k1, h / 2), thrust, t + h / 2),
                k3 = rates(rig, body, moved(k2, h / 2), thrust, t + h / 2),
                k4 = rates(rig, body, moved(k3, h), thrust, t + h);
    for (std::size_t i = 0; i < y.size(); ++i) {
        y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
}

/// What a tracker reads: places of the declared centre of gravity, gap, pitch, heading.
inline std::array<double, 5> seen(const BodyRig& rig, const Body& body, const State& s) {
    const double st = std::sin(s[6]), ct = std::cos(s[6]), sp = std::sin(s[7]), cp = std::cos(s[7]),
                 ahead = -rig.mass_forward * ct;
    return {s[8] + ahead * cp + rig.mass_aside * sp, s[9] + ahead * sp - rig.mass_aside * cp,
            -s[10] - rig.mass_forward * st - body.depth * ct, s[6], s[7]};
}

inline dynamics::MeasuredRun run(const BodyRig& rig, core::Random& random, const std::string& name) {
    const Body body;
    State y{0.1, 0, 0, 0, 0, 0, 0, 6 * random.uniform() - 3, 0, 0, -0.15 - body.depth};
    const double dt = 1 / rig.frequency;
    const std::array<double, 5> noise{rig.place_noise, rig.place_noise, rig.gap_noise, rig.pitch_noise,
                                      rig.heading_noise};
    std::array<double, 5> slow{}, before = seen(rig, body, y), acted{};
    std::array<std::vector<double>, 5> read, thrust, speeds;
    std::vector<double> time;
    double course = y[7], push = 0.3, side = 0, height = before[2], lean = 0, next = 1;
    for (int k = 0; k < rig.seconds * rig.frequency; ++k) {
        const double t = k * dt;
        if (t >= next) {
            course += 3 * (random.uniform() - 0.5);
            push = 0.15 + 0.5 * random.uniform();
            side = 0.4 * (random.uniform() - 0.5);
            height = 0.1 + 0.15 * random.uniform();
            lean = 0.16 * (random.uniform() - 0.5);
            next = t + 1.5 + 2 * random.uniform();
        }
        time.push_back(t);
        const std::array<double, 5> place = seen(rig, body, y);
        std::array<double, 5> rate{};
        for (std::size_t i = 0; i < 5; ++i) {
            slow[i] = rig.colour * slow[i] + std::sqrt(1 - rig.colour * rig.colour) * random.normal();
            read[i].push_back(place[i] + noise[i] * slow[i]);
            rate[i] = (read[i].back() - before[i]) / dt;
            before[i] += 0.15 * (read[i].back() - before[i]);
        }
        const double st = std::sin(y[6]), ct = std::cos(y[6]);
        const std::array<double, 5> own{
            y[0] * ct + y[2] * st + rig.mass_aside * y[5] / ct + rig.mass_forward * y[4] * st,
            y[1] - rig.mass_forward * y[5], y[0] * st - y[2] * ct + (body.depth * st - rig.mass_forward * ct) * y[4],
            y[4], y[5]};
        const std::array<double, 5> rate_noise{0.005, 0.005, 0.002, 0.005, 0.005};
        for (std::size_t i = 0; i < 5; ++i) {
            speeds[i].push_back(own[i] + rate_noise[i] * random.normal());
        }
        const double turning = 0.02 * (course - read[4].back()) - 3e-4 * rate[4],
                     up = 0.05 + 0.5 * (height - read[2].back()) - 0.15 * rate[2],
                     nose_up = 0.03 * (lean - read[3].back()) - 2e-4 * rate[3];
        const std::array<double, 5> acts{std::clamp(push / 2 + turning / 0.12, 0.0, 0.5),
                                         std::clamp(push / 2 - turning / 0.12, 0.0, 0.5), std::clamp(side, -0.3, 0.3),
                                         std::clamp(up / 2 + nose_up / 0.16, -0.3, 0.3),
                                         std::clamp(up / 2 - nose_up / 0.16, -0.3, 0.3)};
        constexpr int parts = 8;
        const std::array<double, 5> from = rig.linear && k > 0 ? acted : acts;
        acted = acts;
        for (std::size_t j = 0; j < 5; ++j) {
            thrust[j].push_back(from[j]);
        }
        for (int p = 0; p < parts; ++p) {
            std::array<double, 5> now{};
            for (std::size_t j = 0; j < 5; ++j) {
                now[j] = from[j] + (p + 0.5) / parts * (acts[j] - from[j]);
            }
            step(rig, body, y, now, t + p * dt / parts, dt / parts);
        }
    }
    dynamics::MeasuredRun out;
    out.name = name;
    out.table.source = name + ".csv";
    out.table.add_numbers("time", "s", time);
    constexpr std::array<const char*, 5> places{"position_x", "position_y", "gap", "pitch", "heading"},
        rates{"speed", "sway_velocity", "heave_velocity", "pitch_rate", "yaw_rate"},
        jets{"thrust_port", "thrust_starboard", "thrust_bow", "thrust_fore", "thrust_aft"};
    for (std::size_t i = 0; i < 5; ++i) {
        if (!rig.rates_only || i == 2 || i == 3) {
            out.table.add_numbers(places[i], i < 3 ? "m" : "rad", read[i]);
        }
        if (rig.rates_only) {
            out.table.add_numbers(rates[i], i < 3 ? "m/s" : "rad/s", speeds[i]);
        }
        out.table.add_numbers(jets[i], "N", thrust[i]);
    }
    return out;
}

}  // namespace body_rig

inline dynamics::Measurements body_rig_runs(const BodyRig& rig, int runs, std::uint64_t seed) {
    dynamics::Measurements data;
    data.motion = "body";
    data.noise = {{"gap", rig.gap_noise}, {"pitch", rig.pitch_noise}};
    if (!rig.rates_only) {
        data.noise["position_x"] = data.noise["position_y"] = rig.place_noise;
        data.noise["heading"] = rig.heading_noise;
    }
    for (int r = 0; r < runs; ++r) {
        core::Random random(seed, static_cast<std::uint64_t>(r));
        data.runs.push_back(body_rig::run(rig, random, "run-" + std::to_string(r + 1)));
    }
    return data;
}

}  // namespace underbody::test
