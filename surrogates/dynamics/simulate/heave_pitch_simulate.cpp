#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "surrogates/dynamics/plant/loop_actuator.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/heave_pitch_contact.h"
#include "surrogates/dynamics/simulate/ode.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

bool land(const HeavePitch& plant, PitchState& y, ContactState& bearing, const Surroundings& around) {
    const std::array<double, 2> gaps = plant.edge_gaps(y);
    const double deepest = std::min(gaps[0], gaps[1]);
    y[0] -= std::min(deepest, 0.0);
    int struck = 0, touching = 0;
    for (std::size_t e = 0; e < 2; ++e) {
        struck |= plant.edge_gaps(y)[e] <= 1e-8 ? 1 << e : 0;
    }
    std::array<double, 2> speeds = plant.edge_speeds(y);
    const bool strikes = ((struck & 1) && speeds[0] < -1e-7) || ((struck & 2) && speeds[1] < -1e-7);
    if (strikes) {
        y = plant.impact(y, static_cast<ContactState>(struck));
        speeds = plant.edge_speeds(y);
    }
    for (std::size_t e = 0; e < 2; ++e) {
        touching |= (struck >> e & 1) && speeds[e] <= 1e-7 ? 1 << e : 0;
    }
    bearing = plant.settle(y, static_cast<ContactState>(touching), around);
    return strikes;
}

namespace {

/// The motion as pieces of one contact state each.
class PitchFlight {
public:
    PitchFlight(const HeavePitch& plant, const TrajectoryOptions& options, const InputSignals& inputs,
                PitchTrajectory& out)
        : plant_(plant),
          options_(options),
          inputs_(plant.vertical(), inputs),
          out_(out),
          states_(4 + (plant.remembers() ? history_states : 0) + (plant.vertical().loop_has_states() ? 1 : 0)),
          actuator_(plant.vertical().terms, [this](double t, const double* y) {
              const double given = inputs_.at(t).input;
              return (std::isnan(given) ? plant_.vertical().held_input() : given) + plant_.force_command(state_of(y));
          }) {}

    void fly(const PitchState& start, double t0, core::Progress& progress);

private:
    enum Event { nose, tail, escape, settle };

    static PitchState state_of(const double* y) { return {y[0], y[1], y[2], y[3]}; }
    Surroundings around(double t, const double* y) {
        // The actuator looks at the inputs of another time: it comes before the moment's own, which share a buffer.
        const double felt = !loop_has_states() ? 0.0 : actuator_.lagged() ? y[states_ - 1] : actuator_.driven(t, y);
        Surroundings now = inputs_.at(t, plant_.remembers() ? y + 4 : nullptr);
        now.input = loop_has_states() ? felt : now.input;
        return now;
    }
    [[nodiscard]] bool loop_has_states() const { return plant_.vertical().loop_has_states(); }
    /// Tells the actuator of the loop where the motion has come to.
    void accept(double t, const double* y) {
        if (loop_has_states()) {
            std::vector<double> d(states_);
            rates(t, y, d.data());
            actuator_.accept(t, y, d.data());
        }
    }
    void rates(double t, const double* y, double* d);
    void record(double t, const double* y);
    [[nodiscard]] bool outside(const PitchState& y) const {
        return y[0] < plant_.table_lower() || y[0] > plant_.table_upper() || y[2] < plant_.pitch_lower() ||
               y[2] > plant_.pitch_upper();
    }
    Ode piece();
    Ode::Stop follow(Ode& ode, double& t, double t0);
    bool after(const Ode::Stop& stop, double t, std::vector<double>& y);

