#include "surrogates/estimator/control/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/random.h"

namespace underbody::estimator {

namespace {

// Places of the estimates that the loop wants among those of a linear filter; -1: not given.
struct Places {
    int ground = -1, drag = -1, total = -1, gap = -1, velocity = -1;
};

Places places_in(const LinearFilter& filter) {
    const auto find = [&](const char* name) {
        const auto at = std::find(filter.estimates.begin(), filter.estimates.end(), name);
        return at == filter.estimates.end() ? -1 : static_cast<int>(at - filter.estimates.begin());
    };
    return {find("ground_force"), find("drag_force"), find("total_force"), find("gap"), find("heave_velocity")};
}

struct Seen {
    double ground = 0, drag = 0, total = 0, gap = 0, velocity = 0;
};

void check_loop(const LoopEstimator& e, const LoopOptions& o) {
    if (!(o.step > 0) || !(o.duration > o.step)) {
        throw core::InputError("range", "the loop needs a positive sample time and a duration longer than it");
    }
    const auto gives_velocity = [&] {
        return e.source == ForceSource::extended || (e.filter && places_in(*e.filter).velocity >= 0);
    };
    if (!o.velocity_measured && o.feedback != Feedback::truth &&
        !(o.feedback == Feedback::estimated && gives_velocity())) {
        throw core::InputError("missing",
                               "the feedback needs a heave velocity, and neither a sensor nor the estimator '" +
                                   e.name + "' gives one to it",
                               {}, "take the estimated feedback with extended, kalman or full");
    }
    if (e.source != ForceSource::filter) {
        return;
    }
    if (!e.filter) {
        throw core::InputError("missing", "the loop wants the forces of a filter, but there is none");
    }
    if (std::abs(e.filter->step - o.step) > 1e-9 * o.step) {
        throw core::InputError("range", "the filter runs at " + std::to_string(e.filter->step) + " s, the loop at " +
                                            std::to_string(o.step) + " s");
    }
    for (const auto& name : e.filter->measured) {
        if (name != "gap" && (name != "heave_velocity" || !o.velocity_measured)) {
            throw core::InputError(
                "name", "the loop does not measure " + name + ", which the estimator '" + e.name + "' needs");
        }
    }
}

}  // namespace

int loop_substeps(double step) { return std::max(1, static_cast<int>(std::ceil(step / 0.02))); }

// What the loop keeps between samples.
struct Loop::Impl {
    const SeparatedPlant& plant;
    const ControlLaw& law;
    const LoopEstimator& estimator;
    const LoopOptions& options;
    core::Random random;
    std::optional<FilterRunner> linear;
    std::optional<ExtendedRunner> extended;
    Places at;
    int substeps = 1;
    double gap, velocity;
    double lagged = 0, force = 0;  // of the actuator, after its lags
    std::vector<double> commands;  // one a sample
    double acted = 0;              // mean force over the last step, as a thruster model would tell the observer
    double command = 0, disturbance = 0;
    Seen seen;
    std::size_t samples = 0;

    Impl(const SeparatedPlant& p, const ControlLaw& l, const LoopEstimator& e, const LoopOptions& o, double h, double w,
         std::uint64_t stream)
        : plant(p), law(l), estimator(e), options(o), random(o.seed, stream), gap(h), velocity(w) {
        check_loop(e, o);
        substeps = loop_substeps(o.step);
        if (e.source == ForceSource::filter) {
            at = places_in(*e.filter);
            linear.emplace(*e.filter);
        } else if (e.source == ForceSource::extended) {
            extended.emplace(e.believed ? *e.believed : p, e.noise);
        }
    }

    void sense() {
        const double h = gap + (options.gap_noise > 0 ? options.gap_noise * random.normal() : 0);
        const double w = options.velocity_measured
                             ? velocity + (options.velocity_noise > 0 ? options.velocity_noise * random.normal() : 0)
                             : NAN;
        seen.gap = h;
        seen.velocity = w;
        double slope = 0;
        if (linear) {
            sense_linear(h, w);
        } else if (extended) {
            FilterEstimate e;
            if (samples == 0) {
                extended->start(h, w);
                extended->describe(extended->belief(), e);
            } else {
                extended->predict(options.step, acted, options.step * static_cast<double>(samples - 1));
                extended->measure(h, w, e);
            }
            seen = {e.ground_force, e.drag_force, e.total_force, e.gap, e.velocity};
        } else {
            seen.ground = plant.ground_force(gap, slope);
            seen.drag = plant.drag(gap, velocity);
            seen.total = seen.ground - seen.drag;
            seen.gap = h;
            seen.velocity = w;
        }
        if (options.feedback == Feedback::measured) {
            seen.gap = h;
            seen.velocity = w;
        } else if (options.feedback == Feedback::truth) {
            seen.gap = gap;
            seen.velocity = velocity;
        }
    }

