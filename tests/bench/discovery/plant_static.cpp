#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "tests/bench/discovery/plants.h"

namespace underbody::bench {

namespace {

constexpr double reference_temperature = 293.15;

struct Point {
    double gap = 0, speed = 0, voltage = 0, temperature = reference_temperature, time = 0, direction = 0, pitch = 0,
           depth = 0;
};

struct Forces {
    double lift = 0, drag = 0, moment = 0;
};

/// One law of the plant: strength a, shape r in 0..1; `mode` 0: lift only, 1: every quantity.
struct Law {
    std::string name;
    double a = 0, r = 0;
    int mode = 0;
};

double viscosity(double kelvin) {
    // Vogel's law, another fit than the program's
    return 0.02939e-3 * std::exp(507.88 / (kelvin - 149.3));
}

double towed_lift(double gap, double pitch) { return glide_lift(gap) + 1.6 * pitch * (0.3 + std::exp(-gap / 0.02)); }
double towed_drag(double gap, double pitch) { return glide_drag(gap) + 4 * pitch * pitch; }
double towed_moment(double gap, double pitch) {
    return 0.02 * std::exp(-gap / 0.02) + 0.11 * pitch * (0.5 + std::exp(-gap / 0.015));
}

Forces declared(const std::string& family, const Point& p) {
    const double s = p.speed * p.speed / 0.25;
    const double v = p.voltage * p.voltage / 100;
    if (family == "jet") {
        return {jet_lift(p.gap) * v, 0, 0};
    }
    if (family == "both") {
        return {0.05 * glide_lift(p.gap) * s + jet_lift(p.gap) * v, 0, 0};
    }
    if (family == "towed") {
        return {towed_lift(p.gap, p.pitch) * s, towed_drag(p.gap, p.pitch) * s, towed_moment(p.gap, p.pitch) * s};
    }
    return {glide_lift(p.gap) * s, glide_drag(p.gap) * s, 0};
}

void move(const Law& law, Point& p) {
    if (law.name == "gap_offset") p.gap = std::max(2e-4, p.gap + law.a);
    if (law.name == "current") p.speed += law.a;
    if (law.name == "pitch_misalignment") p.pitch += law.a;
    if (law.name == "pump_curve") {
        const double size = std::abs(law.a);
        if (law.r < 0.5) {
            p.voltage = std::max(0.0, p.voltage - size) * 10 / (10 - size);
        } else {
            const double x = p.voltage / 10;
            p.voltage = 10 * x * std::pow((1 + size) / (1 + size * x * x * x), 0.5);
        }
    }
}

void push(const Law& law, const std::string& family, const Point& set, const Point& p, Forces& f) {
    const std::string& name = law.name;
    const double a = law.a;
    const auto scale = [&](double factor) {
        f.lift *= factor;
        f.drag *= law.mode == 1 ? factor : 1;
        f.moment *= law.mode == 1 ? factor : 1;
    };
    const auto add = [&](double force) {
        f.lift += force;
        f.drag += law.mode == 1 ? force : 0;
        f.moment += law.mode == 1 ? 0.1 * force : 0;
    };
    if (name == "speed_exponent" || name == "temperature") {
        const double still =
            name == "speed_exponent" && family == "both" ? jet_lift(p.gap) * p.voltage * p.voltage / 100 : 0;
        const double factor = name == "temperature"
                                  ? std::pow(viscosity(p.temperature) / viscosity(reference_temperature), a)
                                  : std::pow(p.speed / 0.5, a);
        f = {still + (f.lift - still) * factor, f.drag * factor, f.moment * factor};
    }
    if (name == "pitch_misalignment" && family == "glide") {
        const double lift = f.lift;
        f.lift = lift * std::cos(a) + f.drag * std::sin(a);
        f.drag = f.drag * std::cos(a) - lift * std::sin(a);
    }
    if (name == "declared_parameter") f.lift += a * jet_lift(p.gap) * p.voltage * p.voltage / 100;
    if (name == "sensor_gain") scale(1 + a);
    if (name == "force_bias") add(a);
    if (name == "drift") add(a * set.time / 3600);
    if (name == "strut_buoyancy" || name == "cable_buoyancy")
        f.lift += a * (family == "towed" ? set.depth - 0.6 : set.gap - 0.05 * law.r);
    if (name == "guide_friction") f.lift += a * set.direction * (1 + 0.1 * std::tanh(set.gap / 0.1));
    if (name == "surface_roughness") f.lift *= 1 - std::abs(a) * std::tanh(std::log(set.gap / (0.006 + 0.02 * law.r)));
    // outside the catalogue
    if (name == "ring")
        f.lift += a * std::exp(-std::pow((set.gap - 0.012) / 0.005, 2)) *
                  (set.voltage > 0 ? set.voltage / 8 : set.speed / 0.5);
    if (name == "hump") f.lift += a * std::exp(-std::pow(std::log(set.gap / 0.01), 2) / 0.3);
    if (name == "resonance") f.lift += a * std::exp(-std::pow((set.speed - 0.6) / 0.1, 2));
    if (name == "diurnal") add(a * std::sin(set.time / 3600 * 1.9 + 6 * law.r));
    if (name == "sticky") f.lift += a * set.direction * std::exp(-set.gap / 0.05);
    if (name == "cavity") f.lift += a * std::max(0.0, set.voltage - 9) * std::max(0.0, std::log(0.2 / set.gap));
    if (name == "stall") f.lift += a * std::pow(std::max(0.0, set.pitch - 0.01) / 0.05, 2) * set.speed / 0.5;
    if (name == "slope") f.moment += 0.1 * a * std::tanh(set.pitch / 0.03) * std::exp(-set.gap / 0.01);
}

Forces with(const std::string& family, const std::vector<Law>& laws, const Point& set) {
    Point seen = set;
    for (const Law& law : laws) {
        move(law, seen);
    }
    Forces f = declared(family, seen);
    for (const Law& law : laws) {
        push(law, family, set, seen, f);
    }
    return f;
}

/// The part `stream` of a set's draws.
core::Random draws_of(const Case& wanted, std::uint64_t stream) {
    return wanted.draw == 0 ? core::Random(stream) : core::Random(stream, wanted.draw);
}

void shuffle(std::vector<Point>& points, core::Random& random) {
    for (std::size_t k = points.size(); k > 1; --k) {
        std::swap(points[k - 1], points[random.below(k)]);
    }
}

/// Sweeps over gap in one direction, the voltages in drawn order.
std::vector<Point> jet_points(bool test, core::Random& random) {
    const std::vector<double> gaps = test ? std::vector<double>{3e-3, 5e-3, 8e-3, 0.012, 0.025, 0.055, 0.12, 0.26, 0.6}
                                          : std::vector<double>{2e-3, 4e-3, 6e-3, 9e-3, 0.014, 0.02, 0.03, 0.045,
                                                                0.07, 0.1,  0.15, 0.22, 0.3,   0.45, 0.7,  1};
    std::vector<std::pair<double, double>> sweeps;
    for (const double v :
         test ? std::vector<double>{4.5, 7.5, 10.5, 11.5} : std::vector<double>{4, 5, 6, 7, 8, 9, 10, 11, 12}) {
        sweeps.emplace_back(v, 1);
        sweeps.emplace_back(v, -1);
    }
    for (std::size_t k = sweeps.size(); k > 1; --k) {
        std::swap(sweeps[k - 1], sweeps[random.below(k)]);
    }
    std::vector<Point> points;
    for (const auto& [voltage, direction] : sweeps) {
        for (std::size_t k = 0; k < gaps.size(); ++k) {
            Point p;
            p.gap = gaps[direction > 0 ? k : gaps.size() - 1 - k];
            p.voltage = voltage;
            p.direction = direction;
            points.push_back(p);
        }
    }
    return points;
}

std::vector<Point> drawn_points(const std::string& family, bool test, core::Random& random) {
    std::vector<Point> points;
    const auto add = [&](double gap, double speed, double voltage, double pitch, int repeats) {
        Point p;
        p.gap = gap;
        p.speed = speed;
        p.voltage = voltage;
        p.pitch = pitch;
        points.insert(points.end(), static_cast<std::size_t>(repeats), p);
    };
    const double between = test ? 0.05 : 0;
    if (family == "glide") {
        for (const double gap : test ? std::vector<double>{1.2e-3, 3.5e-3, 8e-3, 0.013, 0.03}
                                     : std::vector<double>{1e-3, 1.5e-3, 2e-3, 2.5e-3, 3e-3, 5e-3, 6.5e-3, 0.01, 0.016,
                                                           0.025, 0.04, 0.07}) {
            for (int v = 2; v <= 10; ++v) {
                add(gap, 0.1 * v - between, 0, 0, 2);
            }
        }
    } else if (family == "towed") {
        for (const double gap : test ? std::vector<double>{2e-3, 5e-3, 0.013, 0.03}
                                     : std::vector<double>{1.5e-3, 2.5e-3, 4e-3, 6.5e-3, 0.01, 0.016, 0.04}) {
            for (const double pitch :
                 test ? std::vector<double>{-0.02, 0.01, 0.045} : std::vector<double>{-0.05, -0.025, 0, 0.025, 0.05}) {
                for (const double speed : {0.25, 0.4, 0.6, 0.8, 1.0}) {
                    add(gap, speed - between, 0, pitch, 1);
                }
            }
        }
    } else {
        for (const double gap : test ? std::vector<double>{3e-3, 8e-3, 0.02, 0.05}
                                     : std::vector<double>{2e-3, 4e-3, 6e-3, 0.01, 0.016, 0.025, 0.04, 0.07}) {
            for (const double speed : {0.3, 0.6, 0.9}) {
                for (const double voltage : {4.0, 6.0, 8.0, 10.0, 12.0}) {
                    add(gap, speed - between, voltage - 10 * between, 0, 2);
                }
            }
        }
    }
    shuffle(points, random);
    return points;
}

std::vector<Point> set_points(const std::string& family, bool test, core::Random& random) {
    std::vector<Point> points = family == "jet" ? jet_points(test, random) : drawn_points(family, test, random);
    for (std::size_t k = 0; k < points.size(); ++k) {
        points[k].time = (family == "glide" || family == "towed" ? 180.0 : 60.0) * static_cast<double>(k);
        points[k].temperature = reference_temperature + 2.2 * (2 * random.uniform() - 1);
        points[k].depth = family == "towed" ? 0.4 + 0.1 * static_cast<double>(random.below(5)) : 0;
    }
    return points;
}

double noise_of(const std::string& family, int quantity) {
    const double force = family == "jet" || family == "both" ? 0.0012 : 0.012;
    return quantity == 2 ? 0.1 * force : force;
}

int quantities_of(const std::string& family) { return family == "towed" ? 3 : family == "glide" ? 2 : 1; }

double part(const Forces& f, int quantity) { return quantity == 0 ? f.lift : quantity == 1 ? f.drag : f.moment; }

const char* const quantity_names[] = {"lift_force", "drag_force", "pitch_moment"};

dynamics::Measurements measure(const Case& wanted, const std::vector<Law>& laws, bool test, core::Random& random) {
    dynamics::Measurements data;
    data.kind = dynamics::MeasurementKind::steady;
    data.title = wanted.text();
    const std::vector<Point> points = set_points(wanted.family, test, random);
    const auto column = [&](double Point::*member) {
        std::vector<double> values;
        for (const Point& p : points) {
            values.push_back(p.*member);
        }
        return values;
    };
    dynamics::MeasuredRun run;
    run.name = test ? "test" : "bench";
    run.table.source = "bench";
    run.table.add_numbers("time", "s", column(&Point::time));
    run.table.add_numbers("gap", "m", column(&Point::gap));
    if (wanted.family == "jet" || wanted.family == "both") {
        run.table.add_numbers("jet_voltage", "V", column(&Point::voltage));
    }
    if (wanted.family == "jet") {
        run.table.add_numbers("approach_direction", "1", column(&Point::direction));
    } else {
        run.table.add_numbers("speed", "m/s", column(&Point::speed));
        run.table.add_numbers("temperature", "K", column(&Point::temperature));
    }
    if (wanted.family == "towed") {
        run.table.add_numbers("pitch", "rad", column(&Point::pitch));
        run.table.add_numbers("depth", "m", column(&Point::depth));
    }
    for (int q = 0; q < quantities_of(wanted.family); ++q) {
        const double sigma = noise_of(wanted.family, q);
        std::vector<double> values;
        double slow = 0;
        for (const Point& p : points) {
            slow = 0.8 * slow + 0.6 * random.normal();
            const double noise = wanted.coloured && q == 0 ? 0.8 * random.normal() + 0.6 * slow : random.normal();
            values.push_back(part(with(wanted.family, laws, p), q) + sigma * noise);
        }
        run.table.add_numbers(quantity_names[q], q == 2 ? "N m" : "N", values);
        if (wanted.declared_noise > 0) {
            data.noise[quantity_names[q]] = sigma * wanted.declared_noise;
        }
    }
    run.use = test ? dynamics::RunUse::test : dynamics::RunUse::train;
    data.runs.push_back(std::move(run));
    return data;
}

/// Sum over quantities of squares of what the laws change, in noise, a set point.
double size_in_noise(const std::string& family, const std::vector<Law>& laws, const std::vector<Point>& points) {
    double largest = 0;
    for (int q = 0; q < quantities_of(family); ++q) {
        double sum = 0;
        for (const Point& p : points) {
            sum += std::pow((part(with(family, laws, p), q) - part(declared(family, p), q)) / noise_of(family, q), 2);
        }
        largest = std::max(largest, sum / static_cast<double>(points.size()));
    }
    return std::sqrt(largest);
}

double first_guess(const std::string& law, double sigma) {
    if (law == "current" || law == "speed_exponent" || law == "temperature" || law == "sensor_gain" ||
        law == "surface_roughness" || law == "declared_parameter") {
        return 0.05;
    }
    return law == "gap_offset" ? 2e-4 : law == "pump_curve" ? 0.3 : law == "pitch_misalignment" ? 0.005 : sigma;
}

/// What the catalogue's first parameter should come out as; NaN where the bench's law has another form than the
/// catalogue's.
double in_catalogue_terms(const Law& law) {
    if (law.name == "speed_exponent") return 2 + law.a;
    if (law.name == "sensor_gain") return 1 + law.a;
    if (law.name == "declared_parameter") return 1 + law.a;
    if (law.name == "drift") return law.a / 3600;
    if (law.name == "pump_curve" || law.name == "surface_roughness" || law.name == "guide_friction")
        return std::nan("");
    return law.a;
}

std::vector<std::string> depends_of(const std::string& law, const std::string& family) {
    const std::string second = family == "jet" ? "jet_voltage" : "speed";
    return law == "ring"        ? std::vector<std::string>{"gap", second}
           : law == "hump"      ? std::vector<std::string>{"gap"}
           : law == "resonance" ? std::vector<std::string>{"speed"}
           : law == "diurnal"   ? std::vector<std::string>{"time"}
           : law == "sticky"    ? std::vector<std::string>{"approach_direction", "gap"}
           : law == "stall"     ? std::vector<std::string>{"pitch", "speed"}
           : law == "slope"     ? std::vector<std::string>{"gap", "pitch"}
                                : std::vector<std::string>{"gap", "jet_voltage"};
}

/// A body is never below the ground, and no scale turns a force round.
double least_of(const Law& law, const std::vector<Point>& points) {
    if (law.name == "gap_offset") {
        const auto nearest = std::min_element(points.begin(), points.end(),
                                              [](const Point& a, const Point& b) { return a.gap < b.gap; });
        return -0.8 * nearest->gap;
    }
    return law.name == "sensor_gain" ? -0.8 : -1e300;
}

/// A zero off by more than half of the largest gap is seen by everybody (and may leave no force to measure at all).
double most_of(const Law& law, const std::vector<Point>& points) {
    double farthest = 0;
    for (const Point& point : points) {
        farthest = std::max(farthest, point.gap);
    }
    return law.name == "gap_offset" ? 0.5 * farthest : 1e300;
}

std::vector<Law> laws_of(const Case& wanted) {
    core::Random random = draws_of(wanted, wanted.seed * 6007 + 3);
    core::Random layout = draws_of(wanted, wanted.seed * 13 + 1);
    const std::vector<Point> points = set_points(wanted.family, false, layout);
    const bool unknown = wanted.names == std::vector<std::string>{"unknown"};
    std::vector<Law> laws;
    if (wanted.law == scale_and_offset) {  // as on rigs: a scale off by 4 to 12 %, a zero by 0.1 to 0.4 mm
        const auto either_way = [&](double low, double high) {
            return (random.uniform() < 0.5 ? -1 : 1) * random.uniform(low, high);
        };
        laws.push_back({"gap_offset", either_way(1e-4, 4e-4), random.uniform(), 0});
        laws.push_back({"sensor_gain", either_way(0.04, 0.12), random.uniform(), 0});
        return laws;
    }
    for (const std::string& name : unknown ? std::vector<std::string>{wanted.law} : wanted.names) {
        Law law;
        law.name = name;
        law.a = (random.uniform() < 0.5 ? -1 : 1) * first_guess(name, noise_of(wanted.family, 0));
        law.r = random.uniform();
        law.mode = quantities_of(wanted.family) == 1 ? 0 : static_cast<int>(random.below(2));
        // to its level: RMS over the set points of the quantity it changes most, in noise
        for (int round = 0; round < 8; ++round) {
            law.a *= std::clamp(wanted.level / std::max(size_in_noise(wanted.family, {law}, points), 1e-9), 0.1, 10.0);
            law.a = std::clamp(law.a, least_of(law, points), most_of(law, points));
        }
        laws.push_back(law);
    }
    return laws;
}

std::vector<Point> points_of(const dynamics::Measurements& data) {
    const core::Table& table = data.runs.front().table;
    std::vector<Point> points(table.rows());
    const auto take = [&](const char* name, double Point::*member) {
        if (const core::Column* column = table.find(name)) {
            for (std::size_t i = 0; i < points.size(); ++i) {
                points[i].*member = column->numbers[i];
            }
        }
    };
    take("time", &Point::time);
    take("gap", &Point::gap);
    take("speed", &Point::speed);
    take("jet_voltage", &Point::voltage);
    take("temperature", &Point::temperature);
    take("approach_direction", &Point::direction);
    take("pitch", &Point::pitch);
    take("depth", &Point::depth);
    return points;
}

}  // namespace

double glide_lift(double h) {
    return 0.9 * std::exp(-h / 6e-4) - 0.62 * std::exp(-h / 0.021) * (1 - 0.45 * std::exp(-h / 0.0017)) + 0.053;
}
double glide_drag(double h) { return 0.16 + 0.19 * std::exp(-h / 0.0029); }

Sample make_static(const Case& wanted) {
    const std::vector<Law> laws = laws_of(wanted);
    Sample sample;
    sample.names = wanted.names;
    sample.in_catalogue_terms = laws.size() == 1 ? in_catalogue_terms(laws.front()) : std::nan("");
    if (wanted.names == std::vector<std::string>{"unknown"}) {
        sample.depends_on = depends_of(wanted.law, wanted.family);
    }
    core::Random first = draws_of(wanted, wanted.seed * 13 + 1), second = draws_of(wanted, wanted.seed * 13 + 2);
    sample.train = measure(wanted, laws, false, first);
    sample.test = measure(wanted, laws, true, second);
    return sample;
}

std::map<std::string, double> static_oracle(const Case& wanted, const Sample& sample) {
    std::vector<Law> laws = laws_of(wanted);
    const std::vector<Point> points = points_of(sample.train);
    const core::Table& table = sample.train.runs.front().table;
    const auto residuals = [&](const std::vector<Law>& trial) {
        std::vector<double> r;
        for (int q = 0; q < quantities_of(wanted.family); ++q) {
            const std::vector<double>& measured = table.numbers(quantity_names[q]);
            for (std::size_t i = 0; i < points.size(); ++i) {
                r.push_back((measured[i] - part(with(wanted.family, trial, points[i]), q)) /
                            noise_of(wanted.family, q));
            }
        }
        return r;
    };
    const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
        return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    };
    for (int round = 0; round < 6; ++round) {
        // Gauss and Newton, one strength after the other
        for (std::size_t k = 0; k < laws.size(); ++k) {
            const std::vector<double> at = residuals(laws);
            std::vector<Law> moved = laws;
            const double h = 1e-3 * laws[k].a;
            moved[k].a += h;
            std::vector<double> slope = residuals(moved);
            for (std::size_t i = 0; i < slope.size(); ++i) {
                slope[i] = (slope[i] - at[i]) / h;
            }
            moved[k].a = laws[k].a - dot(slope, at) / std::max(dot(slope, slope), 1e-300);
            const std::vector<double> there = residuals(moved);
            if (dot(there, there) < dot(at, at)) {
                laws = moved;
            }
        }
    }
    std::map<std::string, double> rmse;
    const std::vector<Point> others = points_of(sample.test);
    for (int q = 0; q < quantities_of(wanted.family); ++q) {
        const std::vector<double>& measured = sample.test.runs.front().table.numbers(quantity_names[q]);
        double sum = 0;
        for (std::size_t i = 0; i < others.size(); ++i) {
            sum += std::pow(measured[i] - part(with(wanted.family, laws, others[i]), q), 2);
        }
        rmse[quantity_names[q]] = std::sqrt(sum / static_cast<double>(others.size()));
    }
    return rmse;
}

