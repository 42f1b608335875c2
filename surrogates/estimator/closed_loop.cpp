#include "surrogates/estimator/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/parallel.h"
#include "core/random.h"

namespace underbody::estimator {

namespace {

// What the loop keeps between samples.
struct Loop {
    const SeparatedPlant& plant;
    const ControlLaw& law;
    ForceSource source;
    const LoopOptions& options;
    std::optional<FilterRunner> runner;
    std::vector<int> sensors;  // 0: velocity, 1: gap
    int ground = -1, drag = -1, total = -1;
    int substeps = 1;

    Loop(const SeparatedPlant& p, const ControlLaw& l, ForceSource s, const std::optional<LinearFilter>& filter, const LoopOptions& o)
        : plant(p), law(l), source(s), options(o) {
        substeps = std::max(1, static_cast<int>(std::ceil(o.step / 0.02)));
        if (!filter) {
            if (s == ForceSource::filter) {
                throw core::InputError("missing", "the loop wants the forces of a filter, but there is none");
            }
            return;
        }
        if (std::abs(filter->step - o.step) > 1e-9 * o.step) {
            throw core::InputError("range", "the filter runs at " + std::to_string(filter->step) + " s, the loop at " +
                                                std::to_string(o.step) + " s");
        }
        for (const auto& name : filter->measured) {
            if (name != "heave_velocity" && name != "gap") {
                throw core::InputError("name", "the loop measures heave_velocity and gap, not " + name);
            }
            sensors.push_back(name == "gap" ? 1 : 0);
        }
        const auto find = [&](const char* name) {
            const auto at = std::find(filter->estimates.begin(), filter->estimates.end(), name);
            return at == filter->estimates.end() ? -1 : static_cast<int>(at - filter->estimates.begin());
        };
        ground = find("ground_force");
        drag = find("drag_force");
        total = find("total_force");
        runner.emplace(*filter);
    }
};

struct State {
    double gap, velocity, force = 0;  // force: of the actuator, after its lag
};

// Moves the plant over one sample with the command held.
void advance(const Loop& loop, State& s, double command, double disturbance) {
    const double dt = loop.options.step / loop.substeps;
    for (int i = 0; i < loop.substeps; ++i) {
        double mean = command;
        if (loop.options.actuator_lag > 0) {
            // Mean of the lagged force over the piece: exact for its impulse, and the plant is slow against it.
            const double tau = loop.options.actuator_lag, decay = std::exp(-dt / tau);
            mean = command + (s.force - command) * tau / dt * (1 - decay);
            s.force = command + (s.force - command) * decay;
        } else {
            s.force = command;
        }
        loop.plant.advance(s.gap, s.velocity, mean + disturbance, dt);
    }
}

struct Estimates {
    double ground = 0, drag = 0, total = 0;
};

// One sample: sense, estimate, command. Returns what the law asks for.
template <typename Random>
double command_of(Loop& loop, const State& s, double last_force, bool first, Random* random, Estimates& estimates) {
    const double w = s.velocity + (random != nullptr ? loop.options.velocity_noise * random->normal() : 0);
    const double h = s.gap + (random != nullptr ? loop.options.gap_noise * random->normal() : 0);
    double slope = 0;
    if (loop.runner) {
        double y[FilterRunner::most_signals] = {}, e[FilterRunner::most_states] = {};
        for (std::size_t i = 0; i < loop.sensors.size(); ++i) {
            y[i] = loop.sensors[i] == 1 ? h : w;
        }
        if (first) {
            loop.runner->start(y, e);
        } else {
            loop.runner->step(y, &last_force, e);
        }
        estimates.ground = loop.ground >= 0 ? e[loop.ground] : NAN;
        estimates.drag = loop.drag >= 0 ? e[loop.drag] : NAN;
        estimates.total = loop.total >= 0 ? e[loop.total] : estimates.ground - estimates.drag;
    } else {
        estimates.ground = loop.plant.ground_force(s.gap, slope);
        estimates.drag = loop.plant.drag_force(s.velocity, slope);
        estimates.total = estimates.ground - estimates.drag;
    }
    const bool noisy = loop.options.noisy_feedback;
    double u = -loop.law.velocity_gain * (noisy ? w : s.velocity) -
               loop.law.gap_gain * ((noisy ? h : s.gap) - loop.law.reference_gap);
    if (loop.law.cancel && loop.source != ForceSource::none) {
        u -= estimates.total;
    }
    if (loop.law.cancel_bias) {
        u -= loop.plant.bias;
    }
    return std::clamp(u, -loop.law.limit, loop.law.limit);
}

void summarise(LoopRun& run, const ControlLaw& law) {
    const std::size_t n = run.time.size(), tail = std::max<std::size_t>(1, n / 10);
    double mean = 0, square = 0, force = 0;
    for (std::size_t i = n - tail; i < n; ++i) {
        const double e = run.gap[i] - law.reference_gap;
        mean += e / static_cast<double>(tail);
        square += e * e / static_cast<double>(tail);
    }
    run.hold_error = mean;
    run.hold_sigma = std::sqrt(std::max(0.0, square - mean * mean));
    for (std::size_t i = n / 2; i < n; ++i) {
        const double e = run.total_estimate[i] - (run.ground_force[i] - run.drag_force[i]);
        force += e * e;
    }
    run.total_force_error = std::sqrt(force / static_cast<double>(n - n / 2));
}

}  // namespace

ControlLaw hold_at(double reference_gap, double virtual_mass, double pole1, double pole2) {
    ControlLaw law;
    law.reference_gap = reference_gap;
    law.velocity_gain = -virtual_mass * (pole1 + pole2);
    law.gap_gain = virtual_mass * pole1 * pole2;
    return law;
}

LoopRun close_loop(const SeparatedPlant& plant, const ControlLaw& law, ForceSource source, const std::optional<LinearFilter>& filter,
                   const LoopOptions& options) {
    if (!(options.step > 0) || !(options.duration > options.step)) {
        throw core::InputError("range", "the loop needs a positive sample time and a duration longer than it");
    }
    Loop loop(plant, law, source, filter, options);
    core::Random random(options.seed);
    const bool noise = options.velocity_noise > 0 || options.gap_noise > 0;
    State s{options.gap, options.velocity};
    LoopRun run;
    const auto samples = static_cast<std::size_t>(std::round(options.duration / options.step));
    double last = 0;
    std::size_t limited = 0;
    for (std::size_t k = 0; k <= samples; ++k) {
        const double t = options.step * static_cast<double>(k);
        Estimates e;
        const double u = command_of(loop, s, last, k == 0, noise ? &random : nullptr, e);
        const double d = options.disturbance ? options.disturbance(t) : 0;
        double slope = 0;
        run.time.push_back(t);
        run.gap.push_back(s.gap);
        run.velocity.push_back(s.velocity);
        run.command.push_back(u);
        run.force.push_back(s.force);
        run.disturbance.push_back(d);
        run.ground_force.push_back(plant.ground_force(s.gap, slope));
        run.drag_force.push_back(plant.drag_force(s.velocity, slope));
        run.ground_estimate.push_back(e.ground);
        run.drag_estimate.push_back(e.drag);
        run.total_estimate.push_back(e.total);
        limited += std::abs(u) >= law.limit ? 1U : 0U;
        const double before = s.force;
        advance(loop, s, u, d);
        // The observer is told the mean force that acted, as a thruster model would.
        last = options.actuator_lag > 0
                   ? u + (before - u) * options.actuator_lag / options.step * (1 - std::exp(-options.step / options.actuator_lag))
                   : u;
        run.touched = run.touched || s.gap <= plant.contact_gap;
        if (!std::isfinite(s.gap) || std::abs(s.gap) > 1e6) {
            run.finite = false;
            break;
        }
    }
    run.saturated = static_cast<double>(limited) / static_cast<double>(run.time.size());
    summarise(run, law);
    return run;
}

std::vector<HoldPoint> hold_points_without_cancellation(const SeparatedPlant& plant, const ControlLaw& law) {
    const double bias = law.cancel_bias ? 0 : plant.bias;
    double slope = 0;
    const auto force = [&](double h) { return plant.ground_force(h, slope) + bias - law.gap_gain * (h - law.reference_gap); };
    std::vector<HoldPoint> points;
    const int n = 20000;
    const double lower = std::max(plant.lower, plant.contact_gap), upper = plant.upper;
    double h0 = lower, f0 = force(lower);
    for (int i = 1; i <= n; ++i) {
        const double h1 = lower + (upper - lower) * i / n;
        const double f1 = force(h1);
        if ((f0 < 0) != (f1 < 0)) {
            double a = h0, b = h1;
            const bool falls = f0 > f1;
            for (int k = 0; k < 80; ++k) {
                const double m = 0.5 * (a + b);
                ((force(m) > 0) == falls ? a : b) = m;
            }
            points.push_back({0.5 * (a + b), falls});
        }
        h0 = h1;
        f0 = f1;
    }
    return points;
}

Separation separation(const AugmentedModel& model, const ControlLaw& law, const Matrix& gain) {
    const std::size_t nx = model.layout.measured, n = model.layout.states.size(), nz = n - nx;
    const std::size_t w = model.state("heave_velocity"), h = model.state("gap");
    Matrix k_x(1, nx), k_zeta(1, nz);
    k_x(0, w) = law.velocity_gain;
    k_x(0, h) = law.gap_gain;
    const double b = model.B(w, 0);
    for (std::size_t j = 0; j < nz; ++j) {
        k_zeta(0, j) = law.cancel ? model.a_zeta()(w, j) / b : 0;
    }
    Separation out;
    // Plant (x, zeta) under u = -K_x x - K_zeta zeta_hat, with zeta_hat = zeta - e.
    Matrix feedback(1, n);
    feedback.set_block(0, 0, k_x);
    feedback.set_block(0, nx, k_zeta);
    const Matrix closed = model.A - model.B * feedback;
    const Matrix error = model.j_zeta() - gain * model.a_zeta();
    out.controller = eigenvalues(closed);
    out.observer = eigenvalues(error);
    // The same loop written with the estimate as a state: nothing of the triangular form is assumed.
    Matrix whole(n + nz, n + nz);
    whole.set_block(0, 0, model.A - model.B * [&] {
        Matrix only_x(1, n);
        only_x.set_block(0, 0, k_x);
        return only_x;
    }());
    whole.set_block(0, n, -1.0 * (model.B * k_zeta));
    // d zeta_hat = J_x x + J_z zeta_hat + J_u u + L (dx - A_x x - B u - A_z zeta_hat), dx of the truth
    const Matrix into_x = model.j_x() - model.j_u() * k_x;
    whole.set_block(n, 0, into_x);
    whole.set_block(n, nx, gain * model.a_zeta());
    whole.set_block(n, n, model.j_zeta() - model.j_u() * k_zeta - gain * model.a_zeta());
    out.loop = eigenvalues(whole);
    Poles both = out.controller;
    both.insert(both.end(), out.observer.begin(), out.observer.end());
    for (const auto& pole : out.loop) {
        const auto nearest = std::min_element(both.begin(), both.end(), [&](const auto& p, const auto& q) {
            return std::abs(p - pole) < std::abs(q - pole);
        });
        out.mismatch = std::max(out.mismatch, std::abs(*nearest - pole));
        both.erase(nearest);
    }
    return out;
}

LoopRegion loop_region(const SeparatedPlant& plant, const ControlLaw& law, ForceSource source,
                       const std::optional<LinearFilter>& filter, const LoopOptions& options, std::size_t columns, std::size_t rows,
                       double gap_lower, double gap_upper, double velocity_lower, double velocity_upper, core::Progress& progress) {
    LoopRegion region{columns, rows, gap_lower, gap_upper, velocity_lower, velocity_upper, std::vector<int>(columns * rows), 0};
    const auto samples = static_cast<std::size_t>(std::round(options.duration / options.step));
    const double near = 0.02 * (gap_upper - gap_lower), far = gap_upper + (gap_upper - gap_lower);
    core::parallel_for(
        columns * rows,
        [&](std::size_t cell) {
            Loop loop(plant, law, source, filter, options);
            State s{gap_lower + (gap_upper - gap_lower) * (static_cast<double>(cell % columns) + .5) / static_cast<double>(columns),
                    velocity_lower +
                        (velocity_upper - velocity_lower) * (static_cast<double>(cell / columns) + .5) / static_cast<double>(rows)};
            double last = 0;
            int end = -1;
            std::size_t still = 0;
            for (std::size_t k = 0; k < samples && end < 0; ++k) {
                Estimates e;
                last = command_of<core::Random>(loop, s, last, k == 0, nullptr, e);
                advance(loop, s, last, 0);
                still = std::abs(s.velocity) < 1e-5 ? still + 1 : 0;
                if (s.gap <= plant.contact_gap) {
                    end = 2;
                } else if (!std::isfinite(s.gap) || s.gap > far) {
                    end = 3;
                } else if (static_cast<double>(still) * options.step > 2) {
                    end = std::abs(s.gap - law.reference_gap) < near ? 0 : 1;
                }
            }
            if (end < 0) {
                end = std::abs(s.gap - law.reference_gap) < near ? 0 : 4;
            }
            region.index[cell] = end;
        },
        progress);
    region.holds = static_cast<double>(std::count(region.index.begin(), region.index.end(), 0)) /
                   static_cast<double>(region.index.size());
    return region;
}

core::Figure LoopRegion::figure(const std::string& title) const {
    core::Figure f;
    f.title = title;
    f.x = {"gap", "mm", 1e3 * gap_lower, 1e3 * gap_upper};
    f.y = {"heave velocity", "mm/s", 1e3 * velocity_lower, 1e3 * velocity_upper};
    core::FigureClasses classes;
    classes.columns = columns;
    classes.rows = rows;
    classes.x_lower = f.x.lower;
    classes.x_upper = f.x.upper;
    classes.y_lower = f.y.lower;
    classes.y_upper = f.y.upper;
    classes.index = index;
    classes.names = {"holds", "parks elsewhere", "touches the ground", "escapes", "undecided"};
    for (const std::size_t c : {2U, 0U, 5U, 1U, 7U}) {
        classes.colours.push_back(core::palette(c));
    }
    f.classes.push_back(classes);
    return f;
}

core::Table LoopRun::table() const {
    core::Table t;
    t.add_numbers("time", "s", time);
    t.add_numbers("gap", "m", gap);
    t.add_numbers("heave_velocity", "m/s", velocity);
    t.add_numbers("input_force", "N", command);
    t.add_numbers("disturbance", "N", disturbance);
    t.add_numbers("ground_force", "N", ground_force);
    t.add_numbers("drag_force", "N", drag_force);
    t.add_numbers("ground_force_estimate", "N", ground_estimate);
    t.add_numbers("drag_force_estimate", "N", drag_estimate);
    t.add_numbers("total_force_estimate", "N", total_estimate);
    return t;
}

void to_json(nlohmann::json& j, const LoopRun& run) {
    j = {{"hold_error", run.hold_error},
         {"hold_sigma", run.hold_sigma},
         {"total_force_error", run.total_force_error},
         {"saturated", run.saturated},
         {"touched", run.touched},
         {"finite", run.finite},
         {"final_gap", run.gap.back()}};
}

}  // namespace underbody::estimator
