#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "surrogates/dynamics/simulate/ode.h"
#include "surrogates/dynamics/simulate/surface_motion.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

namespace {

/// The states of the surface motion, then the thrusts of the jets that lag.
class SurfaceRun {
public:
    SurfaceRun(const SurfaceMotion& motion, const JetCommand& command, const BodyOptions& options,
               const InputSignals& inputs, SurfaceTrajectory& out)
        : motion_(motion), command_(command), options_(options), inputs_(motion.vertical(), inputs), out_(out) {
        for (std::size_t i = 0; i < motion.jets().size(); ++i) {
            out_.jets.push_back(motion.jets()[i].name);
            if (motion.jets()[i].lag > 0) {
                lagged_.push_back(i);
            }
        }
    }

    void run(const SurfaceState& start, double t0, core::Progress& progress);

private:
    enum Event { lift_off, nose, tail, settle };

    static SurfaceState state_of(const double* y) {
        SurfaceState state{};
        std::copy(y, y + state.size(), state.begin());
        return state;
    }
    std::vector<double> commanded(double t, const double* y) const {
        if (!sampled_.empty()) {
            return sampled_;
        }
        BodyState body{};
        body[state_u] = y[0];
        body[state_v] = y[1];
        body[state_r] = y[2];
        body[state_psi] = y[3];
        body[state_x] = y[4];
        body[state_y] = y[5];
        std::vector<double> thrust = command_ ? command_(t, body) : std::vector<double>{};
        thrust.resize(motion_.jets().size(), 0.0);
        for (std::size_t i = 0; i < thrust.size(); ++i) {
            thrust[i] = std::clamp(thrust[i], motion_.jets()[i].minimum, motion_.jets()[i].maximum);
        }
        return thrust;
    }
    std::vector<double> thrusts(double t, const double* y) const {
        std::vector<double> thrust = commanded(t, y);
        for (std::size_t k = 0; k < lagged_.size(); ++k) {
            thrust[lagged_[k]] = y[6 + k];
        }
        return thrust;
    }
    void rates(double t, const double* y, double* d);
    void events(double t, const double* y, double* g);
    void record(double t, const double* y);

    const SurfaceMotion& motion_;
    const JetCommand& command_;
    const BodyOptions& options_;
    RecordedInputs inputs_;
    SurfaceTrajectory& out_;
    std::vector<std::size_t> lagged_;
    std::vector<double> sampled_;  ///< thrusts that a digital controller holds; empty: continuous
};

void SurfaceRun::rates(double t, const double* y, double* d) {
    const std::vector<double> wanted = commanded(t, y);
    std::vector<double> thrust = wanted;
    for (std::size_t k = 0; k < lagged_.size(); ++k) {
        thrust[lagged_[k]] = y[6 + k];
        d[6 + k] = (wanted[lagged_[k]] - y[6 + k]) / motion_.jets()[lagged_[k]].lag;
    }
    SurfaceState rate{};
    motion_.rate(state_of(y), thrust, rate, inputs_.at(t));
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
        std::vector<double> d(6 + lagged_.size());
        rates(t, y, d.data());
        constexpr double size = 0.1;  // m, turns rad/s into the speed of the body's ends
        g[settle] = (d[0] * d[0] + d[1] * d[1] + size * size * (d[2] * d[2] + d[3] * d[3])) /
                        (options_.settle_speed * options_.settle_speed) -
                    1;
    }
}

void SurfaceRun::record(double t, const double* y) {
    const SurfaceState state = state_of(y);
    out_.time.push_back(t);
    out_.state.push_back(state);
    out_.thrust.push_back(thrusts(t, y));
    out_.contact.push_back(motion_.contact(state, out_.thrust.back(), inputs_.at(t)));
}