double static_noise(const std::string& family, const std::string& quantity) {
    return noise_of(family, quantity == "pitch_moment" ? 2 : 0);
}

namespace {

std::vector<double> logarithmic(double low, double high, int count) {
    std::vector<double> values;
    for (int k = 0; k < count; ++k) {
        values.push_back(low * std::pow(high / low, static_cast<double>(k) / (count - 1)));
    }
    return values;
}

std::string numbers(std::initializer_list<double> values) {
    std::string line;
    for (const double value : values) {
        line += (line.empty() ? "" : ", ") + core::format_number(value, 9);
    }
    return line + "\n";
}

std::string source(const std::string& quantity, const std::string& table, const std::string& scale) {
    return "[[force]]\nquantity = \"" + quantity + "\"\ntable = \"" + table + "\"\n" + scale;
}

}  // namespace

std::filesystem::path write_declared_model(const std::string& family, const std::filesystem::path& folder) {
    std::string text =
        "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\nnet_weight = \"0.03 N\"\nlength = \"203.2 "
        "mm\"\nwidth = \"152 mm\"\n"
        "[environment]\ndensity = \"998 kg/m^3\"\nkinematic_viscosity = \"1.0e-6 m^2/s\"\ntemperature = \"20 degC\"\n"
        "[drag.heave]\nlinear = \"0.02 N s/m\"\nquadratic = \"6.0 N s^2/m^2\"\n";
    const std::string by_speed = "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n";
    const std::string by_voltage = "scale.jet_voltage = { reference = \"10 V\", exponent = 2 }\n";
    std::string glide = "gap [m], lift_force [N], drag_force [N]\n";
    std::string passive = "gap [m], lift_force [N]\n";
    std::string jet = passive;
    std::string towed = "gap [m], pitch [rad], lift_force [N], drag_force [N], pitch_moment [N m]\n";
    for (const double h : logarithmic(2e-4, 0.12, 231)) {
        glide += numbers({h, glide_lift(h), glide_drag(h)});
        passive += numbers({h, 0.05 * glide_lift(h)});
    }
    for (const double h : logarithmic(1e-3, 1.6, 231)) {
        jet += numbers({h, jet_lift(h)});
    }
    if (family == "towed") {
        for (const double h : logarithmic(2e-4, 0.12, 121)) {
            for (int k = -8; k <= 8; ++k) {
                towed += numbers(
                    {h, 0.015 * k, towed_lift(h, 0.015 * k), towed_drag(h, 0.015 * k), towed_moment(h, 0.015 * k)});
            }
        }
        core::write_file(folder / "table.csv", towed);
        text += source("lift_force", "table.csv", by_speed) + source("drag_force", "table.csv", by_speed) +
                source("pitch_moment", "table.csv", by_speed);
    } else if (family == "glide") {
        core::write_file(folder / "table.csv", glide);
        text += source("lift_force", "table.csv", by_speed) + source("drag_force", "table.csv", by_speed);
    } else if (family == "both") {
        core::write_file(folder / "passive.csv", passive);
        core::write_file(folder / "jet.csv", jet);
        text += source("lift_force", "passive.csv", by_speed) + source("lift_force", "jet.csv", by_voltage);
    } else {
        core::write_file(folder / "table.csv", jet);
        text += source("lift_force", "table.csv", family == "jet" ? by_voltage : "");
    }
    core::write_file(folder / "model.toml", text);
    return folder / "model.toml";
}

