#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "tests/bench/discovery/plants.h"

namespace underbody::bench {

namespace {

constexpr double mass = 3.954, weight = 0.03, linear = 0.02, quadratic = 6.0, pi = 3.14159265358979;
constexpr double fine = 0.004;  // s, step of the plant (second-order, midpoint)

/// All that a plant may have beyond the declared model, in forms of its own.
struct Extra {
    std::string name;
    double a = 0;  ///< strength
    double b = 0;  ///< a shape, drawn by seed
    double c = 0;
    double form = 0;  ///< 0..1: which form of the law
};

struct Plant {
    std::vector<Extra> extras;
    double lag = 0, input_delay = 0, sensor_delay = 0, bias = 0;

    double inertia(double h, double& slope) const {
        double m = mass;
        slope = 0;
        for (const Extra& e : extras) {
            if (e.name == "added_mass") {
                m += e.a;
            } else if (e.name == "gap_dependent_added_mass" && e.form < 0.5) {
                const double grow = e.a * std::exp(-h / e.b);
                m += grow;
                slope -= grow / e.b;
            } else if (e.name == "gap_dependent_added_mass") {
                const double base = 1 + h / e.b;
                m += e.a * std::pow(base, -1.5);
                slope -= 1.5 * e.a * std::pow(base, -2.5) / e.b;
            }
        }
        return m;
    }

    double force(double t, double h, double w, double u) const {
        double lift = jet_lift(h);
        double relative = w;
        double f = -weight;
        double felt = u;
        for (const Extra& e : extras) {
            const std::string& n = e.name;
            if (n == "ambient_heave_current")
                relative = w - e.a;
            else if (n == "surface_roughness")
                lift *= 1 + e.a * (e.form < 0.5 ? (e.b - h) / (e.b + h) : 2 * std::exp2(-h / e.b) - 1);
            else if (n == "declared_parameter")
                lift *= 1 + e.a;
            else if (n == "constant_force")
                f += e.a;
            else if (n == "coulomb_friction")
                f -= e.a * (1 + 0.3 * e.form * std::exp(-w * w / 1.6e-5)) * std::tanh(w / (4e-4 + 1.2e-3 * e.c));
            else if (n == "linear_damping")
                f -= e.a * w / (1 + 3 * e.form * std::abs(w));
            else if (n == "quadratic_damping")
                f -= e.a * std::copysign(std::pow(std::abs(w), 1.88 + 0.2 * e.form), w);
            else if (n == "squeeze_film_damping")
                f -= e.a * w / std::pow(h + 1e-3 * e.form, 2.8 + 0.3 * e.c);
            else if (n == "tether_stiffness")
                f -= e.a * (h - e.b) * (1 + 0.1 * (h - e.b));
            else if (n == "periodic_disturbance")
                f += e.a * (std::sin(2 * pi * e.b * t + e.c) + 0.08 * std::sin(4 * pi * e.b * t));
            else if (n == "input_gain")
                felt *= 1 + e.a;
            else if (n == "input_dead_zone") {
                const double x = std::abs(felt) / e.a;
                felt = std::copysign(
                    x > 1.6 ? std::abs(felt) - e.a : e.a * 0.6 * std::pow(std::max(0.0, (x - 0.4) / 1.2), 2), felt);
            } else if (n == "bump")
                f += e.a * std::exp(-std::pow((h - e.b) / 0.03, 2));
            else if (n == "wiggle")
                f += e.a * std::sin(w / 0.012 * (1 + e.b));
            else if (n == "cross")
                f += e.a * w * std::sin(h / 0.035);
            else if (n == "warming")
                f += e.a * std::tanh((t - 18 - 10 * e.b) / 4);
            else if (n == "one_sided")
                f -= e.a * std::max(0.0, w) * (1 + 20 * std::max(0.0, w));
            else if (n == "rectifier")
                f += e.a * std::abs(u - 0.035) / 0.03;
            else if (n == "ripple")
                f += e.a * std::sin(h / (0.018 + 0.01 * e.b) + 6 * e.form);
            else if (n == "film_cell")
                f += e.a * w * std::exp(-std::pow((h - 0.1 - 0.08 * e.b) / 0.035, 2));
            else if (n == "above_a_speed")
                f -= e.a * 0.5 * (std::tanh((w - 0.012) / 0.003) + std::tanh((w + 0.012) / 0.003));
            else if (n == "thrust_near_wall")
                f += e.a * (u - 0.03) * std::exp(-std::pow((h - 0.09) / 0.04, 2));
            else if (n == "jump_in_gap")
                f += e.a * std::tanh((h - 0.1 - 0.06 * e.b) / 0.008);
            else if (n == "wavy_floor")
                lift +=
                    jet_lift(std::max(0.004, h + e.a * std::sin(2 * pi * (0.1 + 0.3 * e.b) * t + e.c))) - jet_lift(h);
        }
        const double drag = linear * relative + quadratic * relative * std::abs(relative);
        double slope = 0;
        inertia(h, slope);
        return f + lift + felt - drag - 0.5 * slope * w * w;
    }
};

struct Track {
    std::vector<double> time, gap, velocity, input;  ///< at the sampling times; true gap and velocity
    std::vector<double> sensed, sensed_velocity;     ///< what a perfect reading would be
    std::vector<double> reading;                     ///< as logged, where the controller was fed with it
};

/// The gap sensor of a rig whose controller is fed what is logged.
class Sensor {
public:
    Sensor(const Rig& rig, double step) : rig_(rig), step_(step) {}