void SurfaceRun::run(const SurfaceState& start, double t0, core::Progress& progress) {
    std::vector<double> y(start.begin(), start.end());
    const std::vector<double> first = commanded(t0, y.data());
    for (const std::size_t jet : lagged_) {
        y.push_back(first[jet]);
    }
    record(t0, y.data());
    const auto ends = [&](double t, const char* how) {
        out_.end = how;
        out_.events.push_back({t, how, 0, 0});
    };
    double g[4];
    events(t0, y.data(), g);
    static const char* const names[] = {"lift_off", "tips on the nose edge", "tips on the tail edge", "equilibrium"};
    for (const Event event : {lift_off, nose, tail}) {
        if (g[event] < 0) {
            return ends(t0, names[event]);
        }
    }
    OdeProblem problem;
    problem.size = y.size();
    problem.rate = [this](double t, const double* s, double* d) { rates(t, s, d); };
    problem.direction = {-1, -1, -1, -1};
    problem.events = [this](double t, const double* s, double* values) { events(t, s, values); };
    OdeOptions options;
    options.relative = options_.tolerance;
    options.absolute.assign(y.size(), options_.tolerance * 1e-2);
    const double corner = inputs_.max_step();
    options.max_step = corner > 0 ? std::min(corner, 0.1) : 0.1;
    Ode ode(std::move(problem), options);
    ode.start(t0, y);
    const double end = t0 + options_.duration, step = options_.output_step, sampling = options_.command_step;
    const auto sample = [&](double t, const double* s) {
        sampled_.clear();
        sampled_ = commanded(t, s);
    };
    if (sampling > 0 && command_) {
        sample(t0, y.data());
    }
    for (double t = t0; t < end;) {
        progress.check();
        progress.report((t - t0) / options_.duration, "simulating");
        const auto after_now = [&](double width) {
            return width > 0 ? t0 + width * (std::floor((t - t0) / width * (1 + 1e-12)) + 1) : 1e300;
        };
        const double row = after_now(step), tick = sampled_.empty() ? 1e300 : after_now(sampling);
        double goal = std::min({row, tick, end});
        goal = end - goal < 1e-6 * step ? end : goal;
        const Ode::Stop stop = step > 0 ? ode.advance(goal) : ode.one_step(goal);
        t = stop.t;
        if (step == 0 || stop.event || t >= end || std::abs(t - row) <= 1e-6 * step) {
            record(t, ode.state());
        }
        if (!stop.event && tick < 1e299 && t >= tick - 1e-9 * sampling) {
            y.assign(ode.state(), ode.state() + y.size());
            sample(t, y.data());
            ode.start(t, y);
        }
        if (stop.event) {
            const auto which = std::find_if(stop.which.begin(), stop.which.end(), [](int w) { return w != 0; });
            return ends(t, names[which - stop.which.begin()]);
        }
    }
}

}  // namespace

SurfaceTrajectory simulate_surface(const SurfaceMotion& motion, const SurfaceState& start, const JetCommand& command,
                                   const BodyOptions& options, core::Progress& progress, const InputSignals& inputs) {
    for (const double part : start) {
        if (!std::isfinite(part)) {
            throw core::InputError("range", "the start of the motion is not a number that makes sense");
        }
    }
    if (!(options.duration > 0) || options.output_step < 0) {
        throw core::UsageError("range", "duration must be positive, the output step not negative");
    }
    SurfaceTrajectory out;
    SurfaceRun(motion, command, options, inputs, out)
        .run(start, inputs.time.empty() ? 0.0 : inputs.time.front(), progress);
    return out;
}

core::Table SurfaceTrajectory::table() const {
    core::Table table;
    table.add_numbers("time", "s", time);
    const char* names[] = {"u", "v", "r", "psi", "X", "Y"};
    const char* units[] = {"m/s", "m/s", "rad/s", "rad", "m", "m"};
    for (std::size_t i = 0; i < 6; ++i) {
        std::vector<double> column;
        for (const SurfaceState& y : state) {
            column.push_back(y[i]);
        }
        table.add_numbers(names[i], units[i], column);
    }
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
                {"yaw rate, deg/s", 2, 57.29577951308232},
                {"heading, deg", 3, 57.29577951308232}});
    figure.caption =
        "Speeds along the body, yaw and heading of a run flat on the ground; ends by " + trajectory.end + ".";
    return figure;
}

void to_json(nlohmann::json& json, const SurfaceTrajectory& trajectory) {
    json = {{"end", trajectory.end}};
    const core::Table table = trajectory.table();
    for (const core::Column& column : table.columns()) {
        json[column.name] = column.numbers;
    }
    json["events"] = nlohmann::json::array();
    for (const TrajectoryEvent& event : trajectory.events) {
        json["events"].push_back({{"time", event.time}, {"kind", event.kind}});
    }
}

}  // namespace underbody::dynamics
