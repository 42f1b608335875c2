#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/ode.h"
#include "surrogates/dynamics/rigid_body.h"

namespace underbody::dynamics {

namespace {

constexpr double touching_gap = 1e-9;    ///< m
constexpr double touching_speed = 1e-7;  ///< m/s

/// Motion in pieces of one contact state each.
class BodyFlight {
public:
    BodyFlight(const RigidBody& body, const std::function<std::vector<double>(double, const BodyState&)>& command,
               const BodyOptions& options, BodyTrajectory& out)
        : body_(body), command_(command), options_(options), out_(out) {
        for (std::size_t i = 0; i < body.jets().size(); ++i) {
            if (body.jets()[i].lag > 0) {
                lagged_.push_back(i);
            }
        }
    }

    void fly(const BodyState& start, core::Progress& progress);

private:
    static BodyState body_of(const double* y) {
        BodyState state{};
        std::copy(y, y + state.size(), state.begin());
        return state;
    }

    std::vector<double> thrusts(double t, const double* y) const {
        std::vector<double> thrust = command_ ? command_(t, body_of(y)) : std::vector<double>{};
        thrust.resize(body_.jets().size(), 0.0);
        for (std::size_t i = 0; i < thrust.size(); ++i) {
            thrust[i] = std::clamp(thrust[i], body_.jets()[i].minimum, body_.jets()[i].maximum);
        }
        for (std::size_t k = 0; k < lagged_.size(); ++k) {
            thrust[lagged_[k]] = y[10 + k];
        }
        return thrust;
    }

    void record(double t, const double* y) {
        const BodyState state = body_of(y);
        out_.time.push_back(t);
        out_.state.push_back(state);
        out_.roll_rate.push_back(body_.roll_rate(state));
        out_.gap.push_back(body_.gap_at_base_centre(state));
        out_.normal.push_back(body_.normal_forces(state, thrusts(t, y), bearing_));
        out_.contact.push_back(bearing_);
    }

    Ode make_ode() const;
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
    const std::function<std::vector<double>(double, const BodyState&)>& command_;
    const BodyOptions& options_;
    BodyTrajectory& out_;
    std::vector<std::size_t> lagged_;
    ContactState bearing_ = ContactState::free;
};

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
    const ContactState next = body_.settle(state, thrust, touching(state));
    if (next != bearing_ || strikes) {
        out_.events.push_back({t, contact_state_name(next)});
    }
    bearing_ = next;
}

Ode BodyFlight::make_ode() const {
    OdeProblem problem;
    problem.size = 10 + lagged_.size();
    problem.rate = [this](double t, const double* y, double* d) {
        BodyState rate{};
        body_.rate(body_of(y), thrusts(t, y), bearing_, rate);
        std::copy(rate.begin(), rate.end(), d);
        if (!lagged_.empty()) {
            std::vector<double> wanted = command_ ? command_(t, body_of(y)) : std::vector<double>{};
            wanted.resize(body_.jets().size(), 0.0);
            for (std::size_t k = 0; k < lagged_.size(); ++k) {
                const Jet& jet = body_.jets()[lagged_[k]];
                d[10 + k] = (std::clamp(wanted[lagged_[k]], jet.minimum, jet.maximum) - y[10 + k]) / jet.lag;
            }
        }
    };
    problem.direction = {-1, -1, -1};
    problem.events = [this](double t, const double* y, double* g) {
        const BodyState state = body_of(y);
        const std::array<double, 2> gaps = body_.edge_gaps(state);
        const std::array<double, 2> normal = body_.normal_forces(state, thrusts(t, y), bearing_);
        for (std::size_t e = 0; e < 2; ++e) {
            // A bearing edge waits for its force to vanish, a free one for its gap.
            g[e] = (static_cast<int>(bearing_) >> e & 1) ? normal[e] : gaps[e];
        }
        g[2] = options_.escape_gap > 0 ? options_.escape_gap - body_.gap_at_base_centre(state) : 1.0;
    };
    OdeOptions options;
    options.relative = options_.tolerance;
    options.absolute.assign(problem.size, options_.tolerance * 1e-2);
    options.max_step = 0.1;
    return Ode(std::move(problem), options);
}

void BodyFlight::fly(const BodyState& start, core::Progress& progress) {
    std::vector<double> y(start.begin(), start.end());
    const std::vector<double> first = command_ ? command_(0.0, start) : std::vector<double>{};
    for (const std::size_t jet : lagged_) {
        y.push_back(jet < first.size() ? first[jet] : 0.0);
    }
    land(0, y);
    record(0, y.data());
    double t = 0;
    int stuck = 0;
    while (t < options_.duration) {
        progress.check();
        Ode ode = make_ode();
        ode.start(t, y);
        Ode::Stop stop;
        const double began = t;
        do {
            const double next = options_.output_step * (std::floor(t / options_.output_step * (1 + 1e-12)) + 1);
            stop = ode.advance(next < options_.duration - 1e-6 * options_.output_step ? next : options_.duration);
            t = stop.t;
            if (!stop.event) {
                record(t, ode.state());
            }
        } while (!stop.event && t < options_.duration);
        y.assign(ode.state(), ode.state() + 10 + lagged_.size());
        if (!stop.event) {
            return;
        }
        if (stop.which[2] != 0) {
            record(t, y.data());
            out_.end = "escape";
            return;
        }
        land(t, y);
        record(t, y.data());
        stuck = t - began < 1e-7 ? stuck + 1 : 0;
        if (stuck > 200) {
            throw core::Error("contact", "the contact chatters at t = " + core::format_number(t, 6) + " s", {},
                              "a little restitution or friction less settles it");
        }
    }
}

}  // namespace

BodyTrajectory simulate_body(const RigidBody& body, const BodyState& start,
                             const std::function<std::vector<double>(double, const BodyState&)>& command,
                             const BodyOptions& options, core::Progress& progress) {
    const std::array<double, 2> gaps = body.edge_gaps(start);
    if (std::min(gaps[0], gaps[1]) < -1e-9) {
        throw core::InputError("range", "the start lies in the ground: gaps of nose and tail edge " +
                                            core::format_number(gaps[0], 4) + " m, " + core::format_number(gaps[1], 4) +
                                            " m");
    }
    if (!(options.duration > 0) || !(options.output_step > 0)) {
        throw core::UsageError("range", "duration and output step must be positive");
    }
    BodyTrajectory out;
    BodyFlight(body, command, options, out).fly(start, progress);
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
    return table;
}

}  // namespace underbody::dynamics
