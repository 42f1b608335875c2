#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "surrogates/dynamics/simulate/ode.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

namespace {

constexpr double touching_gap = 1e-9;    ///< m
constexpr double touching_speed = 1e-7;  ///< m/s

/// Motion in pieces of one contact state each. States: the ten of the body, the thrusts of jets with a lag, the memory
/// of the history force.
class BodyFlight {
public:
    BodyFlight(const RigidBody& body, const JetCommand& command, const BodyOptions& options, const InputSignals& inputs,
               BodyTrajectory& out)
        : body_(body), command_(command), options_(options), inputs_(body.vertical(), inputs), out_(out) {
        for (std::size_t i = 0; i < body.jets().size(); ++i) {
            out_.jets.push_back(body.jets()[i].name);
            if (body.jets()[i].lag > 0) {
                lagged_.push_back(i);
            }
        }
        memory_at_ = 10 + lagged_.size();
        states_ = memory_at_ + (body.remembers() ? history_states : 0);
    }

    /// Takes the controller's next sample.
    void sample(double t, const BodyState& y) {
        sampled_.clear();
        if (options_.command_step > 0 && command_) {
            sampled_ = commanded(t, y);
        }
    }
    void fly(const BodyState& start, double t0, core::Progress& progress);

private:
    enum Event { nose, tail, escape, settle };

    static BodyState body_of(const double* y) {
        BodyState state{};
        std::copy(y, y + state.size(), state.begin());
        return state;
    }
    Surroundings around(double t, const double* y) {
        return inputs_.at(t, body_.remembers() ? y + memory_at_ : nullptr);
    }
    std::vector<double> commanded(double t, const BodyState& y) const {
        if (!sampled_.empty()) {
            return sampled_;
        }
        std::vector<double> thrust = command_ ? command_(t, y) : std::vector<double>{};
        thrust.resize(body_.jets().size(), 0.0);
        for (std::size_t i = 0; i < thrust.size(); ++i) {
            thrust[i] = std::clamp(thrust[i], body_.jets()[i].minimum, body_.jets()[i].maximum);
        }
        return thrust;
    }
    std::vector<double> thrusts(double t, const double* y) const {
        std::vector<double> thrust = commanded(t, body_of(y));
        for (std::size_t k = 0; k < lagged_.size(); ++k) {
            thrust[lagged_[k]] = y[10 + k];
        }
        return thrust;
    }
    void rates(double t, const double* y, double* d);
    void record(double t, const double* y);
    Ode make_ode();
    Ode::Stop follow(Ode& ode, double& t, double t0);
    bool after(const Ode::Stop& stop, double t, std::vector<double>& y);
    /// Edges on the ground that do not leave it.
    ContactState touching(const BodyState& y) const {
        const std::array<double, 2> gaps = body_.edge_gaps(y), speeds = body_.edge_speeds(y);
        int bits = 0;
        for (std::size_t e = 0; e < 2; ++e) {
            bits |= gaps[e] <= touching_gap * 10 && speeds[e] <= touching_speed ? 1 << e : 0;
        }
        return static_cast<ContactState>(bits);
    }
    /// Impacts if an edge strikes, then the contact state from here on.
    void land(double t, std::vector<double>& y);

