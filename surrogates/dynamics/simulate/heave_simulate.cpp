#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/no_limit.h"
#include "core/text.h"
#include "core/told.h"
#include "surrogates/dynamics/model/simulated_columns.h"
#include "surrogates/dynamics/plant/environment.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/plant/longest_step.h"
#include "surrogates/dynamics/plant/loop_actuator.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/motion_driver.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

namespace {

constexpr double row_slack = 1e-6;        ///< of the step of the output
constexpr double lift_off_speed = 1e-12;  ///< m/s

constexpr double slowest_bounce = 1e-5;  ///< m/s: slower, the body stays on the ground

/// The heave motion as a sequence of free flights and rests on the ground.
class Flight : public MotionDriver {
public:
    Flight(const HeavePlant& plant, const HeaveRun* run, const TrajectoryOptions& options, Trajectory& out)
        : plant_(plant),
          run_(run),
          options_(options),
          out_(out),
          memory_(plant.terms.history != 0),
          actuator_(plant.terms,
                    [this](double t, const double* y) { return outside(t).input + plant_.loop->command(y[0], y[1]); }) {
        settings = {.states = 2 + (memory_ ? history_states : 0) + (plant.loop_has_states() ? 1 : 0),
                    .events = 3,
                    .duration = options.duration,
                    .output_step = options.output_step,
                    .tolerance = options.tolerance,
                    .max_step = max_step()};
        if (plant.loop_has_states() && actuator_.delayed()) {
            // A delay looks back on the motion, which is kept in pieces much shorter than it.
            settings.longest_advance = actuator_.max_step() / 8;
        }
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
                            : actuator_.lagged()      ? y[settings.states - 1]
                                                      : actuator_.driven(t, y);
        HeaveMoment m = outside(t);
        m.input = plant_.loop_has_states() ? felt : m.input;
        return m;
    }
    [[nodiscard]] const double* memory(const double* y) const { return memory_ ? y + 2 : nullptr; }
    void rates(double t, const double* y, double* rate) override;
    void events(double t, const double* y, double* g) override;
    void record(double t, const double* y) override;
    bool after(const Ode::Stop& stop, double t, std::vector<double>& y) override;
    void accept(double t, const double* y) override;
    void begin_piece(double& t, std::vector<double>& y, core::Progress& progress) override;
    [[nodiscard]] double input_force(double t, const double* y) {
        const HeaveMoment m = moment(t, y);
        return plant_.loop && !plant_.loop_has_states() ? plant_.closed_input(y[0], y[1], m.input).force : m.input;
    }
    void note(double t, const char* kind, const double* y) { out_.events.push_back({t, kind, y[0], y[1]}); }
    double rest(double t, std::vector<double>& y, core::Progress& progress);
    [[nodiscard]] double max_step() const;

    const HeavePlant& plant_;
    const HeaveRun* run_;
    const TrajectoryOptions& options_;
    Trajectory& out_;
    bool memory_;  ///< states: gap, velocity, the history force's memory, the force after the actuator's lag
    bool on_ground_ = false;
    LoopActuator<2> actuator_;
    std::vector<double> buffer_;
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
        rate[settings.states - 1] =
            actuator_.lagged() ? (actuator_.driven(t, y) - y[settings.states - 1]) / plant_.terms.actuator.lag : 0;
    }
}

void Flight::accept(double t, const double* y) {
    if (plant_.loop_has_states()) {
        std::vector<double> rate(settings.states);
        rates(t, y, rate.data());
        actuator_.accept(t, y, rate.data());
    }
}

void Flight::events(double t, const double* y, double* g) {
    g[touch] = y[0] - plant_.terms.contact_gap;
    g[escape] = options_.escape_gap > 0 ? options_.escape_gap - y[0] : 1.0;
    g[settle] = 1.0;
    if (options_.stop_at_equilibrium) {
        const double a = plant_.acceleration(y[0], y[1], moment(t, y), memory(y));
        g[settle] = unsettled(y[1] * y[1] + a * a, 0, options_.settle_speed);
    }
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
    double step = within_waves(run_ ? longest_step(run_->time()) : 0, plant_.terms);
    if (plant_.loop_has_states() && actuator_.delayed()) {
        step = step > 0 ? std::min(step, actuator_.max_step()) : actuator_.max_step();
    }
    return step;
}

/// On the ground until the force lifts the body; the end time when it never does.
double Flight::rest(double t, std::vector<double>& y, core::Progress& progress) {
    const double t_end = end();
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
    const std::vector<double> still(settings.states, 0.0);
    const auto accept_rest = [&] {
        if (plant_.loop_has_states()) {
            actuator_.accept(t, y.data(), still.data());
        }
    };
    accept_rest();
    double row = row_after(t);
    const auto record_rows = [&](double until) {
        for (; options_.output_step > 0 && row <= until; row = row_after(row)) {
            record(row, y.data());
        }
    };
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
            record_rows(hi);
            y = lying(t, hi);
            return hi;
        }
        y = lying(t, next);
        t = next;
        accept_rest();
        record_rows(t + row_slack * options_.output_step);
    }
    return t_end;
}

