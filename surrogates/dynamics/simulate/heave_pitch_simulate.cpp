#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "surrogates/dynamics/plant/loop_actuator.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/heave_pitch_contact.h"
#include "surrogates/dynamics/simulate/motion_driver.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

constexpr double touching_gap = 1e-8, touching_speed = 1e-7;  ///< m, m/s, of an edge

bool land(const HeavePitch& plant, PitchState& y, ContactState& bearing, const Surroundings& around) {
    const std::array<double, 2> gaps = plant.edge_gaps(y);
    const double deepest = std::min(gaps[0], gaps[1]);
    y[0] -= std::min(deepest, 0.0);
    int struck = 0, touching = 0;
    for (std::size_t e = 0; e < 2; ++e) {
        struck |= plant.edge_gaps(y)[e] <= touching_gap ? 1 << e : 0;
    }
    std::array<double, 2> speeds = plant.edge_speeds(y);
    const bool strikes = ((struck & 1) && speeds[0] < -touching_speed) || ((struck & 2) && speeds[1] < -touching_speed);
    if (strikes) {
        y = plant.impact(y, static_cast<ContactState>(struck));
        speeds = plant.edge_speeds(y);
    }
    for (std::size_t e = 0; e < 2; ++e) {
        touching |= (struck >> e & 1) && speeds[e] <= touching_speed ? 1 << e : 0;
    }
    bearing = plant.settle(y, static_cast<ContactState>(touching), around);
    return strikes;
}

namespace {

const std::vector<std::string> pitch_state_names = {"gap", "heave_velocity", "pitch", "pitch_rate"};
constexpr const char* pitch_state_units[] = {"m", "m/s", "rad", "rad/s"};

/// The motion as pieces of one contact state each.
class PitchFlight : public MotionDriver {
public:
    PitchFlight(const HeavePitch& plant, const TrajectoryOptions& options, const InputSignals& inputs,
                PitchTrajectory& out)
        : plant_(plant),
          options_(options),
          inputs_(plant.vertical(), inputs),
          out_(out),
          actuator_(plant.vertical().terms, [this](double t, const double* y) {
              const double given = inputs_.at(t).input;
              return (std::isnan(given) ? plant_.vertical().held_input() : given) + plant_.force_command(state_of(y));
          }) {
        settings = {.states = 4 + (plant.remembers() ? history_states : 0) + (loop_has_states() ? 1 : 0),
                    .duration = options.duration,
                    .output_step = options.output_step,
                    .tolerance = options.tolerance,
                    .max_step = inputs_.max_step()};
        if (loop_has_states() && actuator_.delayed()) {
            const double longest = actuator_.max_step();
            settings.max_step = settings.max_step > 0 ? std::min(settings.max_step, longest) : longest;
            // A delay looks back on the motion, which is kept in pieces much shorter than it.
            settings.longest_advance = options.output_step > 0 ? longest / 8 : settings.longest_advance;
        }
    }

    void fly(const PitchState& start, double t0, core::Progress& progress);

private:
    enum Event { nose, tail, escape, settle };

    static PitchState state_of(const double* y) { return {y[0], y[1], y[2], y[3]}; }
    Surroundings around(double t, const double* y) {
        // The actuator looks at the inputs of another time: it comes before the moment's own, which share a buffer.
        const double felt = !loop_has_states()   ? 0.0
                            : actuator_.lagged() ? y[settings.states - 1]
                                                 : actuator_.driven(t, y);
        Surroundings now = inputs_.at(t, plant_.remembers() ? y + 4 : nullptr);
        now.input = loop_has_states() ? felt : now.input;
        return now;
    }
    [[nodiscard]] bool loop_has_states() const { return plant_.vertical().loop_has_states(); }
    /// Tells the actuator of the loop where the motion has come to.
    void accept(double t, const double* y) override {
        if (loop_has_states()) {
            std::vector<double> d(settings.states);
            rates(t, y, d.data());
            actuator_.accept(t, y, d.data());
        }
    }
    void begin_piece(double& t, std::vector<double>&, core::Progress&) override {
        if (pieces_++ > most_pieces) {
            refuse_chatter(t);
        }
    }
    void rates(double t, const double* y, double* d) override;
    void events(double t, const double* y, double* g) override;
    void record(double t, const double* y) override;
    bool after(const Ode::Stop& stop, double t, std::vector<double>& y) override;
    [[nodiscard]] bool outside(const PitchState& y) const {
        return y[0] < plant_.table_lower() || y[0] > plant_.table_upper() || y[2] < plant_.pitch_lower() ||
               y[2] > plant_.pitch_upper();
    }