    const RigidBody& body_;
    const JetCommand& command_;
    const BodyOptions& options_;
    RecordedInputs inputs_;
    BodyTrajectory& out_;
    std::vector<std::size_t> lagged_;
    std::size_t memory_at_ = 10, states_ = 10;
    std::vector<double> sampled_;  ///< thrusts that a digital controller holds; empty: continuous
    ContactState bearing_ = ContactState::free;
};

void BodyFlight::record(double t, const double* y) {
    const BodyState state = body_of(y);
    const Surroundings now = around(t, y);
    out_.time.push_back(t);
    out_.state.push_back(state);
    out_.roll_rate.push_back(body_.roll_rate(state));
    out_.gap.push_back(body_.gap_at_base_centre(state));
    out_.thrust.push_back(thrusts(t, y));
    out_.normal.push_back(body_.normal_forces(state, out_.thrust.back(), bearing_, now));
    out_.loads.push_back(body_.table_loads(state, now));
    out_.contact.push_back(bearing_);
    out_.outside.push_back(body_.outside_tables(state));
}

void BodyFlight::land(double t, std::vector<double>& y) {
    BodyState state = body_of(y.data());
    // Edges at or below the ground are put on it exactly.
    const std::array<double, 2> gaps = body_.edge_gaps(state);
    const double deepest = std::min(gaps[0], gaps[1]);
    if (deepest < touching_gap * 10) {
        state[state_z] += std::min(deepest, 0.0);
    }
    const std::array<double, 2> speeds = body_.edge_speeds(state);
    int struck = 0;
    for (std::size_t e = 0; e < 2; ++e) {
        struck |= body_.edge_gaps(state)[e] <= touching_gap * 10 ? 1 << e : 0;
    }
    const bool strikes = ((struck & 1) && speeds[0] < -touching_speed) || ((struck & 2) && speeds[1] < -touching_speed);
    if (strikes) {
        state = body_.impact(state, static_cast<ContactState>(struck));
        out_.events.push_back({t, std::string("impact ") + contact_state_name(static_cast<ContactState>(struck))});
    }
    std::copy(state.begin(), state.end(), y.begin());
    const std::vector<double> thrust = thrusts(t, y.data());
    const ContactState next = body_.settle(state, thrust, touching(state), around(t, y.data()));
    if (next != bearing_ || strikes) {
        out_.events.push_back({t, contact_state_name(next)});
    }
    bearing_ = next;
}

void BodyFlight::rates(double t, const double* y, double* d) {
    const BodyState state = body_of(y);
    const std::vector<double> wanted = commanded(t, state);
    std::vector<double> thrust = wanted;
    for (std::size_t k = 0; k < lagged_.size(); ++k) {
        thrust[lagged_[k]] = y[10 + k];
        d[10 + k] = (wanted[lagged_[k]] - y[10 + k]) / body_.jets()[lagged_[k]].lag;
    }
    BodyState rate{};
    body_.rate(state, thrust, bearing_, rate, around(t, y));
    std::copy(rate.begin(), rate.end(), d);
    if (body_.remembers()) {
        const HistoryKernel& kernel = history_kernel();
        const double rise = -rate[state_z];
        for (std::size_t i = 0; i < history_states; ++i) {
            d[memory_at_ + i] = -kernel.rate[i] * (y[memory_at_ + i] + rise);
        }
    }
}

Ode BodyFlight::make_ode() {
    OdeProblem problem;
    problem.size = states_;
    problem.rate = [this](double t, const double* y, double* d) { rates(t, y, d); };
    problem.direction = {-1, -1, -1, -1};
    problem.events = [this](double t, const double* y, double* g) {
        const BodyState state = body_of(y);
        const std::array<double, 2> gaps = body_.edge_gaps(state);
        const std::array<double, 2> normal = body_.normal_forces(state, thrusts(t, y), bearing_, around(t, y));
        for (std::size_t e = 0; e < 2; ++e) {
            // A bearing edge waits for its force to vanish, a free one for its gap.
            g[e] = (static_cast<int>(bearing_) >> e & 1) ? normal[e] : gaps[e];
        }
        g[escape] = options_.escape_gap > 0 ? options_.escape_gap - body_.gap_at_base_centre(state) : 1.0;
        g[settle] = 1.0;
        if (options_.stop_at_equilibrium) {
            std::vector<double> d(states_);
            rates(t, y, d.data());
            constexpr double size = 0.1;  // m, turns rad/s into the speed of the body's ends
            double sum = d[state_z] * d[state_z];
            for (const BodyStateIndex i : {state_u, state_v, state_w}) {
                sum += d[i] * d[i];
            }
            for (const BodyStateIndex i : {state_q, state_r, state_theta}) {
                sum += size * size * d[i] * d[i];
            }
            g[settle] = sum / (options_.settle_speed * options_.settle_speed) - 1;
        }
    };
    OdeOptions options;
    options.relative = options_.tolerance;
    options.absolute.assign(problem.size, options_.tolerance * 1e-2);
    const double corner = inputs_.max_step();
    options.max_step = corner > 0 ? std::min(corner, 0.1) : 0.1;
    return Ode(std::move(problem), options);
}

/// Rows until the next event, the controller's next sample or the end.
Ode::Stop BodyFlight::follow(Ode& ode, double& t, double t0) {
    const auto after_now = [&](double step) { return t0 + step * (std::floor((t - t0) / step * (1 + 1e-12)) + 1); };
    const double step = options_.output_step, sampling = sampled_.empty() ? 0 : options_.command_step;
    const double end = std::min(t0 + options_.duration, sampling > 0 ? after_now(sampling) : 1e300);
    Ode::Stop stop;
    do {
        const double next = step > 0 ? after_now(step) : end;
        const double goal = next < end - 1e-6 * step ? next : end;
        stop = step > 0 ? ode.advance(goal) : ode.one_step(end);
        t = stop.t;
        // The end of a sample is a row only where a row falls on it.
        const bool row =
            step == 0 || goal == next || t >= t0 + options_.duration || std::abs(goal - next) <= 1e-6 * step;
        if (!stop.event && row) {
            record(t, ode.state());
        }
    } while (!stop.event && t < end);
    return stop;
}

/// What an event does to the motion; false when it ends it.
bool BodyFlight::after(const Ode::Stop& stop, double t, std::vector<double>& y) {
    const auto ends = [&](const char* how) {
        record(t, y.data());
        out_.events.push_back({t, how});
        out_.end = how;
        return false;
    };
    if (stop.which[escape] != 0) {
        return ends("escape");
    }
    if (stop.which[settle] != 0) {
        return ends("equilibrium");
    }
    if (options_.stop_at_contact) {
        return ends("contact");
    }
    land(t, y);
    if (options_.output_step == 0) {
        record(t, y.data());
    }
    return true;
}

void BodyFlight::fly(const BodyState& start, double t0, core::Progress& progress) {
    std::vector<double> y(start.begin(), start.end());
    const std::vector<double> first = commanded(t0, start);
    for (const std::size_t jet : lagged_) {
        y.push_back(first[jet]);
    }
    y.resize(states_, RigidBody::world_velocity(start)[2]);
    sample(t0, start);
    land(t0, y);
    record(t0, y.data());
    double t = t0;
    for (int stuck = 0; t < t0 + options_.duration;) {
        progress.check();
        progress.report((t - t0) / options_.duration, "simulating");
        Ode ode = make_ode();
        ode.start(t, y);
        const double began = t;
        const Ode::Stop stop = follow(ode, t, t0);
        y.assign(ode.state(), ode.state() + states_);
        if (stop.event ? !after(stop, t, y) : t >= t0 + options_.duration) {
            return;
        }
        if (!stop.event) {
            sample(t, body_of(y.data()));
        }
        stuck = stop.event && t - began < 1e-7 ? stuck + 1 : 0;
        if (stuck > 200) {
            throw core::Error("contact", "the contact chatters at t = " + core::format_number(t, 6) + " s", {},
                              "a little restitution or friction less settles it");
        }
    }
}

}  // namespace