    /// True gap after each fine step, oldest first.
    void moved(double gap) { past_.push_back(gap); }

    double reading(double t, double delay, double bias, core::Random& random) {
        const double back = delay / step_;
        const double place = std::max(0.0, static_cast<double>(past_.size() - 1) - back);
        const std::size_t i = std::min(static_cast<std::size_t>(place), past_.size() - 1);
        const double part = place - static_cast<double>(i);
        const double gap = past_[i] + part * (past_[std::min(i + 1, past_.size() - 1)] - past_[i]);
        noise_ = begun_ ? rig_.ar * noise_ + std::sqrt(1 - rig_.ar * rig_.ar) * random.normal() : random.normal();
        begun_ = true;
        double value = gap + bias + 2e-4 * (noise_ + rig_.drift * t / 40);
        value += random.uniform() < rig_.outliers ? 0.02 * (random.uniform() - 0.5) : 0;
        const double step = 2e-4 * rig_.rounding;
        return step > 0 ? step * std::round(value / step) : value;
    }

private:
    const Rig& rig_;
    double step_, noise_ = 0;
    bool begun_ = false;
    std::vector<double> past_;
};

/// One closed-loop run. `style` 0: steps under a soft controller; 1: sines under a stiffer one.
Track one_run(const Plant& plant, const Rig& rig, double rate, double seconds, int style, core::Random& random) {
    const double dt = 1 / rate;
    const int sub = std::max(1, static_cast<int>(std::lround(dt / fine)));
    const double step = dt / sub;
    const double begin = 0.03 + 0.1 * random.uniform() * (1 + random.uniform());
    double h = begin, w = 0, integral = 0, felt = 0, held = 0, lagged = 0;
    double estimate = h, slope = 0;
    std::vector<double> commands;
    const double stiff = (style == 0 ? 0.25 : style == 1 ? 0.7 : 0.45) + (style == 1 ? 0.4 : 0.2) * random.uniform();
    const double damp = 2 * 0.5 * std::sqrt(stiff * mass);
    double phases[6], rates[6];
    for (int k = 0; k < 6; ++k) {
        phases[k] = 2 * pi * random.uniform();
        rates[k] = (style == 0 ? 0.15 : 0.3) * (0.3 + random.uniform()) * (1 + 0.6 * k);
    }
    double target = begin;
    double next_step = 2 + 6 * random.uniform();
    Track track;
    std::vector<double> past_h, past_w;
    // Basset's memory by exponentials, rates a factor of three apart from a period of hours to one of milliseconds;
    // what is faster is a mass
    constexpr int parts = 13;
    constexpr double slowest = 3e-4;  // 1/s
    double memory[parts] = {};
    double history = 0;
    for (const Extra& e : plant.extras) {
        history = e.name == "history_force" ? e.a : history;
    }
    Sensor sensor(rig, step);
    sensor.moved(h);
    // a random force (first order) and a thruster whose command must turn by a play before it follows
    double gust = 0, gust_size = 0, gust_time = 1, play = 0, played = 0, last_seen = h;
    for (const Extra& e : plant.extras) {
        if (e.name == "gusts") {
            gust_size = e.a;
            gust_time = 0.3 + 2.5 * e.b;
            gust = gust_size * random.normal();
        }
        play = e.name == "backlash" ? e.a : play;
    }
    const int samples = static_cast<int>(std::lround(seconds * rate));
    for (int k = 0; k < samples; ++k) {
        const double t = k * dt;
        double reference = target;
        if (style != 1 && t > next_step) {
            target = 0.03 + 0.24 * random.uniform();
            next_step = t + 4 + 7 * random.uniform();
        }
        if (style == 1) {
            reference = 0.14 + 0.09 * std::sin(rates[0] * t + phases[0]) + 0.03 * std::sin(rates[2] * t + phases[2]);
        }
        // an observer of its own, fed by a noisy reading
        double reading = h + 2e-4 * random.normal();
        if (rig.feedback) {
            reading = sensor.reading(t, plant.sensor_delay, plant.bias, random);
            const bool lost = random.uniform() < rig.dropouts;
            track.reading.push_back(lost ? std::nan("") : reading);
            reading = lost ? last_seen : reading;
            last_seen = reading;
        }
        const double innovation = reading - estimate;
        estimate += slope * dt + 0.15 * innovation * dt * 50;
        slope += 0.25 * innovation * dt * 50;
        integral = std::clamp(integral + 0.02 * (reference - estimate) * dt, -0.05, 0.05);
        double u = weight - 0.7 * jet_lift(std::max(estimate, 0.003)) +
                   stiff * std::clamp(reference - estimate, -0.08, 0.08) - damp * slope + integral;
        u += 0.006 * std::sin(rates[4] * 3 * t + phases[4]) + 0.004 * std::sin(rates[5] * 5 * t + phases[5]);
        u = std::clamp(u, -0.2, 0.25);
        commands.push_back(u);
        track.time.push_back(t);
        track.gap.push_back(h);
        track.velocity.push_back(w);
        track.input.push_back(u);
        for (int s = 0; s < sub; ++s) {
            const double now = t + s * step;
            const double late = now + 0.5 * step - plant.input_delay;
            const int index = std::clamp(static_cast<int>(std::floor(late / dt + 1e-9)), 0, k);
            held = commands[static_cast<std::size_t>(index)];
            if (k == 0 && s == 0) {
                lagged = held;
                for (double& m : memory) {
                    m = 0;
                }
            }
            if (play > 0) {
                played = k == 0 && s == 0 ? held : std::clamp(played, held - play, held + play);
                held = played;
            }
            felt = held;
            if (plant.lag > 0) {
                const double rise = 1 - std::exp(-step / plant.lag);
                felt = held + (lagged - held) * rise * plant.lag / step;  // mean over the step
                lagged += (held - lagged) * rise;
            }
            double slope_of_mass = 0;
            const double extra_mass =
                history * std::log(3.0) / std::sqrt(slowest * std::pow(3.0, parts) * pi) / (1 - 1 / std::sqrt(3.0));
            const auto basset = [&](double later, double a) {  // force with the memory that an acceleration leads to
                double sum = 0, rate_of = slowest;
                for (int i = 0; i < parts && history > 0; ++i, rate_of *= 3) {
                    const double decay = std::exp(-rate_of * later);
                    sum -= history * std::log(3.0) * std::sqrt(rate_of / pi) *
                           (memory[i] * decay + a * (1 - decay) / rate_of);
                }
                return sum;
            };
            const auto rates_of = [&](double hh, double ww, double tt, double remembered) {
                const double m = plant.inertia(hh, slope_of_mass) + extra_mass;
                return (plant.force(tt, hh, ww, felt) + gust + remembered) / m;
            };
            const double a1 = rates_of(h, w, now, basset(0, 0));
            const double hm = h + 0.5 * step * w, wm = w + 0.5 * step * a1;
            const double a2 = rates_of(hm, wm, now + 0.5 * step, basset(0.5 * step, a1));
            if (history > 0) {
                double rate_of = slowest;
                for (double& m : memory) {
                    const double decay = std::exp(-rate_of * step);
                    m = m * decay + a2 * (1 - decay) / rate_of;  // integral of a exp(-rate (t-s))
                    rate_of *= 3;
                }
            }
            h += step * wm;
            w += step * a2;
            sensor.moved(h);
            if (gust_size > 0) {
                const double phi = std::exp(-step / gust_time);
                gust = phi * gust + gust_size * std::sqrt(1 - phi * phi) * random.normal();
            }
        }
    }
    track.sensed.resize(track.gap.size());
    for (std::size_t k = 0; k < track.gap.size(); ++k) {
        const double t = track.time[k] - plant.sensor_delay;
        const double place = std::clamp(t / dt, 0.0, static_cast<double>(track.gap.size() - 1));
        const std::size_t i = std::min(static_cast<std::size_t>(place), track.gap.size() - 2);
        const double part = place - static_cast<double>(i);
        track.sensed[k] = track.gap[i] + part * (track.gap[i + 1] - track.gap[i]) + plant.bias;
    }
    return track;
}

/// A run that keeps clear of the ground: the body would touch and the rig's owner would throw the run away. `clear`
/// becomes false where no try does; the last try then.
Track run(const Plant& plant, const Rig& rig, double rate, double seconds, int style, core::Random& random,
          bool& clear) {
    Track track;
    for (int attempt = 0; attempt < 40; ++attempt) {
        track = one_run(plant, rig, rate, seconds, style, random);
        const auto [low, high] = std::minmax_element(track.gap.begin(), track.gap.end());
        if (*low > 0.012 && *high < 0.6) {
            return track;
        }
    }
    clear = false;
    return track;
}

/// RMS error of the declared model over windows of two seconds from the sensed state: the strength of what it lacks.
double declared_error(const std::vector<Track>& tracks) {
    const Plant bare;
    double sum = 0, count = 0;
    for (const Track& track : tracks) {
        const double dt = track.time[1] - track.time[0];
        const int window = static_cast<int>(2 / dt);
        for (int first = static_cast<int>(1 / dt); first + window < static_cast<int>(track.time.size());
             first += window) {
            const auto f = static_cast<std::size_t>(first);
            double h = track.sensed[f], w = (track.sensed[f + 1] - track.sensed[f - 1]) / (2 * dt);
            for (int k = 0; k < window; ++k) {
                const auto i = static_cast<std::size_t>(first + k);
                const double a1 = bare.force(0, h, w, track.input[i]) / mass;
                const double hm = h + 0.5 * dt * w, wm = w + 0.5 * dt * a1;
                const double a2 = bare.force(0, hm, wm, track.input[i]) / mass;
                h += dt * wm;
                w += dt * a2;
                const double d = h - track.sensed[i + 1];
                sum += d * d;
                count += 1;
            }
        }
    }
    return std::sqrt(sum / std::max(count, 1.0));
}

Plant plant_of(const std::vector<std::string>& names, const std::vector<double>& strength,
               const std::vector<double>& shape) {
    Plant plant;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const double a = strength[i], r = shape[i];
        if (names[i] == "input_delay")
            plant.input_delay = std::abs(a);
        else if (names[i] == "actuator_lag")
            plant.lag = std::abs(a);
        else if (names[i] == "gap_sensor_delay")
            plant.sensor_delay = std::abs(a);
        else if (names[i] == "gap_sensor_bias")
            plant.bias = a;
        else if (names[i] == "gap_dependent_added_mass")
            plant.extras.push_back({names[i], std::abs(a), 0.03 + 0.05 * r, 0});
        else if (names[i] == "surface_roughness")
            plant.extras.push_back({names[i], std::abs(a), 0.06 + 0.08 * r, 0});
        else if (names[i] == "tether_stiffness")
            plant.extras.push_back({names[i], std::abs(a), 0.05 + 0.15 * r, 0});
        else if (names[i] == "periodic_disturbance")
            plant.extras.push_back({names[i], std::abs(a), 0.15 + 1.2 * r * r, 6.28 * r});
        else if (names[i] == "bump")
            plant.extras.push_back({names[i], a, 0.06 + 0.12 * r, 0});
        else if (names[i] == "constant_force" || names[i] == "ambient_heave_current" || names[i] == "added_mass" ||
                 names[i] == "input_gain" || names[i] == "declared_parameter")
            plant.extras.push_back({names[i], a, r, 0});
        else
            plant.extras.push_back({names[i], std::abs(a), r, 0});
    }
    for (std::size_t i = 0; i < plant.extras.size(); ++i) {
        plant.extras[i].form = std::fmod(7.31 * shape.front() + 0.37 * static_cast<double>(i), 1.0);
        if (plant.extras[i].c == 0) {
            plant.extras[i].c = std::fmod(13.7 * shape.front() + 0.11, 1.0);
        }
    }
    return plant;
}

/// Whether the catalogue's first number means what the plant's strength does: the same law in the same terms.
bool means_the_same(const std::string& name) {
    return name == "constant_force" || name == "added_mass" || name == "input_gain" || name == "input_delay" ||
           name == "actuator_lag" || name == "gap_sensor_delay" || name == "gap_sensor_bias" ||
           name == "ambient_heave_current" || name == "declared_parameter" || name == "periodic_disturbance" ||
           name == "coulomb_friction";
}

core::Table table_of(const Track& track, const Case& wanted, core::Random& random) {
    std::vector<double> gap, velocity;
    double slow = 0;
    const double dt = track.time[1] - track.time[0];
    const double phi = std::exp(-dt / 0.3);
    // white noise per reading is given at 50 Hz; a faster logger reads with the same white noise
    for (std::size_t k = 0; k < track.time.size(); ++k) {
        slow = k == 0 ? random.normal() : phi * slow + std::sqrt(1 - phi * phi) * random.normal();
        const double noise = wanted.coloured ? 0.7 * random.normal() + 0.7 * slow : random.normal();
        gap.push_back(track.reading.empty() ? track.sensed[k] + 2e-4 * noise : track.reading[k]);
        velocity.push_back(track.velocity[k] + 1e-3 * random.normal());
    }
    core::Table table;
    table.source = "bench";
    table.add_numbers("time", "s", track.time);
    table.add_numbers("gap", "m", gap);
    if (wanted.velocity) {
        table.add_numbers("heave_velocity", "m/s", velocity);
    }
    table.add_numbers("input_force", "N", track.input);
    return table;
}

}  // namespace