    void sense_linear(double h, double w) {
        double y[FilterRunner::most_signals] = {}, e[FilterRunner::most_states] = {};
        for (std::size_t i = 0; i < estimator.filter->measured.size(); ++i) {
            y[i] = estimator.filter->measured[i] == "gap" ? h : w;
        }
        if (samples == 0) {
            linear->start(y, e);
        } else {
            linear->step(y, &acted, e);
        }
        seen.ground = at.ground >= 0 ? e[at.ground] : NAN;
        seen.drag = at.drag >= 0 ? e[at.drag] : NAN;
        seen.total = at.total >= 0 ? e[at.total] : seen.ground - seen.drag;
        seen.gap = at.gap >= 0 ? e[at.gap] : h;
        seen.velocity = at.velocity >= 0 ? e[at.velocity] : w;
    }

    void decide() {
        double u = -law.velocity_gain * seen.velocity - law.gap_gain * (seen.gap - law.reference_gap);
        if (law.cancel && estimator.source != ForceSource::none) {
            u -= seen.total;
        }
        if (law.cancel_bias) {
            u -= plant.bias;
        }
        command = std::clamp(u, -law.limit, law.limit);
    }

    /// Mean over [t, t + dt] of what dead zone and gain leave of the commands, each held over its sample, after the
    /// delay. Before the first sample nothing is commanded.
    [[nodiscard]] double arriving(double t, double dt) const {
        if (plant.actuator.delay == 0) {
            return plant.actuator.felt(command);
        }
        const double begin = t - plant.actuator.delay, end = begin + dt, step = options.step;
        double sum = 0;
        for (auto k = static_cast<long>(std::floor(begin / step + 1e-9));
             static_cast<double>(k) * step < end - 1e-9 * step; ++k) {
            const double from = std::max(begin, static_cast<double>(k) * step),
                         to = std::min(end, static_cast<double>(k + 1) * step);
            if (k >= 0) {
                sum += (to - from) *
                       plant.actuator.felt(commands[std::min(static_cast<std::size_t>(k), commands.size() - 1)]);
            }
        }
        return sum / dt;
    }