BodyTrajectory simulate_body(const RigidBody& body, const BodyState& start, const JetCommand& command,
                             const BodyOptions& options, core::Progress& progress, const InputSignals& inputs) {
    for (const double part : start) {
        if (!std::isfinite(part)) {
            throw core::InputError("range", "the start of the motion is not a number that makes sense");
        }
    }
    if (std::abs(start[state_theta]) > 1.5) {
        throw core::InputError("range", "the start stands on its nose or tail: pitch " +
                                            core::format_number(57.29577951308232 * start[state_theta], 4) + " deg");
    }
    const std::array<double, 2> gaps = body.edge_gaps(start);
    if (std::min(gaps[0], gaps[1]) < -1e-9) {
        throw core::InputError("range",
                               "the start lies in the ground: gaps of nose and tail edge " +
                                   core::format_number(gaps[0], 4) + " m, " + core::format_number(gaps[1], 4) + " m",
                               {}, "start higher or flatter, or set [contact] gap in the model");
    }
    if (!(options.duration > 0) || options.output_step < 0) {
        throw core::UsageError("range", "duration must be positive, the output step not negative");
    }
    BodyTrajectory out;
    BodyFlight(body, command, options, inputs, out)
        .fly(start, inputs.time.empty() ? 0.0 : inputs.time.front(), progress);
    const auto beyond = std::count(out.outside.begin(), out.outside.end(), true);
    if (beyond > 0) {
        out.remarks.push_back({core::Problem::Severity::warning,
                               std::to_string(beyond) + " of " + std::to_string(out.time.size()) +
                                   " outputs lie outside the range of a force table, where it holds its end value",
                               {}});
    }
    return out;
}

