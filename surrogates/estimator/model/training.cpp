#include "surrogates/estimator/model/training.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/counted.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/told.h"

namespace underbody::estimator {

ResistanceLaw quadratic_drag(double linear, double quadratic) {
    return [linear, quadratic](double /*gap*/, double w, DragSlopes& slopes) {
        slopes = {0, linear + 2 * quadratic * std::abs(w)};
        return linear * w + quadratic * w * std::abs(w);
    };
}

namespace {

enum class Auxiliary {
    ground_force,
    drag_force,
    total_force,
    ground_slope,
    drag_slope,
    gap_squared,
    gap_cubed,
    velocity_squared
};

struct Compiled {
    const SeparatedPlant* plant;
    std::vector<Auxiliary> auxiliaries;
};

Compiled compile(const SeparatedPlant& plant, const Layout& layout) {
    const auto& known = known_auxiliaries();
    Compiled out{&plant, {}};
    for (std::size_t i = layout.measured; i < layout.states.size(); ++i) {
        const auto at = std::find(known.begin(), known.end(), layout.states[i]);
        if (at == known.end()) {
            throw core::InputError("name", "there is no auxiliary variable '" + layout.states[i] + "'", {},
                                   core::did_you_mean(layout.states[i], known));
        }
        out.auxiliaries.push_back(static_cast<Auxiliary>(at - known.begin()));
    }
    return out;
}

// Gap, velocity and what follows from them at one place.
struct Place {
    double h = 0, w = 0, dw = 0;
    double ground = 0, ground_slope = 0, drag = 0, drag_rate = 0;
    DragSlopes drag_slopes;
};

// Value and rate, exact by the chain rule.
std::pair<double, double> rated(Auxiliary what, const SeparatedPlant& p, const Place& at) {
    const double h = at.h, w = at.w;
    switch (what) {
        case Auxiliary::ground_force:
            return {at.ground, at.ground_slope * w};
        case Auxiliary::drag_force:
            return {at.drag, at.drag_rate};
        case Auxiliary::total_force:
            return {at.ground - at.drag, at.ground_slope * w - at.drag_rate};
        case Auxiliary::ground_slope: {
            // The curve's second derivative by a central difference of its slope over 20 micrometres.
            double up = 0, down = 0;
            p.ground_force(h + 1e-5, up);
            p.ground_force(h - 1e-5, down);
            return {at.ground_slope, (up - down) / 2e-5 * w};
        }
        case Auxiliary::drag_slope: {
            // Likewise over 2 micrometres per second.
            DragSlopes up, down;
            p.drag_force(h, w + 1e-6, up);
            p.drag_force(h, w - 1e-6, down);
            return {at.drag_slopes.velocity, (up.velocity - down.velocity) / 2e-6 * at.dw};
        }
        case Auxiliary::gap_squared:
            return {h * h, 2 * h * w};
        case Auxiliary::gap_cubed:
            return {h * h * h, 3 * h * h * w};
        case Auxiliary::velocity_squared:
            return {w * std::abs(w), 2 * std::abs(w) * at.dw};
    }
    return {};
}

// Row (u, w, h, auxiliaries, dw, dh, their rates).
void fill(const Compiled& c, double u, double w, double h, double* row) {
    const SeparatedPlant& p = *c.plant;
    const std::size_t n = 2 + c.auxiliaries.size();
    Place at;
    at.h = h;
    at.w = w;
    at.dw = p.acceleration(h, w, u);
    at.ground = p.ground_force(h, at.ground_slope);
    at.drag = p.drag_force(h, w, at.drag_slopes);
    at.drag_rate = at.drag_slopes.velocity * at.dw + at.drag_slopes.gap * w;
    row[0] = u;
    row[1] = w;
    row[2] = h;
    row[1 + n] = at.dw;
    row[2 + n] = w;
    for (std::size_t i = 0; i < c.auxiliaries.size(); ++i) {
        const auto [value, rate] = rated(c.auxiliaries[i], p, at);
        row[3 + i] = value;
        row[3 + n + i] = rate;
    }
}

// Exact rates, or what a forward difference over `step` makes of them.
void fill(const Compiled& c, double u, double w, double h, double step, double* row) {
    fill(c, u, w, h, row);
    if (step <= 0) {
        return;
    }
    const std::size_t n = 2 + c.auxiliaries.size();
    std::array<double, 40> next{};
    double gap = h, velocity = w;
    c.plant->advance(gap, velocity, u, step);
    fill(c, u, velocity, gap, next.data());
    for (std::size_t i = 0; i < n; ++i) {
        row[1 + n + i] = (next[1 + i] - row[1 + i]) / step;
    }
}

// Noise of unit deviation. Pink: the filter of Kellet (-10 dB per decade to 0.5 dB), scaled to unit deviation.
class Noise {
public:
    Noise(Excitation kind, core::Random& random) : kind_(kind), random_(random) {
        if (kind_ == Excitation::pink) {
            for (int i = 0; i < 300; ++i) {
                next();
            }
        }
    }
    double next() {
        switch (kind_) {
            case Excitation::none:
                return 0;
            case Excitation::white:
                return random_.normal();
            case Excitation::pink: {
                constexpr std::array<double, 6> pole{0.99886, 0.99332, 0.969, 0.8665, 0.55, -0.7616};
                constexpr std::array<double, 6> gain{0.0555179, 0.0750759, 0.153852, 0.3104856, 0.5329522, -0.016898};
                const double white = random_.normal();
                double sum = last_ + 0.5362 * white;
                for (std::size_t i = 0; i < pole.size(); ++i) {
                    state_[i] = pole[i] * state_[i] + gain[i] * white;
                    sum += state_[i];
                }
                last_ = 0.115926 * white;
                return sum / 2.9676;
            }
            case Excitation::pulses:
                if (left_ == 0) {
                    left_ = 1 + random_.below(20);
                    level_ = std::sqrt(1.5) * (static_cast<double>(random_.below(3)) - 1);  // -1, 0, 1: variance 2/3
                }
                --left_;
                return level_;
        }
        return 0;
    }

private:
    Excitation kind_;
    core::Random& random_;
    std::array<double, 6> state_{};
    double last_ = 0;
    std::size_t left_ = 0;
    double level_ = 0;
};

void check(const SeparatedPlant& plant, const TrainingOptions& o) {
    if (!(o.gap_upper > o.gap_lower) || !(o.velocity_upper >= o.velocity_lower)) {
        throw core::InputError("range", "the training region is empty: its upper ends must lie above its lower ends");
    }
    if (o.gap_lower < plant.contact_gap) {
        throw core::InputError(
            "range", "the training region reaches below the contact gap " + core::told(plant.contact_gap, "m"), {},
            "start the gaps there or above");
    }
    if (o.samples < 1 || o.samples > 4000000) {
        throw core::InputError("range", "between 1 and 4,000,000 samples, not " + std::to_string(o.samples));
    }
    if (!(o.input_sigma >= 0) || !(o.duration > 0) || !(o.interval > 0) || !(o.largest_step > 0) ||
        o.difference_step < 0) {
        throw core::InputError("range", "duration, interval and steps must be positive");
    }
    if (o.focus_share < 0 || o.focus_share > 1 || (o.focus_share > 0 && !(o.focus_upper > o.focus_lower))) {
        throw core::InputError("range", "the focus needs a share within 0..1 and a band of gaps");
    }
}

double draw_gap(const TrainingOptions& o, core::Random& random) {
    if (o.focus_share > 0 && random.uniform() < o.focus_share) {
        return random.uniform(o.focus_lower, o.focus_upper);
    }
    return random.uniform(o.gap_lower, o.gap_upper);
}

double node(double lower, double upper, std::size_t i, std::size_t count) {
    return count < 2 ? 0.5 * (lower + upper)
                     : lower + (upper - lower) * static_cast<double>(i) / static_cast<double>(count - 1);
}

void fill_mesh(const Compiled& c, const TrainingOptions& o, TrainingSet& set) {
    const std::size_t channels = set.layout.channels();
    set.count = o.mesh_inputs * o.mesh_velocities * o.mesh_gaps;
    set.values.resize(set.count * channels);
    std::size_t at = 0;
    for (std::size_t i = 0; i < o.mesh_inputs; ++i) {
        for (std::size_t j = 0; j < o.mesh_velocities; ++j) {
            for (std::size_t k = 0; k < o.mesh_gaps; ++k) {
                fill(c, node(-o.input_sigma, o.input_sigma, i, o.mesh_inputs),
                     node(o.velocity_lower, o.velocity_upper, j, o.mesh_velocities),
                     node(o.gap_lower, o.gap_upper, k, o.mesh_gaps), o.difference_step, set.values.data() + at);
                at += channels;
            }
        }
    }
}

void fill_grid(const Compiled& c, const TrainingOptions& o, TrainingSet& set, core::Progress& progress) {
    const std::size_t channels = set.layout.channels();
    set.count = o.samples;
    set.values.resize(set.count * channels);
    constexpr std::size_t block = 8192;
    core::parallel_blocks(
        set.count, block,
        [&](std::size_t begin, std::size_t end) {
            core::Random random(o.seed, begin / block);
            Noise noise(o.excitation, random);
            for (std::size_t i = begin; i < end; ++i) {
                const double w = random.uniform(o.velocity_lower, o.velocity_upper);
                const double h = draw_gap(o, random);
                fill(c, o.input_sigma * noise.next(), w, h, o.difference_step, set.values.data() + i * channels);
            }
        },
        progress);
}

void fill_time(const Compiled& c, const TrainingOptions& o, TrainingSet& set, core::Progress& progress) {
    const std::size_t channels = set.layout.channels();
    const auto each = static_cast<std::size_t>(std::max(1.0, std::round(o.duration / o.interval)));
    const std::size_t trajectories = (o.samples + each - 1) / each;
    set.count = o.samples;
    set.values.resize(set.count * channels);
    const auto steps = static_cast<int>(std::ceil(o.interval / o.largest_step));
    const double step = o.interval / steps;
    core::parallel_for(
        trajectories,
        [&](std::size_t t) {
            core::Random random(o.seed, t);
            Noise noise(o.excitation, random);
            double h = draw_gap(o, random);
            double w = o.start_at_rest ? 0 : random.uniform(o.velocity_lower, o.velocity_upper);
            for (std::size_t k = 0; k < each && t * each + k < set.count; ++k) {
                const double u = o.input_sigma * noise.next();
                fill(c, u, w, h, o.difference_step, set.values.data() + (t * each + k) * channels);
                for (int s = 0; s < steps; ++s) {
                    c.plant->advance(h, w, u, step);
                }
            }
        },
        progress);
}

}  // namespace

const std::vector<std::string>& known_auxiliaries() {
    static const std::vector<std::string> names{"ground_force", "drag_force",  "total_force", "ground_slope",
                                                "drag_slope",   "gap_squared", "gap_cubed",   "velocity_squared"};
    return names;
}

TrainingSet training_set(const SeparatedPlant& plant, const TrainingOptions& options, core::Progress& progress) {
    check(plant, options);
    TrainingSet set;
    set.layout.inputs = {"input_force"};
    set.layout.states = {"heave_velocity", "gap"};
    set.layout.states.insert(set.layout.states.end(), options.auxiliaries.begin(), options.auxiliaries.end());
    const Compiled compiled = compile(plant, set.layout);
    if (options.mesh_inputs * options.mesh_velocities * options.mesh_gaps > 0) {
        if (options.mesh_inputs * options.mesh_velocities * options.mesh_gaps > 4000000) {
            throw core::InputError("range", "the mesh has more than 4,000,000 points");
        }
        fill_mesh(compiled, options, set);
    } else if (options.method == TrainingOptions::Method::grid) {
        fill_grid(compiled, options, set, progress);
    } else {
        fill_time(compiled, options, set, progress);
    }
    std::size_t outside = 0;
    for (std::size_t i = 0; i < set.count; ++i) {
        const double h = set.at(i, 2);
        outside += h < plant.lower || h > plant.upper ? 1U : 0U;
    }
    set.outside = static_cast<double>(outside) / static_cast<double>(set.count);
    set.remarks = plant.remarks;
    if (outside > 0) {
        set.remarks.push_back({core::Problem::Severity::warning,
                               core::counted_of(outside, set.count, "sample", "lies", "lie") +
                                   " beyond the force table, where it holds its end value",
                               {}});
    }
    return set;
}

void sample_at(const SeparatedPlant& plant, const Layout& layout, double input, double velocity, double gap,
               double* row) {
    fill(compile(plant, layout), input, velocity, gap, row);
}

Vector equilibrium_point(const SeparatedPlant& plant, const Layout& layout, double gap_lower, double gap_upper) {
    constexpr int pieces = 2000;
    double slope = 0;
    for (int i = 0; i < pieces; ++i) {
        double a = gap_lower + (gap_upper - gap_lower) * i / pieces,
               b = gap_lower + (gap_upper - gap_lower) * (i + 1) / pieces;
        if (!(plant.ground_force(a, slope) + plant.bias > 0 && plant.ground_force(b, slope) + plant.bias <= 0)) {
            continue;
        }
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (a + b);
            (plant.ground_force(middle, slope) + plant.bias > 0 ? a : b) = middle;
        }
        std::vector<double> row(layout.channels());
        sample_at(plant, layout, 0, 0, 0.5 * (a + b), row.data());
        return {row.begin(), row.begin() + static_cast<std::ptrdiff_t>(layout.inputs.size() + layout.states.size())};
    }
    throw core::InputError("missing",
                           "the plant has no stable equilibrium between " + core::told(gap_lower, "m") + " and " +
                               core::told(gap_upper, "m"),
                           {}, "widen the region or take moments about the mean");
}

