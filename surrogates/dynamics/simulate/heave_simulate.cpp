#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/plant/environment.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/plant/loop_actuator.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/ode.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

namespace {

/// The heave motion as a sequence of free flights and rests on the ground.
class Flight {
public:
    Flight(const HeavePlant& plant, const HeaveRun* run, const TrajectoryOptions& options, Trajectory& out)
        : plant_(plant),
          run_(run),
          options_(options),
          out_(out),
          memory_(plant.terms.history != 0),
          states_(2 + (memory_ ? history_states : 0) + (plant.loop_has_states() ? 1 : 0)),
          actuator_(plant.terms,
                    [this](double t, const double* y) { return outside(t).input + plant_.loop->command(y[0], y[1]); }) {
    }

    void fly(double gap, double velocity, double t0, core::Progress& progress);

private:
    enum Event { touch, escape, settle };

    /// What comes from outside; with a loop its input is what is commanded beside the feedback.
    HeaveMoment outside(double t) {
        HeaveMoment m = plant_.held_moment(t);
        if (run_) {
            run_->moment(t, m, buffer_);
        }
        return m;
    }
    /// What acts at a moment in a state.
    HeaveMoment moment(double t, const double* y) {
        // The actuator looks at the inputs of another time: it comes before the moment's own, which share a buffer.
        const double felt = !plant_.loop_has_states() ? 0.0
                            : actuator_.lagged()      ? y[states_ - 1]
                                                      : actuator_.driven(t, y);
        HeaveMoment m = outside(t);
        m.input = plant_.loop_has_states() ? felt : m.input;
        return m;
    }
    [[nodiscard]] const double* memory(const double* y) const { return memory_ ? y + 2 : nullptr; }
    void rates(double t, const double* y, double* rate);
    enum class At { start, rest, flight };
    void accept(double t, const double* y, At at);
    Ode::Stop go_to(Ode& ode, double from, double goal);
    [[nodiscard]] double input_force(double t, const double* y) {
        const HeaveMoment m = moment(t, y);
        return plant_.loop && !plant_.loop_has_states() ? plant_.closed_input(y[0], y[1], m.input).force : m.input;
    }
    void record(double t, const double* y);
    void note(double t, const char* kind, const double* y) { out_.events.push_back({t, kind, y[0], y[1]}); }
    std::unique_ptr<Ode> free_flight();
    double rest(double t, double t_end, std::vector<double>& y, core::Progress& progress);
    [[nodiscard]] double max_step() const;

