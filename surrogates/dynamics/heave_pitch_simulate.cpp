#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/heave_pitch.h"
#include "surrogates/dynamics/heave_pitch_contact.h"
#include "surrogates/dynamics/ode.h"

namespace underbody::dynamics {

bool land(const HeavePitch& plant, PitchState& y, ContactState& bearing) {
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
    bearing = plant.settle(y, static_cast<ContactState>(touching));
    return strikes;
}

PitchTrajectory simulate(const HeavePitch& plant, const PitchState& start, const TrajectoryOptions& o,
                         core::Progress& progress) {
    const std::array<double, 2> gaps = plant.edge_gaps(start);
    if (std::min(gaps[0], gaps[1]) < -1e-9) {
        throw core::InputError("range", "the start lies in the ground: gaps of nose and tail edge " +
                                            core::format_number(gaps[0], 4) + " m, " + core::format_number(gaps[1], 4) +
                                            " m");
    }
    PitchTrajectory out;
    ContactState bearing = ContactState::free;
    PitchState y = start;
    land(plant, y, bearing);
    const auto record = [&](double t, const double* s) {
        out.time.push_back(t);
        out.state.push_back({s[0], s[1], s[2], s[3]});
        out.contact.push_back(bearing);
    };
    const auto note = [&](double t, const char* kind) { out.events.push_back({t, kind, y[0], y[1]}); };
    record(0, y.data());
    double t = 0;
    int restarts = 0;
    while (t < o.duration) {
        progress.check();
        OdeProblem problem;
        problem.size = 4;
        problem.rate = [&](double, const double* s, double* d) {
            PitchState rate{};
            plant.rate({s[0], s[1], s[2], s[3]}, bearing, rate);
            std::copy(rate.begin(), rate.end(), d);
        };
        problem.direction = {-1, -1, -1};
        problem.events = [&](double, const double* s, double* g) {
            const PitchState state{s[0], s[1], s[2], s[3]};
            const std::array<double, 2> gap = plant.edge_gaps(state), normal = plant.normal_forces(state, bearing);
            for (std::size_t e = 0; e < 2; ++e) {
                g[e] = (static_cast<int>(bearing) >> e & 1) ? normal[e] : gap[e];
            }
            g[2] = o.escape_gap > 0 ? o.escape_gap - s[0] : 1.0;
        };
        OdeOptions options;
        options.relative = o.tolerance;
        options.absolute.assign(4, o.tolerance * 1e-3);
        Ode ode(std::move(problem), options);
        ode.start(t, {y.begin(), y.end()});
        Ode::Stop stop;
        do {
            const double next =
                o.output_step > 0 ? o.output_step * (std::floor(t / o.output_step * (1 + 1e-12)) + 1) : o.duration;
            stop = o.output_step > 0 ? ode.advance(next < o.duration - 1e-6 * o.output_step ? next : o.duration) : ode.one_step(o.duration);
            t = stop.t;
            if (!stop.event) {
                record(t, ode.state());
            }
        } while (!stop.event && t < o.duration);
        std::copy(ode.state(), ode.state() + 4, y.begin());
        if (!stop.event) {
            break;
        }
        if (stop.which[2] != 0) {
            record(t, y.data());
            note(t, "escape");
            out.end = "escape";
            break;
        }
        note(t, bearing == ContactState::free ? "contact" : "contact change");
        if (o.stop_at_contact) {
            record(t, y.data());
            out.end = "contact";
            break;
        }
        const ContactState before = bearing;
        land(plant, y, bearing);
        if (before != ContactState::free && bearing == ContactState::free) {
            out.events.back().kind = "lift_off";
        }
        record(t, y.data());
        if (++restarts > 5000) {
            throw core::Error("contact", "the contact chatters at t = " + core::format_number(t, 6) + " s");
        }
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
    std::vector<std::string> words;
    for (const ContactState c : contact) {
        words.emplace_back(contact_state_name(c));
    }
    table.add_text("contact", words);
    return table;
}

core::Figure trajectory_figure(const PitchTrajectory& trajectory) {
    core::Figure figure;
    figure.title = "Heave and pitch";
    figure.x = {"time", "s"};
    figure.y = {"gap (mm), pitch (tenths of a degree)", ""};
    core::FigureCurve gap{"gap, mm", trajectory.time, {}, core::palette(0)},
        pitch{"pitch, 0.1 deg", trajectory.time, {}, core::palette(1)};
    for (const PitchState& y : trajectory.state) {
        gap.y.push_back(1e3 * y[0]);
        pitch.y.push_back(572.9577951308232 * y[2]);
    }
    figure.curves = {gap, pitch};
    figure.caption = "Gap at the centre of the base and pitch (nose up) against time; ends by " + trajectory.end + ".";
    return figure;
}

}  // namespace underbody::dynamics