    const HeavePitch& plant_;
    const TrajectoryOptions& options_;
    RecordedInputs inputs_;
    PitchTrajectory& out_;
    std::size_t states_;  ///< four, the history force's memory, the force after the actuator's lag
    LoopActuator<4> actuator_;
    ContactState bearing_ = ContactState::free;
};

void PitchFlight::rates(double t, const double* y, double* d) {
    PitchState rate{};
    plant_.rate(state_of(y), bearing_, rate, around(t, y));
    std::copy(rate.begin(), rate.end(), d);
    if (plant_.remembers()) {
        const HistoryKernel& kernel = history_kernel();
        for (std::size_t i = 0; i < history_states; ++i) {
            d[4 + i] = -kernel.rate[i] * (y[4 + i] + plant_.centre_velocity(state_of(y)));
        }
    }
    if (loop_has_states()) {
        d[states_ - 1] =
            actuator_.lagged() ? (actuator_.driven(t, y) - y[states_ - 1]) / plant_.vertical().terms.actuator.lag : 0;
    }
}

void PitchFlight::record(double t, const double* y) {
    const PitchState state = state_of(y);
    double lift = 0, moment = 0;
    plant_.table_loads(state, around(t, y), lift, moment);
    out_.time.push_back(t);
    out_.state.push_back(state);
    out_.lift.push_back(lift);
    out_.moment.push_back(moment);
    out_.contact.push_back(bearing_);
    out_.outside.push_back(outside(state));
}

Ode PitchFlight::piece() {
    OdeProblem problem;
    problem.size = states_;
    problem.rate = [this](double t, const double* y, double* d) { rates(t, y, d); };
    problem.direction = {-1, -1, -1, -1};
    problem.events = [this](double t, const double* y, double* g) {
        const PitchState state = state_of(y);
        const std::array<double, 2> gap = plant_.edge_gaps(state);
        const std::array<double, 2> normal = plant_.normal_forces(state, bearing_, around(t, y));
        for (std::size_t e = 0; e < 2; ++e) {
            g[e] = (static_cast<int>(bearing_) >> e & 1) ? normal[e] : gap[e];
        }
        g[escape] = options_.escape_gap > 0 ? options_.escape_gap - state[0] : 1.0;
        g[settle] = 1.0;
        if (options_.stop_at_equilibrium) {
            std::vector<double> d(states_);
            rates(t, y, d.data());
            // Speeds of the body's middle and of its ends, and how fast they change.
            const double size = 0.1, speed = options_.settle_speed;
            g[settle] = (d[0] * d[0] + d[1] * d[1] + size * size * (d[2] * d[2] + d[3] * d[3])) / (speed * speed) - 1;
        }
    };
    OdeOptions options;
    options.relative = options_.tolerance;
    options.absolute.assign(states_, options_.tolerance * 1e-3);
    options.max_step = inputs_.max_step();
    if (loop_has_states() && actuator_.delayed()) {
        options.max_step =
            options.max_step > 0 ? std::min(options.max_step, actuator_.max_step()) : actuator_.max_step();
    }
    return Ode(std::move(problem), options);
}

/// Rows until the next event or the end.
Ode::Stop PitchFlight::follow(Ode& ode, double& t, double t0) {
    const double end = t0 + options_.duration, step = options_.output_step;
    // A delay looks back on the motion, which is kept in pieces much shorter than it.
    const double piece = loop_has_states() && actuator_.delayed() ? actuator_.max_step() / 8 : 1e300;
    Ode::Stop stop;
    do {
        const double next = step > 0 ? t0 + step * (std::floor((t - t0) / step * (1 + 1e-12)) + 1) : end;
        const double row = next < end - 1e-6 * step ? next : end, goal = std::min(row, t + piece);
        stop = step > 0 ? ode.advance(goal) : ode.one_step(end);
        t = stop.t;
        accept(t, ode.state());
        if (!stop.event && (step == 0 || goal == row)) {
            record(t, ode.state());
        }
    } while (!stop.event && t < end);
    return stop;
}

/// What an event does to the motion; false when it ends it.
bool PitchFlight::after(const Ode::Stop& stop, double t, std::vector<double>& y) {
    const auto note = [&](const char* kind) { out_.events.push_back({t, kind, y[0], y[1]}); };
    for (const auto& [event, name] : {std::pair{escape, "escape"}, std::pair{settle, "equilibrium"}}) {
        if (stop.which[event] != 0) {
            record(t, y.data());
            note(name);
            out_.end = name;
            return false;
        }
    }
    note(bearing_ == ContactState::free ? "contact" : "contact change");
    if (options_.stop_at_contact) {
        record(t, y.data());
        out_.end = "contact";
        return false;
    }
    const ContactState before = bearing_;
    PitchState state = state_of(y.data());
    land(plant_, state, bearing_, around(t, y.data()));
    std::copy(state.begin(), state.end(), y.begin());
    accept(t, y.data());
    if (before != ContactState::free && bearing_ == ContactState::free) {
        out_.events.back().kind = "lift_off";
    }
    if (options_.output_step == 0) {
        record(t, y.data());
    }
    return true;
}

void PitchFlight::fly(const PitchState& start, double t0, core::Progress& progress) {
    PitchState first = start;
    std::vector<double> y(states_, -plant_.centre_velocity(start));
    std::copy(start.begin(), start.end(), y.begin());
    if (loop_has_states()) {
        const std::vector<double> still(4, 0.0);
        actuator_.start(t0, y.data(), still.data());
        y.back() = actuator_.driven(t0, y.data());
    }
    land(plant_, first, bearing_, around(t0, y.data()));
    std::copy(first.begin(), first.end(), y.begin());
    record(t0, y.data());
    double t = t0;
    for (int pieces = 0; t < t0 + options_.duration; ++pieces) {
        progress.check();
        progress.report((t - t0) / options_.duration, "simulating");
        if (pieces > 5000) {
            throw core::Error("contact", "the contact chatters at t = " + core::format_number(t, 6) + " s", {},
                              "a little restitution or friction less settles it");
        }
        Ode ode = piece();
        accept(t, y.data());
        ode.start(t, y);
        const Ode::Stop stop = follow(ode, t, t0);
        y.assign(ode.state(), ode.state() + states_);
        if (!stop.event || !after(stop, t, y)) {
            return;
        }
    }
}

}  // namespace

