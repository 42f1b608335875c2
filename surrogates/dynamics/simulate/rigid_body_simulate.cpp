#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/text.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/simulate/jet_drive.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

namespace {

using core::degree;
constexpr double touching_gap = 1e-9;    ///< m
constexpr double touching_speed = 1e-7;  ///< m/s
constexpr double shortest_piece = 1e-7;  ///< s
constexpr int most_stuck = 200;

/// Motion in pieces of one contact state each. States: the ten of the body, the thrusts of jets with a lag, the memory
/// of the history force.
class BodyFlight : public MotionDriver {
public:
    BodyFlight(const RigidBody& body, const JetCommand& command, const BodyOptions& options, const InputSignals& inputs,
               BodyTrajectory& out)
        : body_(body),
          options_(options),
          inputs_(body.vertical(), inputs),
          jets_(body.jets(), command, options.command_step, body_states),
          out_(out),
          memory_at_(body_states + jets_.states()) {
        out_.jets = jets_.names();
        settings = body_settings(options, inputs_, memory_at_ + (body.remembers() ? history_states : 0));
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
    std::vector<double> thrusts(double t, const double* y) const { return jets_.thrusts(t, body_of(y), y); }
    void rates(double t, const double* y, double* d) override;
    void events(double t, const double* y, double* g) override;
    void record(double t, const double* y) override;
    bool after(const Ode::Stop& stop, double t, std::vector<double>& y) override;
    void sample(double t, const std::vector<double>& y) override {
        stuck_ = 0;
        jets_.sample(t, body_of(y.data()));
    }
    /// Impacts if an edge strikes, then the contact state from here on.
    void land(double t, std::vector<double>& y);

    static constexpr std::size_t body_states = std::tuple_size_v<BodyState>;
    const RigidBody& body_;
    const BodyOptions& options_;
    RecordedInputs inputs_;
    JetDrive jets_;
    BodyTrajectory& out_;
    std::size_t memory_at_;
    ContactState bearing_ = ContactState::free;
    int stuck_ = 0;  ///< pieces in a row that were shorter than `shortest_piece`
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
    const ContactState struck = strike(body_, state);
    const bool strikes = struck != ContactState::free;
    if (strikes) {
        out_.events.push_back({t, std::string("impact ") + contact_state_name(struck)});
    }
    std::copy(state.begin(), state.end(), y.begin());
    const std::vector<double> thrust = thrusts(t, y.data());
    const ContactState next = body_.settle(state, thrust, touching_edges(body_, state), around(t, y.data()));
    if (next != bearing_ || strikes) {
        out_.events.push_back({t, contact_state_name(next)});
    }
    bearing_ = next;
}

void BodyFlight::rates(double t, const double* y, double* d) {
    const BodyState state = body_of(y);
    BodyState rate{};
    body_.rate(state, jets_.rates(t, state, y, d), bearing_, rate, around(t, y));
    std::copy(rate.begin(), rate.end(), d);
    if (body_.remembers()) {
        const HistoryKernel& kernel = history_kernel();
        const double rise = -rate[state_z];
        for (std::size_t i = 0; i < history_states; ++i) {
            d[memory_at_ + i] = -kernel.rate[i] * (y[memory_at_ + i] + rise);
        }
    }
}

void BodyFlight::events(double t, const double* y, double* g) {
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
        std::vector<double> d(settings.states);
        rates(t, y, d.data());
        const auto sum = [&](std::initializer_list<BodyStateIndex> which) {
            double squares = 0;
            for (const BodyStateIndex i : which) {
                squares += d[i] * d[i];
            }
            return squares;
        };
        g[settle] = unsettled(sum({state_z, state_u, state_v, state_w}), sum({state_q, state_r, state_theta}),
                              options_.settle_speed);
    }
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
    stuck_ = t - piece_began() < shortest_piece ? stuck_ + 1 : 0;
    if (stuck_ > most_stuck) {
        refuse_chatter(t);
    }
    return true;
}

void BodyFlight::fly(const BodyState& start, double t0, core::Progress& progress) {
    std::vector<double> y(start.begin(), start.end());
    jets_.start(t0, start, y);
    y.resize(settings.states, RigidBody::world_velocity(start)[2]);
    jets_.sample(t0, start);
    settings.sampling = jets_.sampled() ? options_.command_step : 0;
    land(t0, y);
    record(t0, y.data());
    run(t0, std::move(y), progress);
}

}  // namespace