    const HeavePlant& plant_;
    const HeaveRun* run_;
    const TrajectoryOptions& options_;
    Trajectory& out_;
    bool memory_;
    std::size_t states_;  ///< gap, velocity, the history force's memory, the force after the actuator's lag
    LoopActuator<2> actuator_;
    std::vector<double> buffer_;
    double next_output_ = 0;
};

void Flight::rates(double t, const double* y, double* rate) {
    rate[0] = y[1];
    rate[1] = plant_.acceleration(y[0], y[1], moment(t, y), memory(y));
    if (memory_) {
        const HistoryKernel& kernel = history_kernel();
        for (std::size_t i = 0; i < history_states; ++i) {
            rate[2 + i] = -kernel.rate[i] * (y[2 + i] + y[1]);
        }
    }
    if (plant_.loop_has_states()) {
        rate[states_ - 1] =
            actuator_.lagged() ? (actuator_.driven(t, y) - y[states_ - 1]) / plant_.terms.actuator.lag : 0;
    }
}

/// Tells the actuator of the loop where the motion has come to.
void Flight::accept(double t, const double* y, At at) {
    if (!plant_.loop_has_states()) {
        return;
    }
    std::vector<double> rate(states_, 0.0);
    if (at == At::start) {
        actuator_.start(t, y, rate.data());
        return;
    }
    if (at == At::flight) {
        rates(t, y, rate.data());
    }
    actuator_.accept(t, y, rate.data());
}

/// To `goal` or an event; a delay looks back on the motion, which is kept in pieces much shorter than it.
Ode::Stop Flight::go_to(Ode& ode, double from, double goal) {
    const double piece =
        plant_.loop_has_states() && actuator_.delayed() ? actuator_.max_step() / 8 : std::numeric_limits<double>::max();
    Ode::Stop stop;
    do {
        const double next = std::min(goal, from + piece);
        stop = options_.output_step > 0 ? ode.advance(next) : ode.one_step(next);
        accept(stop.t, ode.state(), At::flight);
        from = stop.t;
    } while (!stop.event && options_.output_step > 0 && stop.t < goal);
    return stop;
}

void Flight::record(double t, const double* y) {
    const HeaveMoment m = outside(t);
    out_.time.push_back(t);
    out_.gap.push_back(y[0]);
    out_.heave_velocity.push_back(y[1]);
    out_.lift_force.push_back(plant_.lift(y[0], m, y[1]));
    out_.heave_drag.push_back(plant_.resistance(y[0], y[1]));
    out_.input_force.push_back(input_force(t, y));
    out_.outside.push_back(y[0] < plant_.terms.table_lower || y[0] > plant_.terms.table_upper);
}

double Flight::max_step() const {
    // Recorded inputs have corners that the integrator must not step over.
    double step = 0;
    if (run_) {
        step = 1e300;
        for (std::size_t i = 0; i + 1 < run_->samples(); ++i) {
            step = std::min(step, run_->time()[i + 1] - run_->time()[i]);
        }
    }
    for (const HeaveTerms::Wave& wave : plant_.terms.waves) {
        const double period = 0.1 / std::max(wave.frequency, 1e-9);
        step = step > 0 ? std::min(step, period) : period;
    }
    if (plant_.loop_has_states() && actuator_.delayed()) {
        step = step > 0 ? std::min(step, actuator_.max_step()) : actuator_.max_step();
    }
    return step;
}

std::unique_ptr<Ode> Flight::free_flight() {
    OdeProblem problem;
    problem.size = states_;
    problem.rate = [this](double t, const double* y, double* rate) { rates(t, y, rate); };
    problem.direction = {-1, -1, -1};
    problem.events = [this](double t, const double* y, double* g) {
        g[touch] = y[0] - plant_.terms.contact_gap;
        g[escape] = options_.escape_gap > 0 ? options_.escape_gap - y[0] : 1.0;
        g[settle] = 1.0;
        if (options_.stop_at_equilibrium) {
            const double a = plant_.acceleration(y[0], y[1], moment(t, y), memory(y));
            const double speed = options_.settle_speed;
            g[settle] = (y[1] * y[1] + a * a) / (speed * speed) - 1;
        }
    };
    OdeOptions options;
    options.relative = options_.tolerance;
    options.absolute.assign(states_, options_.tolerance * 1e-3);
    options.max_step = max_step();
    return std::make_unique<Ode>(std::move(problem), options);
}

/// On the ground until the force lifts the body; the end time when it never does.
double Flight::rest(double t, double t_end, std::vector<double>& y, core::Progress& progress) {
    y[0] = plant_.terms.contact_gap;
    y[1] = 0;
    // While the body lies still, what its actuator gives goes on.
    const auto lying = [&](double from, double at) {
        std::vector<double> state = y;
        if (plant_.loop_has_states() && actuator_.lagged()) {
            const double driven = actuator_.driven(at, y.data());
            state.back() = driven + (y.back() - driven) * std::exp(-(at - from) / plant_.terms.actuator.lag);
        }
        return state;
    };
    const auto force = [&](double from, double at) {
        const std::vector<double> state = lying(from, at);
        return plant_.acceleration(y[0], 0.0, moment(at, state.data()));
    };
    accept(t, y.data(), At::rest);
    const double output = options_.output_step > 0 ? options_.output_step : std::max((t_end - t) / 200, 1e-3);
    const double look = std::min(output, run_ || !plant_.autonomous() ? 0.01 : output);
    while (t < t_end) {
        progress.check();
        if (plant_.autonomous() && !run_ && force(t, t) <= 0 && options_.output_step == 0) {
            record(t_end, y.data());
            return t_end;
        }
        double next = std::min(t_end, t + look);
        if (force(t, next) > 0) {
            double lo = t, hi = next;
            for (int i = 0; i < 60; ++i) {
                const double middle = (lo + hi) / 2;
                (force(t, middle) > 0 ? hi : lo) = middle;
            }
            y = lying(t, hi);
            return hi;
        }
        y = lying(t, next);
        t = next;
        accept(t, y.data(), At::rest);
        while (options_.output_step > 0 && next_output_ <= t + 1e-6 * options_.output_step) {
            record(next_output_, y.data());
            next_output_ =
                out_.time.front() +
                options_.output_step * std::round((next_output_ - out_.time.front()) / options_.output_step + 1);
        }
    }
    return t_end;
}

void Flight::fly(double gap, double velocity, double t0, core::Progress& progress) {
    const double t_end = t0 + options_.duration;
    const double start = t0;
    std::vector<double> y(states_, -velocity);
    y[0] = gap;
    y[1] = velocity;
    accept(t0, y.data(), At::start);
    if (plant_.loop_has_states()) {
        y.back() = actuator_.driven(t0, y.data());
    }
    record(t0, y.data());
    next_output_ = t0 + options_.output_step;
    double t = t0;
    out_.end = "time";
    const std::unique_ptr<Ode> ode = free_flight();
    bool on_ground =
        gap <= plant_.terms.contact_gap && velocity <= 0 && plant_.acceleration(gap, 0, moment(t, y.data())) <= 0;
    if (on_ground) {
        note(t, "contact", y.data());
        if (options_.stop_at_contact) {
            out_.end = "contact";
            return;
        }
    }
    while (t < t_end) {
        if (on_ground) {
            t = rest(t, t_end, y, progress);
            on_ground = false;
            if (t < t_end) {
                note(t, "lift_off", y.data());
                y[1] = 1e-12;
            } else {
                break;
            }
        }
        ode->start(t, y);
        accept(t, y.data(), At::flight);
        Ode::Stop stop;
        stop.t = t;
        int count = 0;
        do {
            // An output that rounding puts a hair before the end is the end.
            const bool more = options_.output_step > 0 && next_output_ < t_end - 1e-6 * options_.output_step;
            const double goal = more ? next_output_ : t_end;
            stop = go_to(*ode, stop.t, goal);
            if (++count % 256 == 0) {
                progress.check();
                progress.report((stop.t - start) / options_.duration, "simulating");
            }
            if (!stop.event) {
                record(stop.t, ode->state());
                if (options_.output_step > 0) {
                    next_output_ =
                        start + options_.output_step * std::round((stop.t - start) / options_.output_step + 1);
                }
            }
        } while (!stop.event && stop.t < t_end);
        t = stop.t;
        y.assign(ode->state(), ode->state() + states_);
        if (!stop.event) {
            break;
        }
        const bool ends = stop.which[escape] != 0 || stop.which[settle] != 0 || options_.stop_at_contact;
        if (ends || options_.output_step == 0) {
            record(t, y.data());  // rows at a fixed step stay at that step; the event itself is among the events
        }
        if (stop.which[escape] != 0 || stop.which[settle] != 0) {
            out_.end = stop.which[escape] != 0 ? "escape" : "equilibrium";
            note(t, out_.end.c_str(), y.data());
            return;
        }
        note(t, "contact", y.data());
        if (options_.stop_at_contact) {
            out_.end = "contact";
            return;
        }
        y[0] = plant_.terms.contact_gap;
        y[1] = -plant_.terms.restitution * y[1];
        on_ground = y[1] < 1e-5;
        if (on_ground) {
            y[1] = 0;
        }
    }
}

}  // namespace