std::string Case::text() const {
    std::string out = family + " ";
    for (const std::string& name : names) {
        out += name + " ";
    }
    return out + law + " " + core::format_number(level, 3) + "x" + (coloured ? " coloured" : "") +
           (rig.ar > 0 ? " correlated " + core::format_number(rig.ar, 2) : "") + (velocity ? " velocity" : "") +
           (declared_noise != 1 ? " noise x" + core::format_number(declared_noise, 2) : "") + " seed " +
           std::to_string(seed) + (draw > 0 ? " draw " + std::to_string(draw) : "");
}

Sample make_sample(const Case& wanted) { return wanted.family == "heave" ? make_heave(wanted) : make_static(wanted); }

std::vector<std::string> effects_of(const std::string& family) {
    if (family == "heave") {
        return {"constant_force",
                "coulomb_friction",
                "linear_damping",
                "quadratic_damping",
                "squeeze_film_damping",
                "added_mass",
                "gap_dependent_added_mass",
                "tether_stiffness",
                "ambient_heave_current",
                "periodic_disturbance",
                "input_gain",
                "input_dead_zone",
                "input_delay",
                "actuator_lag",
                "gap_sensor_bias",
                "gap_sensor_delay",
                "surface_roughness",
                "history_force",
                "declared_parameter"};
    }
    if (family == "jet") {
        return {"gap_offset",     "force_bias",     "sensor_gain", "drift",
                "cable_buoyancy", "guide_friction", "pump_curve",  "surface_roughness"};
    }
    if (family == "both") {
        return {"declared_parameter", "sensor_gain", "pump_curve", "current", "gap_offset", "speed_exponent"};
    }
    std::vector<std::string> list{"gap_offset",        "force_bias",        "sensor_gain", "drift",
                                  "speed_exponent",    "current",           "temperature", "strut_buoyancy",
                                  "surface_roughness", "pitch_misalignment"};
    return list;
}

std::vector<std::string> unknown_laws(const std::string& family) {
    if (family == "heave") {
        return {"bump",   "wiggle",    "cross",         "warming",          "one_sided",  "rectifier",
                "ripple", "film_cell", "above_a_speed", "thrust_near_wall", "jump_in_gap"};
    }
    if (family == "towed") {
        return {"stall", "slope", "hump"};
    }
    if (family == "both") {
        return {"hump"};
    }
    return family == "jet" ? std::vector<std::string>{"ring", "hump", "diurnal", "sticky", "cavity"}
                           : std::vector<std::string>{"ring", "hump", "resonance", "diurnal"};
}

}  // namespace underbody::bench