ContactState touching_edges(const RigidBody& body, const BodyState& y) {
    const std::array<double, 2> gaps = body.edge_gaps(y), speeds = body.edge_speeds(y);
    int bits = 0;
    for (std::size_t e = 0; e < 2; ++e) {
        bits |= gaps[e] <= touching_gap * 10 && speeds[e] <= touching_speed ? 1 << e : 0;
    }
    return static_cast<ContactState>(bits);
}

ContactState strike(const RigidBody& body, BodyState& y) {
    // Edges at or below the ground are put on it exactly.
    const std::array<double, 2> gaps = body.edge_gaps(y);
    const double deepest = std::min(gaps[0], gaps[1]);
    if (deepest < touching_gap * 10) {
        y[state_z] += std::min(deepest, 0.0);
    }
    const std::array<double, 2> speeds = body.edge_speeds(y);
    int struck = 0;
    for (std::size_t e = 0; e < 2; ++e) {
        struck |= body.edge_gaps(y)[e] <= touching_gap * 10 ? 1 << e : 0;
    }
    const bool strikes = ((struck & 1) && speeds[0] < -touching_speed) || ((struck & 2) && speeds[1] < -touching_speed);
    if (strikes) {
        y = body.impact(y, static_cast<ContactState>(struck));
    }
    return strikes ? static_cast<ContactState>(struck) : ContactState::free;
}

BodyTrajectory simulate_body(const RigidBody& body, const BodyState& start, const JetCommand& command,
                             const BodyOptions& options, core::Progress& progress, const InputSignals& inputs) {
    refuse_odd_start(start);
    constexpr double upright = 1.5;  // rad
    if (std::abs(start[state_theta]) > upright) {
        throw core::InputError("range", "the start stands on its nose or tail: pitch " +
                                            core::format_number(start[state_theta] / degree, 4) + " deg");
    }
    refuse_start_in_ground(body.edge_gaps(start));
    if (!(options.duration > 0) || options.output_step < 0) {
        throw core::UsageError("range", "duration must be positive, the output step not negative");
    }
    BodyTrajectory out;
    BodyFlight(body, command, options, inputs, out)
        .fly(start, inputs.time.empty() ? 0.0 : inputs.time.front(), progress);
    remark_outside(out.remarks, out.outside);
    const bool touches = std::any_of(out.contact.begin(), out.contact.end(),
                                     [](ContactState state) { return state != ContactState::free; });
    for (core::Problem& unsaid : taken_as_zero_of_body(body.model(), touches)) {
        out.remarks.push_back(std::move(unsaid));
    }
    return out;
}

core::Table BodyTrajectory::table() const {
    core::Table table;
    table.add_numbers("time", "s", time);
    constexpr const char* units[] = {"m/s", "m/s", "m/s", "rad/s", "rad/s", "rad", "rad", "m", "m", "m"};
    add_states(table, state, body_state_names(), units);
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
    std::vector<double> lift, drag, moment;
    for (const RigidBody::TableLoads& load : loads) {
        lift.push_back(load.lift);
        drag.push_back(load.drag);
        moment.push_back(load.moment);
    }
    table.add_numbers("lift_force", "N", lift);
    table.add_numbers("drag_force", "N", drag);
    table.add_numbers("pitch_moment", "N m", moment);
    add_thrusts(table, jets, thrust);
    add_outside(table, outside);
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
                {"pitch (nose up), deg", state_theta, 1 / degree},
                {"heading, deg", state_psi, 1 / degree}});
    figure.caption =
        "Gap at the centre of the base, speeds along the body, pitch and heading; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const BodyTrajectory& trajectory) {
    write_table(json, trajectory.end, trajectory.table());
    write_events(json, trajectory.events, false);
    write_remarks(json, trajectory.outside, trajectory.remarks);
}

}  // namespace underbody::dynamics