HeavePlant plant_for(const Model& model, const InputSignals& inputs) {
    return HeavePlant(model, inputs.held, varying_channels(inputs));
}

Trajectory simulate(const Model& model, double gap, double heave_velocity, const InputSignals& inputs,
                    const TrajectoryOptions& options, core::Progress& progress, const HeaveFeedback* feedback) {
    if (!std::isfinite(gap) || !std::isfinite(heave_velocity) || !(options.duration > 0)) {
        throw core::InputError("range", "the start or the duration of the motion is not a number that makes sense");
    }
    HeavePlant plant = plant_for(model, inputs);
    if (feedback) {
        close_loop(plant, *feedback);
    }
    if (gap < plant.terms.contact_gap) {
        throw core::InputError("range",
                               "the start lies in the ground: gap " + core::format_number(gap) +
                                   " m is below the contact gap " + core::format_number(plant.terms.contact_gap) + " m",
                               {model.name, {}, {}, {}}, "start above it, or set [contact] gap in the model");
    }
    const std::unique_ptr<HeaveRun> run = inputs.signals.empty() ? nullptr : std::make_unique<HeaveRun>(plant, inputs);
    Trajectory out;
    out.remarks = model.remarks;
    for (core::Problem& remark : effects_without_motion(model)) {
        out.remarks.push_back(std::move(remark));
    }
    for (core::Problem& remark : held_outside(model, inputs.held.over(model.conditions))) {
        out.remarks.push_back(std::move(remark));
    }
    const double t0 = inputs.time.empty() ? 0.0 : inputs.time.front();
    Flight(plant, run.get(), options, out).fly(gap, heave_velocity, t0, progress);
    const auto beyond = std::count(out.outside.begin(), out.outside.end(), true);
    if (beyond > 0) {
        out.remarks.push_back(
            {core::Problem::Severity::warning,
             std::to_string(beyond) + " of " + std::to_string(out.time.size()) +
                 " outputs lie outside the range of a force table (" + core::format_number(plant.terms.table_lower, 6) +
                 " to " + core::format_number(plant.terms.table_upper, 6) + " m), where it holds its end value",
             {}});
    }
    if (run && !out.time.empty() && out.time.back() > inputs.time.back() + 1e-9) {
        out.remarks.push_back(
            {core::Problem::Severity::warning,
             "the inputs end at " + core::format_number(inputs.time.back(), 6) + " s; their last values are held",
             {}});
    }
    return out;
}