/// While the body lies on the ground, time goes on until it leaves.
void Flight::begin_piece(double& t, std::vector<double>& y, core::Progress& progress) {
    if (!on_ground_) {
        return;
    }
    on_ground_ = false;
    t = rest(t, y, progress);
    if (t < end()) {
        note(t, "lift_off", y.data());
        y[1] = lift_off_speed;
    }
}

bool Flight::after(const Ode::Stop& stop, double t, std::vector<double>& y) {
    const bool ends = stop.which[escape] != 0 || stop.which[settle] != 0;
    y[0] = ends ? y[0] : plant_.terms.contact_gap;  // the search for it stops within rounding
    if (ends || options_.stop_at_contact || options_.output_step == 0) {
        record(t, y.data());  // rows at a fixed step stay at that step; the event itself is among the events
    }
    const char* kind = stop.which[escape] != 0 ? "escape" : stop.which[settle] != 0 ? "equilibrium" : "contact";
    note(t, kind, y.data());
    if (ends || options_.stop_at_contact) {
        out_.end = kind;
        return false;
    }
    y[1] = -plant_.terms.restitution * y[1];
    on_ground_ = y[1] < slowest_bounce;
    y[1] = on_ground_ ? 0 : y[1];
    return true;
}

void Flight::fly(double gap, double velocity, double t0, core::Progress& progress) {
    std::vector<double> y(settings.states, -velocity);
    y[0] = gap;
    y[1] = velocity;
    if (plant_.loop_has_states()) {
        const std::vector<double> still(settings.states, 0.0);
        actuator_.start(t0, y.data(), still.data());
        y.back() = actuator_.driven(t0, y.data());
    }
    record(t0, y.data());
    out_.end = "time";
    on_ground_ =
        gap <= plant_.terms.contact_gap && velocity <= 0 && plant_.acceleration(gap, 0, moment(t0, y.data())) <= 0;
    if (on_ground_) {
        note(t0, "contact", y.data());
        if (options_.stop_at_contact) {
            out_.end = "contact";
            return;
        }
    }
    run(t0, std::move(y), progress);
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
                               "the start lies in the ground: gap " + core::told(gap, "m") +
                                   " is below the contact gap " + core::told(plant.terms.contact_gap, "m"),
                               {model.name, {}, {}, {}}, "start above it, or set [contact] gap in the model");
    }
    const std::unique_ptr<HeaveRun> run = inputs.signals.empty() ? nullptr : std::make_unique<HeaveRun>(plant, inputs);
    Trajectory out;
    out.remarks = motion_remarks(model, inputs.held);
    const double t0 = inputs.time.empty() ? 0.0 : inputs.time.front();
    Flight(plant, run.get(), options, out).fly(gap, heave_velocity, t0, progress);
    remark_outside(out.remarks, out.outside,
                   " (gap " + core::told_range(plant.terms.table_lower, plant.terms.table_upper, "m") + ")");
    if (run && !out.time.empty() && out.time.back() > inputs.time.back() + same_instant) {
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
    table.add_numbers(heave_drag_column, "N", heave_drag);
    table.add_numbers("input_force", "N", input_force);
    add_outside(table, outside);
    return table;
}

core::Figure trajectory_figure(const Trajectory& trajectory, const std::vector<HeaveEquilibrium>& equilibria) {
    core::Figure figure;
    figure.title = "Heave motion";
    figure.x = {"time", "s"};
    figure.y = {"gap", "mm"};
    core::FigureCurve gap{"gap", trajectory.time, {}, core::palette(0)};
    constexpr double beside = 0.2;  // of the range of gaps: equilibria that are drawn
    double lowest = core::no_limit, highest = -core::no_limit;
    for (const double h : trajectory.gap) {
        gap.y.push_back(1e3 * h);
        lowest = std::min(lowest, h);
        highest = std::max(highest, h);
    }
    figure.curves.push_back(std::move(gap));
    for (const HeaveEquilibrium& e : equilibria) {
        if (e.gap > lowest - beside * (highest - lowest) && e.gap < highest + beside * (highest - lowest)) {
            figure.lines.push_back({false, 1e3 * e.gap, e.name + (e.stable ? " (stable)" : " (unstable)")});
        }
    }
    add_events(figure, trajectory.events, {"contact", "lift_off", "escape", "equilibrium"});
    figure.caption = "Gap against time; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const Trajectory& trajectory) {
    write_table(json, trajectory.end, trajectory.table());
    write_events(json, trajectory.events, true);
    write_remarks(json, trajectory.outside, trajectory.remarks);
}

}  // namespace underbody::dynamics