core::Table BodyTrajectory::table() const {
    core::Table table;
    table.add_numbers("time", "s", time);
    const char* units[] = {"m/s", "m/s", "m/s", "rad/s", "rad/s", "rad", "rad", "m", "m", "m"};
    for (std::size_t i = 0; i < 10; ++i) {
        std::vector<double> column;
        for (const BodyState& y : state) {
            column.push_back(y[i]);
        }
        table.add_numbers(body_state_names()[i], units[i], column);
    }
    table.add_numbers("p", "rad/s", roll_rate);
    table.add_numbers("gap", "m", gap);
    std::vector<double> nose, tail;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < normal.size(); ++i) {
        nose.push_back(normal[i][0]);
        tail.push_back(normal[i][1]);
        names.emplace_back(contact_state_name(contact[i]));
    }
    table.add_numbers("nose_edge_force", "N", nose);
    table.add_numbers("tail_edge_force", "N", tail);
    table.add_text("contact", names);
    std::vector<double> lift, drag, moment, flags;
    for (std::size_t i = 0; i < loads.size(); ++i) {
        lift.push_back(loads[i].lift);
        drag.push_back(loads[i].drag);
        moment.push_back(loads[i].moment);
        flags.push_back(outside[i] ? 1 : 0);
    }
    table.add_numbers("lift_force", "N", lift);
    table.add_numbers("drag_force", "N", drag);
    table.add_numbers("pitch_moment", "N m", moment);
    add_thrusts(table, jets, thrust);
    table.add_numbers("outside_table", "1", flags);
    return table;
}

core::Figure trajectory_figure(const BodyTrajectory& trajectory) {
    core::Figure figure;
    figure.title = "Motion of the vehicle";
    figure.x = {"time", "s"};
    figure.y = {"gap in mm, angles in degrees, speed in cm/s", ""};
    core::FigureCurve gap{"gap, mm", trajectory.time, {}, core::palette(0)};
    for (const double h : trajectory.gap) {
        gap.y.push_back(1e3 * h);
    }
    figure.curves.push_back(std::move(gap));
    add_states(figure, trajectory.time, trajectory.state,
               {{"speed forward, cm/s", state_u, 100},
                {"speed to starboard, cm/s", state_v, 100},
                {"pitch (nose up), deg", state_theta, 57.29577951308232},
                {"heading, deg", state_psi, 57.29577951308232}});
    figure.caption =
        "Gap at the centre of the base, speeds along the body, pitch and heading; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const BodyTrajectory& trajectory) {
    json = {{"end", trajectory.end}};
    const core::Table table = trajectory.table();
    for (const core::Column& column : table.columns()) {
        json[column.name] = column.is_text() ? nlohmann::json(column.text) : nlohmann::json(column.numbers);
    }
    json["events"] = nlohmann::json::array();
    for (const BodyTrajectory::Event& event : trajectory.events) {
        json["events"].push_back({{"time", event.time}, {"kind", event.kind}});
    }
    json["outside_table"] = std::count(trajectory.outside.begin(), trajectory.outside.end(), true);
    json["remarks"] = nlohmann::json::array();
    for (const core::Problem& remark : trajectory.remarks) {
        json["remarks"].push_back(remark.message);
    }
}

}  // namespace underbody::dynamics