core::Table Trajectory::table() const {
    core::Table table;
    table.add_numbers("time", "s", time);
    table.add_numbers("gap", "m", gap);
    table.add_numbers("heave_velocity", "m/s", heave_velocity);
    table.add_numbers("lift_force", "N", lift_force);
    table.add_numbers("heave_drag", "N", heave_drag);
    table.add_numbers("input_force", "N", input_force);
    std::vector<double> flags;
    for (const bool flag : outside) {
        flags.push_back(flag ? 1 : 0);
    }
    table.add_numbers("outside_table", "1", flags);
    return table;
}

core::Figure trajectory_figure(const Trajectory& trajectory, const std::vector<HeaveEquilibrium>& equilibria) {
    core::Figure figure;
    figure.title = "Heave motion";
    figure.x = {"time", "s"};
    figure.y = {"gap", "mm"};
    core::FigureCurve gap{"gap", trajectory.time, {}, core::palette(0)};
    double lowest = 1e300, highest = -1e300;
    for (const double h : trajectory.gap) {
        gap.y.push_back(1e3 * h);
        lowest = std::min(lowest, h);
        highest = std::max(highest, h);
    }
    figure.curves.push_back(std::move(gap));
    for (const HeaveEquilibrium& e : equilibria) {
        if (e.gap > lowest - 0.2 * (highest - lowest) && e.gap < highest + 0.2 * (highest - lowest)) {
            figure.lines.push_back({false, 1e3 * e.gap, e.name + (e.stable ? " (stable)" : " (unstable)")});
        }
    }
    add_events(figure, trajectory.events, {"contact", "lift_off", "escape", "equilibrium"});
    figure.caption = "Gap against time; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const Trajectory& trajectory) {
    json = {{"end", trajectory.end},
            {"time", trajectory.time},
            {"gap", trajectory.gap},
            {"heave_velocity", trajectory.heave_velocity},
            {"lift_force", trajectory.lift_force},
            {"heave_drag", trajectory.heave_drag},
            {"input_force", trajectory.input_force}};
    json["events"] = nlohmann::json::array();
    for (const TrajectoryEvent& event : trajectory.events) {
        json["events"].push_back(
            {{"time", event.time}, {"kind", event.kind}, {"gap", event.gap}, {"heave_velocity", event.velocity}});
    }
    json["outside_table"] = std::count(trajectory.outside.begin(), trajectory.outside.end(), true);
    json["remarks"] = nlohmann::json::array();
    for (const core::Problem& remark : trajectory.remarks) {
        json["remarks"].push_back(remark.message);
    }
}

}  // namespace underbody::dynamics