PitchTrajectory simulate(const HeavePitch& plant, const PitchState& start, const TrajectoryOptions& options,
                         core::Progress& progress, const InputSignals& inputs) {
    for (const double part : start) {
        if (!std::isfinite(part)) {
            throw core::InputError("range", "the start of the motion is not a number that makes sense");
        }
    }
    const std::array<double, 2> gaps = plant.edge_gaps(start);
    if (std::min(gaps[0], gaps[1]) < -1e-9) {
        throw core::InputError("range",
                               "the start lies in the ground: gaps of nose and tail edge " +
                                   core::format_number(gaps[0], 4) + " m, " + core::format_number(gaps[1], 4) + " m",
                               {}, "start higher or flatter, or set [contact] gap in the model");
    }
    PitchTrajectory out;
    PitchFlight(plant, options, inputs, out).fly(start, inputs.time.empty() ? 0.0 : inputs.time.front(), progress);
    const auto beyond = std::count(out.outside.begin(), out.outside.end(), true);
    if (beyond > 0) {
        out.remarks.push_back({core::Problem::Severity::warning,
                               std::to_string(beyond) + " of " + std::to_string(out.time.size()) +
                                   " outputs lie outside the range of a force table, where it holds its end value",
                               {}});
    }
    return out;
}

core::Table PitchTrajectory::table() const {
    core::Table table;
    table.add_numbers("time", "s", time);
    const char* names[] = {"gap", "heave_velocity", "pitch", "pitch_rate"};
    const char* units[] = {"m", "m/s", "rad", "rad/s"};
    for (std::size_t i = 0; i < 4; ++i) {
        std::vector<double> column;
        for (const PitchState& y : state) {
            column.push_back(y[i]);
        }
        table.add_numbers(names[i], units[i], column);
    }
    table.add_numbers("lift_force", "N", lift);
    table.add_numbers("pitch_moment", "N m", moment);
    std::vector<std::string> words;
    std::vector<double> flags;
    for (std::size_t i = 0; i < contact.size(); ++i) {
        words.emplace_back(contact_state_name(contact[i]));
        flags.push_back(outside[i] ? 1 : 0);
    }
    table.add_text("contact", words);
    table.add_numbers("outside_table", "1", flags);
    return table;
}

core::Figure trajectory_figure(const PitchTrajectory& trajectory) {
    core::Figure figure;
    figure.title = "Heave and pitch";
    figure.x = {"time", "s"};
    figure.y = {"gap in mm, pitch in tenths of a degree", ""};
    core::FigureCurve gap{"gap, mm", trajectory.time, {}, core::palette(0)},
        pitch{"pitch (nose up), 0.1 deg", trajectory.time, {}, core::palette(1)};
    for (const PitchState& y : trajectory.state) {
        gap.y.push_back(1e3 * y[0]);
        pitch.y.push_back(572.9577951308232 * y[2]);
    }
    figure.curves = {gap, pitch};
    add_events(figure, trajectory.events, {"contact", "contact change", "lift_off", "escape", "equilibrium"});
    figure.caption = "Gap at the centre of the base and pitch (nose up) against time; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const PitchTrajectory& trajectory) {
    json = {{"end", trajectory.end},
            {"time", trajectory.time},
            {"lift_force", trajectory.lift},
            {"pitch_moment", trajectory.moment}};
    const char* names[] = {"gap", "heave_velocity", "pitch", "pitch_rate"};
    for (std::size_t i = 0; i < 4; ++i) {
        json[names[i]] = nlohmann::json::array();
        for (const PitchState& y : trajectory.state) {
            json[names[i]].push_back(y[i]);
        }
    }
    json["contact"] = nlohmann::json::array();
    for (const ContactState c : trajectory.contact) {
        json["contact"].push_back(contact_state_name(c));
    }
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
