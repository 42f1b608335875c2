#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/text.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/simulate/jet_drive.h"
#include "surrogates/dynamics/simulate/surface_motion.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

namespace {

/// The states of the surface motion, then the thrusts of the jets that lag.
class SurfaceRun : public MotionDriver {
public:
    SurfaceRun(const SurfaceMotion& motion, const JetCommand& command, const BodyOptions& options,
               const InputSignals& inputs, SurfaceTrajectory& out)
        : motion_(motion),
          options_(options),
          inputs_(motion.vertical(), inputs),
          jets_(motion.jets(), command, options.command_step, surface_states),
          out_(out) {
        out_.jets = jets_.names();
        settings = body_settings(options, inputs_, surface_states + jets_.states());
    }

    void slide(const SurfaceState& start, double t0, core::Progress& progress);

private:
    enum Event { lift_off, nose, tail, settle };

    static SurfaceState state_of(const double* y) {
        SurfaceState state{};
        std::copy(y, y + state.size(), state.begin());
        return state;
    }
    static BodyState body_of(const double* y) {
        BodyState body{};
        body[state_u] = y[0];
        body[state_v] = y[1];
        body[state_r] = y[2];
        body[state_psi] = y[3];
        body[state_x] = y[4];
        body[state_y] = y[5];
        return body;
    }
    std::vector<double> thrusts(double t, const double* y) const { return jets_.thrusts(t, body_of(y), y); }
    void rates(double t, const double* y, double* d) override;
    void events(double t, const double* y, double* g) override;
    void record(double t, const double* y) override;
    bool after(const Ode::Stop& stop, double t, std::vector<double>& y) override;
    void sample(double t, const std::vector<double>& y) override { jets_.sample(t, body_of(y.data())); }
    void end_by(std::ptrdiff_t event, double t);

    static constexpr std::size_t surface_states = std::tuple_size_v<SurfaceState>;
    const SurfaceMotion& motion_;
    const BodyOptions& options_;
    RecordedInputs inputs_;
    JetDrive jets_;
    SurfaceTrajectory& out_;
};

void SurfaceRun::rates(double t, const double* y, double* d) {
    SurfaceState rate{};
    motion_.rate(state_of(y), jets_.rates(t, body_of(y), y, d), rate, inputs_.at(t));
    std::copy(rate.begin(), rate.end(), d);
}

void SurfaceRun::events(double t, const double* y, double* g) {
    const SurfaceMotion::Contact c = motion_.contact(state_of(y), thrusts(t, y), inputs_.at(t));
    const auto finite = [](double value) { return std::isfinite(value) ? value : 1.0; };
    g[lift_off] = c.normal;
    g[nose] = finite(motion_.nose() - c.forward);
    g[tail] = finite(c.forward - motion_.tail());
    g[settle] = 1;
    if (options_.stop_at_equilibrium) {
        std::vector<double> d(settings.states);
        rates(t, y, d.data());
        g[settle] = unsettled(d[0] * d[0] + d[1] * d[1], d[2] * d[2] + d[3] * d[3], options_.settle_speed);
    }
}

void SurfaceRun::record(double t, const double* y) {
    const SurfaceState state = state_of(y);
    out_.time.push_back(t);
    out_.state.push_back(state);
    out_.thrust.push_back(thrusts(t, y));
    out_.contact.push_back(motion_.contact(state, out_.thrust.back(), inputs_.at(t)));
}

void SurfaceRun::end_by(std::ptrdiff_t event, double t) {
    static const char* const names[] = {"lift_off", "tips on the nose edge", "tips on the tail edge", "equilibrium"};
    out_.end = names[event];
    out_.events.push_back({t, out_.end, 0, 0});
}

/// Every event ends the motion.
bool SurfaceRun::after(const Ode::Stop& stop, double t, std::vector<double>& y) {
    record(t, y.data());
    const auto which = std::find_if(stop.which.begin(), stop.which.end(), [](int w) { return w != 0; });
    end_by(which - stop.which.begin(), t);
    return false;
}

void SurfaceRun::slide(const SurfaceState& start, double t0, core::Progress& progress) {
    std::vector<double> y(start.begin(), start.end());
    jets_.start(t0, body_of(y.data()), y);
    record(t0, y.data());
    double g[4];
    events(t0, y.data(), g);
    for (const Event event : {lift_off, nose, tail}) {
        if (g[event] < 0) {
            return end_by(event, t0);
        }
    }
    sample(t0, y);
    settings.sampling = jets_.sampled() ? options_.command_step : 0;
    run(t0, std::move(y), progress);
}

}  // namespace

SurfaceTrajectory simulate_surface(const SurfaceMotion& motion, const SurfaceState& start, const JetCommand& command,
                                   const BodyOptions& options, core::Progress& progress, const InputSignals& inputs) {
    refuse_odd_start(start);
    if (!(options.duration > 0) || options.output_step < 0) {
        throw core::UsageError("range", "duration must be positive, the output step not negative");
    }
    SurfaceTrajectory out;
    out.remarks = taken_as_zero_on_ground(motion.model());
    SurfaceRun(motion, command, options, inputs, out)
        .slide(start, inputs.time.empty() ? 0.0 : inputs.time.front(), progress);
    return out;
}

core::Table SurfaceTrajectory::table() const {
    core::Table table;
    table.add_numbers("time", "s", time);
    static const std::vector<std::string> names = {"u", "v", "r", "psi", "X", "Y"};
    constexpr const char* units[] = {"m/s", "m/s", "rad/s", "rad", "m", "m"};
    add_states(table, state, names, units);
    std::vector<double> normal, forward, fx, fy;
    for (const SurfaceMotion::Contact& c : contact) {
        normal.push_back(c.normal);
        forward.push_back(c.forward);
        fx.push_back(c.friction_x);
        fy.push_back(c.friction_y);
    }
    table.add_numbers("normal_force", "N", normal);
    table.add_numbers("contact_point", "m", forward);
    table.add_numbers("friction_x", "N", fx);
    table.add_numbers("friction_y", "N", fy);
    add_thrusts(table, jets, thrust);
    return table;
}

core::Figure trajectory_figure(const SurfaceTrajectory& trajectory) {
    core::Figure figure;
    figure.title = "Motion on the ground";
    figure.x = {"time", "s"};
    figure.y = {"speeds in cm/s, angles in degrees", ""};
    add_states(figure, trajectory.time, trajectory.state,
               {{"speed forward, cm/s", 0, 100},
                {"speed to starboard, cm/s", 1, 100},
                {"yaw rate, deg/s", 2, 1 / core::degree},
                {"heading, deg", 3, 1 / core::degree}});
    figure.caption =
        "Speeds along the body, yaw and heading of a run flat on the ground; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const SurfaceTrajectory& trajectory) {
    write_table(json, trajectory.end, trajectory.table());
    write_events(json, trajectory.events, false);
}

}  // namespace underbody::dynamics