AugmentedModel frozen_model(const SeparatedPlant& plant, double gap, double velocity) {
    double ground_slope = 0;
    DragSlopes drag_slopes;
    plant.ground_force(gap, ground_slope);
    plant.drag_force(gap, velocity, drag_slopes);
    const double s = 1 / plant.mass_at(gap), f = drag_slopes.velocity * s;
    AugmentedModel model = AugmentedModel::from_matrices(
        Layout::heave(), Matrix{{0, 0, s, -s}, {1, 0, 0, 0}, {ground_slope, 0, 0, 0}, {0, 0, f, -f}},
        Matrix{{s}, {0}, {0}, {f}}, {plant.bias * s, 0, 0, f * plant.bias});
    model.method = "frozen";
    return model;
}

PlaneModel tangent_model(const SeparatedPlant& plant, double gap, double velocity) {
    dynamics::HeaveSlopes slopes;
    const double acceleration = plant.acceleration(gap, velocity, 0, 0, slopes);
    PlaneModel model{Matrix{{slopes.velocity, slopes.gap}, {1, 0}}, {1 / slopes.mass, 0}, {0, 0}};
    model.offset[0] = acceleration - (model.A * Vector{velocity, gap})[0];
    return model;
}

double equivalent_drag_factor(MotionShape shape) {
    return shape == MotionShape::gaussian ? std::sqrt(8 / std::numbers::pi)
                                          : 8 * std::numbers::sqrt2 / (3 * std::numbers::pi);
}

PlaneModel equivalent_model(const SeparatedPlant& plant, double gap, double velocity_rms, MotionShape shape) {
    PlaneModel model = tangent_model(plant, gap, 0);
    // Damping that removes the same power: E[w F_d] / E[w^2], for the plant's own drag law.
    double work = 0, square = 0;
    constexpr int n = 2000;
    for (int i = 0; i < n; ++i) {
        const double x = (i + 0.5) / n;
        double w = 0, weight = 1;
        if (shape == MotionShape::gaussian) {
            w = velocity_rms * (16 * x - 8);
            weight = std::exp(-0.5 * (16 * x - 8) * (16 * x - 8));
        } else {
            w = velocity_rms * std::numbers::sqrt2 * std::sin(2 * std::numbers::pi * x);
        }
        work += weight * w * plant.drag(gap, w);
        square += weight * w * w;
    }
    model.A(0, 0) = square > 0 ? -work / square / plant.mass_at(gap) : model.A(0, 0);
    return model;
}

}  // namespace underbody::estimator