    static constexpr int most_pieces = 5000;
    const HeavePitch& plant_;
    const TrajectoryOptions& options_;
    RecordedInputs inputs_;
    PitchTrajectory& out_;
    LoopActuator<4> actuator_;
    ContactState bearing_ = ContactState::free;
    int pieces_ = 0;
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
        d[settings.states - 1] = actuator_.lagged() ? (actuator_.driven(t, y) - y[settings.states - 1]) /
                                                          plant_.vertical().terms.actuator.lag
                                                    : 0;
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

void PitchFlight::events(double t, const double* y, double* g) {
    const PitchState state = state_of(y);
    const std::array<double, 2> gap = plant_.edge_gaps(state);
    const std::array<double, 2> normal = plant_.normal_forces(state, bearing_, around(t, y));
    for (std::size_t e = 0; e < 2; ++e) {
        g[e] = (static_cast<int>(bearing_) >> e & 1) ? normal[e] : gap[e];
    }
    g[escape] = options_.escape_gap > 0 ? options_.escape_gap - state[0] : 1.0;
    g[settle] = 1.0;
    if (options_.stop_at_equilibrium) {
        std::vector<double> d(settings.states);
        rates(t, y, d.data());
        g[settle] = unsettled(d[0] * d[0] + d[1] * d[1], d[2] * d[2] + d[3] * d[3], options_.settle_speed);
    }
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
    std::vector<double> y(settings.states, -plant_.centre_velocity(start));
    std::copy(start.begin(), start.end(), y.begin());
    if (loop_has_states()) {
        const std::vector<double> still(4, 0.0);
        actuator_.start(t0, y.data(), still.data());
        y.back() = actuator_.driven(t0, y.data());
    }
    land(plant_, first, bearing_, around(t0, y.data()));
    std::copy(first.begin(), first.end(), y.begin());
    record(t0, y.data());
    run(t0, std::move(y), progress);
}

}  // namespace

PitchTrajectory simulate(const HeavePitch& plant, const PitchState& start, const TrajectoryOptions& options,
                         core::Progress& progress, const InputSignals& inputs) {
    refuse_odd_start(start);
    refuse_start_in_ground(plant.edge_gaps(start));
    PitchTrajectory out;
    PitchFlight(plant, options, inputs, out).fly(start, inputs.time.empty() ? 0.0 : inputs.time.front(), progress);
    remark_outside(out.remarks, out.outside);
    return out;
}

core::Table PitchTrajectory::table() const {
    core::Table table;
    table.add_numbers("time", "s", time);
    add_states(table, state, pitch_state_names, pitch_state_units);
    table.add_numbers("lift_force", "N", lift);
    table.add_numbers("pitch_moment", "N m", moment);
    std::vector<std::string> words;
    for (const ContactState c : contact) {
        words.emplace_back(contact_state_name(c));
    }
    table.add_text("contact", words);
    add_outside(table, outside);
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
        pitch.y.push_back(1800 / std::numbers::pi * y[2]);
    }
    figure.curves = {gap, pitch};
    add_events(figure, trajectory.events, {"contact", "contact change", "lift_off", "escape", "equilibrium"});
    figure.caption = "Gap at the centre of the base and pitch (nose up) against time; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const PitchTrajectory& trajectory) {
    write_table(json, trajectory.end, trajectory.table());
    write_events(json, trajectory.events, true);
    write_remarks(json, trajectory.outside, trajectory.remarks);
}

}  // namespace underbody::dynamics