    // Moves the plant over one sample with the command held.
    void move() {
        const double dt = options.step / substeps;
        double sum = 0;
        commands.push_back(command);
        for (int i = 0; i < substeps; ++i) {
            const double t = options.step * static_cast<double>(samples) + dt * i;
            double mean = arriving(t, dt);
            // One after the other: the lag that the model declares, and that of the loop's own options.
            for (const auto& [tau, state] :
                 {std::pair{plant.actuator.lag, &lagged}, std::pair{options.actuator_lag, &force}}) {
                const double driven = mean;
                if (tau > 0) {
                    // Mean of the lagged force over the piece: exact for its impulse, and the plant is slow against it.
                    const double decay = std::exp(-dt / tau);
                    mean = driven + (*state - driven) * tau / dt * (1 - decay);
                    *state = driven + (*state - driven) * decay;
                } else {
                    *state = driven;
                }
            }
            sum += mean;
            plant.advance(gap, velocity, mean + disturbance, dt, t);
        }
        acted = sum / substeps;
        ++samples;
    }
};

Loop::Loop(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
           const LoopOptions& options, double gap, double velocity, std::uint64_t stream)
    : impl_(std::make_unique<Impl>(plant, law, estimator, options, gap, velocity, stream)) {}
Loop::~Loop() = default;

void Loop::advance() {
    impl_->disturbance = impl_->options.disturbance
                             ? impl_->options.disturbance(impl_->options.step * static_cast<double>(impl_->samples))
                             : 0;
    impl_->sense();
    impl_->decide();
    impl_->move();
}

double Loop::gap() const { return impl_->gap; }
double Loop::velocity() const { return impl_->velocity; }

namespace {

void summarise(LoopRun& run, const ControlLaw& law, bool estimates) {
    const std::size_t n = run.time.size(), tail = std::max<std::size_t>(1, n / 10);
    double mean = 0, square = 0, force = 0;
    for (std::size_t i = n - tail; i < n; ++i) {
        const double e = run.gap[i] - law.reference_gap;
        mean += e / static_cast<double>(tail);
        square += e * e / static_cast<double>(tail);
    }
    run.hold_error = mean;
    run.hold_sigma = std::sqrt(std::max(0.0, square - mean * mean));
    for (std::size_t i = n / 2; i < n && estimates; ++i) {
        const double e = run.total_estimate[i] - (run.ground_force[i] - run.drag_force[i] + run.disturbance[i]);
        force += e * e;
    }
    if (estimates) {
        run.total_force_error = std::sqrt(force / static_cast<double>(n - n / 2));
    }
}

}  // namespace

ControlLaw hold_at(double reference_gap, double virtual_mass, double pole1, double pole2) {
    ControlLaw law;
    law.reference_gap = reference_gap;
    law.velocity_gain = -virtual_mass * (pole1 + pole2);
    law.gap_gain = virtual_mass * pole1 * pole2;
    return law;
}

LoopDesign design_for(const LoopOptions& loop, double rate) {
    LoopDesign design;
    design.rate = rate;
    design.step = loop.step;
    design.gap_noise = loop.gap_noise > 0 ? loop.gap_noise : design.gap_noise;
    design.velocity_noise = loop.velocity_noise > 0 ? loop.velocity_noise : design.velocity_noise;
    design.velocity_measured = loop.velocity_measured;
    return design;
}

LoopRun close_loop(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
                   const LoopOptions& options) {
    Loop loop(plant, law, estimator, options, options.gap, options.velocity);
    const Loop::Impl& parts = loop.parts();
    LoopRun run;
    const auto samples = static_cast<std::size_t>(std::round(options.duration / options.step));
    std::size_t limited = 0;
    for (std::size_t k = 0; k <= samples; ++k) {
        double slope = 0;
        run.time.push_back(options.step * static_cast<double>(k));
        run.gap.push_back(loop.gap());
        run.velocity.push_back(loop.velocity());
        run.ground_force.push_back(plant.ground_force(loop.gap(), slope));
        run.drag_force.push_back(plant.drag(loop.gap(), loop.velocity()));
        loop.advance();
        run.command.push_back(parts.command);
        run.force.push_back(parts.acted);
        run.disturbance.push_back(parts.disturbance);
        run.ground_estimate.push_back(parts.seen.ground);
        run.drag_estimate.push_back(parts.seen.drag);
        run.total_estimate.push_back(parts.seen.total);
        limited += std::abs(parts.command) >= law.limit ? 1U : 0U;
        run.touched = run.touched || loop.gap() <= plant.contact_gap;
        if (!std::isfinite(loop.gap()) || std::abs(loop.gap()) > 1e6) {
            run.finite = false;
            break;
        }
    }
    run.saturated = static_cast<double>(limited) / static_cast<double>(run.time.size());
    summarise(run, law, estimator.source != ForceSource::none);
    return run;
}

std::vector<HoldPoint> hold_points_without_cancellation(const SeparatedPlant& plant, const ControlLaw& law) {
    const double bias = law.cancel_bias ? 0 : plant.bias;
    double slope = 0;
    const auto force = [&](double h) {
        return plant.ground_force(h, slope) + bias - law.gap_gain * (h - law.reference_gap);
    };
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
    whole.set_block(
        0, 0, model.A - model.B * [&] {
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

core::Table LoopRun::table() const {
    core::Table t;
    t.add_numbers("time", "s", time);
    t.add_numbers("gap", "m", gap);
    t.add_numbers("heave_velocity", "m/s", velocity);
    t.add_numbers("command", "N", command);
    t.add_numbers("input_force", "N", force);
    t.add_numbers("disturbance", "N", disturbance);
    t.add_numbers("ground_force", "N", ground_force);
    t.add_numbers("drag_force", "N", drag_force);
    t.add_numbers("ground_force_estimate", "N", ground_estimate);
    t.add_numbers("drag_force_estimate", "N", drag_estimate);
    t.add_numbers("total_force_estimate", "N", total_estimate);
    return t;
}

void to_json(nlohmann::json& j, const LoopRun& run) {
    j = {{"hold_error", run.hold_error}, {"hold_sigma", run.hold_sigma}, {"total_force_error", nullptr},
         {"saturated", run.saturated},   {"touched", run.touched},       {"finite", run.finite},
         {"final_gap", run.gap.back()}};
    if (run.total_force_error) {
        j["total_force_error"] = *run.total_force_error;
    }
}

}  // namespace underbody::estimator
