#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "tests/bench/discovery/plants.h"

namespace underbody::bench {

namespace {

struct Point {
    double gap = 0, speed = 0, voltage = 0, temperature = 0, time = 0, direction = 0;
};

struct Forces {
    double lift = 0, drag = 0;
};

double viscosity(double kelvin) {
    // Vogel's law, another fit than the program's
    return 0.02939e-3 * std::exp(507.88 / (kelvin - 149.3));
}

Forces declared(const Case& wanted, const Point& p) {
    if (wanted.family == "jet") {
        return {jet_lift(p.gap) * p.voltage * p.voltage / 100, 0};
    }
    const double s = p.speed * p.speed / 0.25;
    return {glide_lift(p.gap) * s, glide_drag(p.gap) * s};
}

/// The plant with one effect of strength a, shape r; `mode` 0: lift only, 1: both.
Forces with(const Case& wanted, const std::string& law, double a, double r, int mode, Point p) {
    const Point set = p;
    if (law == "gap_offset") p.gap = std::max(2e-4, p.gap + a);
    if (law == "current") p.speed += a;
    if (law == "pump_curve") {
        if (r < 0.5) {
            p.voltage = std::max(0.0, p.voltage - std::abs(a)) * 10 / (10 - std::abs(a));
        } else {
            const double x = p.voltage / 10;
            p.voltage = 10 * x * std::pow((1 + std::abs(a)) / (1 + std::abs(a) * x * x * x), 0.5);
        }
    }
    Forces f = declared(wanted, p);
    const auto scale = [&](double factor) {
        f.lift *= factor;
        f.drag *= mode == 1 ? factor : 1;
    };
    const auto add = [&](double force) {
        f.lift += force;
        f.drag += mode == 1 ? force : 0;
    };
    if (law == "speed_exponent") {
        f.lift *= std::pow(p.speed / 0.5, a);
        f.drag *= std::pow(p.speed / 0.5, a);
    }
    if (law == "temperature") {
        const double ratio = std::pow(viscosity(p.temperature) / viscosity(293.15), a);
        f.lift *= ratio;
        f.drag *= ratio;
    }
    if (law == "sensor_gain") scale(1 + a);
    if (law == "force_bias") add(a);
    if (law == "drift") add(a * set.time / 3600);
    if (law == "strut_buoyancy" || law == "cable_buoyancy") f.lift += a * (set.gap - 0.05 * r);
    if (law == "guide_friction") f.lift += a * set.direction * (1 + 0.1 * std::tanh(set.gap / 0.1));
    if (law == "surface_roughness") {
        const double x = std::log(set.gap / (0.006 + 0.02 * r));
        f.lift *= 1 - std::abs(a) * std::tanh(x);
    }
    if (law == "ring") f.lift += a * std::exp(-std::pow((set.gap - 0.012) / 0.005, 2)) * (wanted.family == "jet" ? set.voltage / 8 : set.speed / 0.5);
    if (law == "hump") f.lift += a * std::exp(-std::pow(std::log(set.gap / 0.01), 2) / 0.3);
    if (law == "resonance") f.lift += a * std::exp(-std::pow((set.speed - 0.6) / 0.1, 2));
    if (law == "diurnal") add(a * std::sin(set.time / 3600 * 1.9 + 6 * r));
    if (law == "sticky") f.lift += a * set.direction * std::exp(-set.gap / 0.05);
    if (law == "cavity") f.lift += a * std::max(0.0, set.voltage - 9) * std::max(0.0, std::log(0.2 / set.gap));
    return f;
}

std::vector<Point> set_points(const Case& wanted, bool test, core::Random& random) {
    std::vector<Point> points;
    if (wanted.family == "jet") {
        const std::vector<double> gaps = test ? std::vector<double>{3e-3, 5e-3, 8e-3, 0.012, 0.025, 0.055, 0.12, 0.26, 0.6}
                                              : std::vector<double>{2e-3, 4e-3, 6e-3, 9e-3, 0.014, 0.02, 0.03, 0.045, 0.07, 0.1, 0.15, 0.22, 0.3, 0.45, 0.7, 1};
        for (const double v : test ? std::vector<double>{4.5, 7.5, 10.5, 11.5} : std::vector<double>{4, 5, 6, 7, 8, 9, 10, 11, 12}) {
            for (const double direction : {1.0, -1.0}) {
                for (const double gap : gaps) {
                    points.push_back({gap, 0, v, 293.15, 0, direction});
                }
            }
        }
        // sweeps over gap in one direction, voltages in drawn order
        std::vector<std::size_t> order(points.size() / gaps.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        for (std::size_t k = order.size(); k > 1; --k) {
            std::swap(order[k - 1], order[random.below(k)]);
        }
        std::vector<Point> swept;
        for (const std::size_t sweep : order) {
            for (std::size_t k = 0; k < gaps.size(); ++k) {
                const std::size_t along = points[sweep * gaps.size()].direction > 0 ? k : gaps.size() - 1 - k;
                swept.push_back(points[sweep * gaps.size() + along]);
            }
        }
        points = std::move(swept);
    } else {
        for (const double gap : test ? std::vector<double>{1.2e-3, 3.5e-3, 8e-3, 0.013, 0.03}
                                     : std::vector<double>{1e-3, 1.5e-3, 2e-3, 2.5e-3, 3e-3, 5e-3, 6.5e-3, 0.01, 0.016, 0.025, 0.04, 0.07}) {
            for (int v = 2; v <= 10; ++v) {
                points.push_back({gap, 0.1 * v - (test ? 0.05 : 0), 0, 0, 0, 0});
                points.push_back(points.back());
            }
        }
        for (std::size_t k = points.size(); k > 1; --k) {
            std::swap(points[k - 1], points[random.below(k)]);
        }
    }
    for (std::size_t k = 0; k < points.size(); ++k) {
        points[k].time = (wanted.family == "jet" ? 60.0 : 180.0) * static_cast<double>(k);
        points[k].temperature = 293.15 + 2.2 * (2 * random.uniform() - 1);
    }
    return points;
}

dynamics::Measurements measure(const Case& wanted, const std::string& law, double a, double r, int mode, bool test, core::Random& random) {
    dynamics::Measurements data;
    data.kind = dynamics::MeasurementKind::steady;
    data.title = wanted.text();
    const double sigma = wanted.family == "jet" ? 0.0012 : 0.012;
    const std::vector<Point> points = set_points(wanted, test, random);
    std::vector<double> time, gap, speed, voltage, temperature, direction, lift, drag;
    double slow = 0;
    for (const Point& p : points) {
        const Forces f = law.empty() ? declared(wanted, p) : with(wanted, law, a, r, mode, p);
        slow = 0.8 * slow + 0.6 * random.normal();
        const double noise = wanted.coloured ? 0.8 * random.normal() + 0.6 * slow : random.normal();
        time.push_back(p.time);
        gap.push_back(p.gap);
        speed.push_back(p.speed);
        voltage.push_back(p.voltage);
        temperature.push_back(p.temperature);
        direction.push_back(p.direction);
        lift.push_back(f.lift + sigma * noise);
        drag.push_back(f.drag + sigma * random.normal());
    }
    dynamics::MeasuredRun run;
    run.name = test ? "test" : "bench";
    run.table.source = "bench";
    run.table.add_numbers("time", "s", time);
    run.table.add_numbers("gap", "m", gap);
    if (wanted.family == "jet") {
        run.table.add_numbers("jet_voltage", "V", voltage);
        run.table.add_numbers("approach_direction", "1", direction);
    } else {
        run.table.add_numbers("speed", "m/s", speed);
        run.table.add_numbers("temperature", "K", temperature);
    }
    run.table.add_numbers("lift_force", "N", lift);
    if (wanted.declared_noise > 0) {
        data.noise["lift_force"] = sigma * wanted.declared_noise;
    }
    if (wanted.family == "glide") {
        run.table.add_numbers("drag_force", "N", drag);
        if (wanted.declared_noise > 0) {
            data.noise["drag_force"] = sigma * wanted.declared_noise;
        }
    }
    run.use = test ? dynamics::RunUse::test : dynamics::RunUse::train;
    data.runs.push_back(std::move(run));
    return data;
}

}  // namespace

double glide_lift(double h) { return 0.9 * std::exp(-h / 6e-4) - 0.62 * std::exp(-h / 0.021) * (1 - 0.45 * std::exp(-h / 0.0017)) + 0.053; }
double glide_drag(double h) { return 0.16 + 0.19 * std::exp(-h / 0.0029); }

Sample make_static(const Case& wanted) {
    core::Random random(wanted.seed * 6007 + 3);
    const std::string law = wanted.names.empty() ? "" : wanted.names.front() == "unknown" ? wanted.law : wanted.names.front();
    const double sign = random.uniform() < 0.5 ? -1 : 1;
    const double r = random.uniform();
    const int mode = wanted.family == "jet" ? 0 : static_cast<int>(random.below(2));
    const double sigma = wanted.family == "jet" ? 0.0012 : 0.012;
    double a = sign * (law == "current" || law == "speed_exponent" || law == "temperature" || law == "sensor_gain" || law == "surface_roughness" ? 0.05
                       : law == "gap_offset" ? 2e-4 : law == "pump_curve" ? 0.3 : sigma);
    // to its level: RMS over the set points of the chief quantity, in noise
    core::Random layout(wanted.seed * 13 + 1);
    const std::vector<Point> points = set_points(wanted, false, layout);
    for (int round = 0; round < 8 && !law.empty(); ++round) {
        double lift = 0, drag = 0;
        for (const Point& p : points) {
            const Forces e = with(wanted, law, a, r, mode, p), d = declared(wanted, p);
            lift += std::pow(e.lift - d.lift, 2);
            drag += std::pow(e.drag - d.drag, 2);
        }
        const double size = std::sqrt(std::max(lift, drag) / static_cast<double>(points.size())) / sigma;
        a *= std::clamp(wanted.level / std::max(size, 1e-9), 0.1, 10.0);
    }
    Sample sample;
    sample.names = wanted.names;
    sample.strength = a;
    if (wanted.names == std::vector<std::string>{"unknown"}) {
        const std::string second = wanted.family == "jet" ? "jet_voltage" : "speed";
        sample.depends_on = law == "ring" ? std::vector<std::string>{"gap", second}
                            : law == "hump" ? std::vector<std::string>{"gap"}
                            : law == "resonance" ? std::vector<std::string>{"speed"}
                            : law == "diurnal" ? std::vector<std::string>{"time"}
                            : law == "sticky" ? std::vector<std::string>{"approach_direction", "gap"}
                                              : std::vector<std::string>{"gap", "jet_voltage"};
    }
    core::Random first(wanted.seed * 13 + 1), second(wanted.seed * 13 + 2);
    sample.train = measure(wanted, law, a, r, mode, false, first);
    sample.test = measure(wanted, law, a, r, mode, true, second);
    return sample;
}

std::filesystem::path write_declared_model(const std::string& family, const std::filesystem::path& folder) {
    std::string text = "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\nnet_weight = \"0.03 N\"\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\n"
                       "[environment]\ndensity = \"998 kg/m^3\"\nkinematic_viscosity = \"1.0e-6 m^2/s\"\ntemperature = \"20 degC\"\n"
                       "[drag.heave]\nlinear = \"0.02 N s/m\"\nquadratic = \"6.0 N s^2/m^2\"\n[[force]]\nquantity = \"lift_force\"\ntable = \"table.csv\"\n";
    std::string table = family == "glide" ? "gap [m], lift_force [N], drag_force [N]\n" : "gap [m], lift_force [N]\n";
    const double low = family == "glide" ? 2e-4 : 1e-3, high = family == "glide" ? 0.12 : 1.6;
    for (int k = 0; k <= 230; ++k) {
        const double h = low * std::pow(high / low, k / 230.0);
        table += core::format_number(h, 9) + ", " + core::format_number(family == "glide" ? glide_lift(h) : jet_lift(h), 9);
        table += family == "glide" ? ", " + core::format_number(glide_drag(h), 9) + "\n" : "\n";
    }
    if (family == "glide") {
        text += "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n[[force]]\nquantity = \"drag_force\"\ntable = \"table.csv\"\nscale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n";
    } else if (family == "jet") {
        text += "scale.jet_voltage = { reference = \"10 V\", exponent = 2 }\n";
    }
    core::write_file(folder / "table.csv", table);
    core::write_file(folder / "model.toml", text);
    return folder / "model.toml";
}

std::string Case::text() const {
    std::string out = family + " ";
    for (const std::string& name : names) {
        out += name + " ";
    }
    return out + law + " " + core::format_number(level, 3) + "x" + (coloured ? " coloured" : "") + (velocity ? " velocity" : "") + " seed " +
           std::to_string(seed);
}

Sample make_sample(const Case& wanted) { return wanted.family == "heave" ? make_heave(wanted) : make_static(wanted); }

std::vector<std::string> effects_of(const std::string& family) {
    if (family == "heave") {
        return {"constant_force", "coulomb_friction", "linear_damping", "quadratic_damping", "squeeze_film_damping", "added_mass",
                "gap_dependent_added_mass", "tether_stiffness", "ambient_heave_current", "periodic_disturbance", "input_gain",
                "input_dead_zone", "input_delay", "actuator_lag", "gap_sensor_bias", "gap_sensor_delay", "surface_roughness",
                "history_force", "declared_parameter"};
    }
    if (family == "jet") {
        return {"gap_offset", "force_bias", "sensor_gain", "drift", "cable_buoyancy", "guide_friction", "pump_curve", "surface_roughness"};
    }
    return {"gap_offset", "force_bias", "sensor_gain", "drift", "speed_exponent", "current", "temperature", "strut_buoyancy", "surface_roughness"};
}

std::vector<std::string> unknown_laws(const std::string& family) {
    if (family == "heave") {
        return {"bump", "wiggle", "cross", "warming", "one_sided", "rectifier"};
    }
    return family == "jet" ? std::vector<std::string>{"ring", "hump", "diurnal", "sticky", "cavity"}
                           : std::vector<std::string>{"ring", "hump", "resonance", "diurnal"};
}

}  // namespace underbody::bench