double jet_lift(double h) {
    return 0.05 * std::exp(-h / 0.003) - 0.038 * std::exp(-std::pow((h - 0.026) / 0.055, 2)) +
           0.0082 * std::exp(-std::pow((h - 0.46) / 0.24, 2));
}

namespace {

/// `clear`: every run keeps clear of the ground, and no strength is beyond what its effect can be.
Sample draw_heave(const Case& wanted, bool& clear) {
    const std::uint64_t seed = wanted.seed + (wanted.draw << 32);
    core::Random random(seed * 7919 + 17);
    std::vector<std::string> laws = wanted.names;
    if (laws == std::vector<std::string>{"unknown"}) {
        laws = {wanted.law};
    }
    if (wanted.rig.gusts > 0) {
        laws.emplace_back("gusts");
    }
    std::vector<double> strength(laws.size()), shape(laws.size());
    for (std::size_t i = 0; i < laws.size(); ++i) {
        const double sign = random.uniform() < 0.5 ? -1 : 1;
        shape[i] = random.uniform();
        strength[i] = sign * 1e-4;
        const double target = 2e-4 * (laws[i] == "gusts" ? wanted.rig.gusts : wanted.level);
        if (laws[i] == "tether_stiffness" && wanted.strong) {
            strength[i] = 1.5 + 4.5 * random.uniform();
            shape[i] = -0.24 + 0.2 * random.uniform();  // pulls towards 2 to 32 mm
            continue;
        }
        if (laws[i].find("delay") != std::string::npos || laws[i] == "actuator_lag" || laws[i] == "added_mass" ||
            laws[i] == "gap_dependent_added_mass" || laws[i] == "linear_damping" || laws[i] == "declared_parameter" ||
            laws[i] == "input_gain" || laws[i] == "surface_roughness") {
            strength[i] = sign * 0.02;
        } else if (laws[i] == "quadratic_damping" || laws[i] == "one_sided" || laws[i] == "cross" ||
                   laws[i] == "film_cell" || laws[i] == "thrust_near_wall" || laws[i] == "history_force") {
            strength[i] = sign * 0.3;
        } else if (laws[i] == "wavy_floor" || laws[i] == "backlash") {
            strength[i] = 5e-4;
        } else if (laws[i] == "squeeze_film_damping") {
            strength[i] = sign * 3e-6;
        } else if (laws[i] == "input_dead_zone") {
            strength[i] = 0.004;
        }
        // each alone to its level: the response is nearly linear in the strength, a few secant steps do
        for (int round = 0; round < 4; ++round) {
            std::vector<Track> probe;
            for (int k = 0; k < 3; ++k) {
                core::Random own(seed * 31 + 5, static_cast<std::uint64_t>(k));
                bool any = true;  // a first guess may be far too strong
                probe.push_back(run(plant_of({laws[i]}, {strength[i]}, {shape[i]}), {}, 50, 40, 0, own, any));
            }
            const double error = declared_error(probe);
            strength[i] *= std::clamp(target / std::max(error, 1e-9), 0.02, 50.0);
        }
    }
    for (std::size_t i = 0; i < laws.size(); ++i) {
        // beyond it the lift far from a rough ground would change its sign
        clear = clear && !(laws[i] == "surface_roughness" && std::abs(strength[i]) > 1);
    }
    const Plant plant = plant_of(laws, strength, shape);
    Sample sample;
    sample.names = wanted.names;
    sample.in_catalogue_terms = std::nan("");
    if (wanted.rig.drift != 0) {
        sample.names = {"gap_sensor_drift"};
        sample.depends_on = {"time"};
        sample.also = {{"gap_sensor_bias"}, {"unknown"}};
    } else if (wanted.rig.gusts > 0 && wanted.names.empty()) {
        sample.also = {{"none"}, {"random_disturbance"}, {"unknown"}};
    } else if (wanted.law == "backlash" || wanted.law == "wavy_floor" || wanted.law == "thrust_near_wall") {
        sample.also = {{wanted.law == "thrust_near_wall" ? "thrust_by_gap" : wanted.law}};
    }
    if (laws.size() == 1 && means_the_same(laws.front())) {
        sample.in_catalogue_terms = plant.lag + plant.input_delay + plant.sensor_delay + plant.bias +
                                    (plant.extras.empty() ? 0 : plant.extras.front().a) +
                                    (laws.front() == "input_gain" || laws.front() == "declared_parameter" ? 1 : 0);
    }
    if (!wanted.names.empty() && wanted.names.front() == "unknown") {
        sample.depends_on =
            wanted.law == "bump" || wanted.law == "ripple" || wanted.law == "jump_in_gap"
                ? std::vector<std::string>{"gap"}
            : wanted.law == "thrust_near_wall"                      ? std::vector<std::string>{"gap", "input_force"}
            : wanted.law == "cross" || wanted.law == "film_cell"    ? std::vector<std::string>{"gap", "heave_velocity"}
            : wanted.law == "warming"                               ? std::vector<std::string>{"time"}
            : wanted.law == "wavy_floor"                            ? std::vector<std::string>{"gap", "time"}
            : wanted.law == "rectifier" || wanted.law == "backlash" ? std::vector<std::string>{"input_force"}
                                                                    : std::vector<std::string>{"heave_velocity"};
        sample.missing = [plant](double t, double h, double w, double u) {
            return plant.force(t, h, w, u) - Plant().force(t, h, w, u);
        };
    }
    for (const int style : {0, 1, 2}) {
        if (style == 2 && !wanted.fresh) {
            break;
        }
        dynamics::Measurements& data = style == 0 ? sample.train : style == 1 ? sample.test : sample.fresh;
        data.kind = dynamics::MeasurementKind::time_series;
        data.title = wanted.text();
        if (wanted.declared_noise > 0) {
            data.noise["gap"] = 2e-4 * wanted.declared_noise;
            if (wanted.velocity) {
                data.noise["heave_velocity"] = 1e-3 * wanted.declared_noise;
            }
        }
        for (int k = 0; k < (style == 0 ? wanted.runs : style == 1 ? wanted.held_out : 4); ++k) {
            core::Random own(seed * 101 + static_cast<std::uint64_t>(style) * 17, static_cast<std::uint64_t>(k));
            dynamics::MeasuredRun one;
            one.name = (style == 0 ? "run-" : style == 1 ? "test-" : "fresh-") + std::to_string(k + 1);
            one.table = table_of(run(plant, wanted.rig, wanted.rate, wanted.seconds, style, own, clear), wanted, own);
            one.use = style == 0 ? dynamics::RunUse::train : dynamics::RunUse::test;
            data.runs.push_back(std::move(one));
        }
    }
    return sample;
}

}  // namespace

Sample make_heave(const Case& wanted) {
    constexpr std::uint64_t draws = 20, apart = 1000000;
    Case drawn = wanted;
    for (std::uint64_t draw = 0; draw < draws; ++draw) {
        drawn.seed = wanted.seed + draw * apart;
        bool clear = true;
        Sample sample = draw_heave(drawn, clear);
        if (clear) {
            return sample;
        }
    }
    throw core::InputError("range", "no draw of '" + wanted.text() + "' keeps its runs clear of the ground", {}, {});
}

}  // namespace underbody::bench
