#include "surrogates/dynamics/simulate/motion_driver.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/no_limit.h"
#include "core/text.h"

namespace underbody::dynamics {

namespace {

constexpr double never = core::no_limit;
constexpr double same_time = 1e-6;  ///< times the output step: times nearer than this are one row
constexpr double rounding = 1e-12;  ///< of a time over the step, relative

}  // namespace

void MotionDriver::refuse_chatter(double t) {
    throw core::Error("contact", "the contact chatters at t = " + core::format_number(t, 6) + " s", {},
                      "a little restitution or friction less settles it");
}

double MotionDriver::next_after(double t, double step) const {
    return step > 0 ? begin_ + step * (std::floor((t - begin_) / step * (1 + rounding)) + 1) : never;
}

/// Rows until the next event, the controller's next sample or the end.
Ode::Stop MotionDriver::follow(Ode& ode, double& t, core::Progress& progress) {
    const double step = settings.output_step, limit = std::min(end(), next_after(t, settings.sampling));
    Ode::Stop stop;
    int count = 0;
    do {
        const double row = row_after(t);
        const double next = row < limit - same_time * step ? row : limit;
        const double goal = std::min(next, t + settings.longest_advance);
        stop = step > 0 ? ode.advance(goal) : ode.one_step(goal);
        t = stop.t;
        accept(t, ode.state());
        if (!stop.event && t >= limit && t < end()) {
            // before the row: what stands there acts from then on, as whoever reads the rows takes it
            sample(t, std::vector<double>(ode.state(), ode.state() + settings.states));
        }
        // The end of a sample is a row only where a row falls on it.
        const bool is_row = goal == next && (t >= end() || std::abs(next - row) <= same_time * step);
        if (!stop.event && (step == 0 || is_row)) {
            record(t, ode.state());
        }
        if (++count % 256 == 0) {
            progress.check();
            progress.report((t - begin_) / settings.duration, "simulating");
        }
    } while (!stop.event && t < limit);
    return stop;
}

void MotionDriver::run(double t0, std::vector<double> y, core::Progress& progress) {
    OdeProblem problem;
    problem.size = settings.states;
    problem.rate = [this](double t, const double* state, double* rate) { rates(t, state, rate); };
    problem.direction.assign(settings.events, -1);
    problem.events = [this](double t, const double* state, double* g) { events(t, state, g); };
    OdeOptions options;
    options.relative = settings.tolerance;
    options.absolute.assign(settings.states, settings.tolerance * settings.absolute);
    options.max_step = settings.max_step;
    Ode ode(std::move(problem), options);
    begin_ = t0;
    for (double t = t0; t < end();) {
        progress.check();
        progress.report((t - begin_) / settings.duration, "simulating");
        begin_piece(t, y, progress);
        if (t >= end()) {
            return;
        }
        piece_began_ = t;
        accept(t, y.data());
        ode.start(t, y);
        const Ode::Stop stop = follow(ode, t, progress);
        y.assign(ode.state(), ode.state() + settings.states);
        if (stop.event && !after(stop, t, y)) {
            return;
        }
    }
}

}  // namespace underbody::dynamics
