#include "surrogates/dynamics/theory/release.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "surrogates/dynamics/simulate/ode.h"

namespace underbody::dynamics {

const char* release_outcome_name(ReleaseOutcome outcome) {
    switch (outcome) {
        case ReleaseOutcome::settles:
            return "settles without overshoot";
        case ReleaseOutcome::overshoots:
            return "settles with overshoot";
        case ReleaseOutcome::oscillates:
            return "decaying oscillation";
        case ReleaseOutcome::escapes:
            break;
    }
    return "escapes";
}

namespace {

/// The stable gap of film force plus extra force: the lower of the two roots, NaN when the film cannot hold the body.
double stable_gap(const ReleaseSetup& s) {
    if (s.extra_force > -s.film.lowest()) {
        return std::nan("");
    }
    double lo = 0.2 * s.film.zero(), hi = s.film.lowest_gap();
    for (int i = 0; i < 200; ++i) {
        const double middle = (lo + hi) / 2;
        (s.film.force(middle) + s.extra_force > 0 ? lo : hi) = middle;
    }
    return (lo + hi) / 2;
}

/// Swings beyond the equilibrium by more than a hundredth of its gap, and what that is called.
void judge(Release& out) {
    // A crossing counts when the motion goes on beyond the equilibrium by a hundredth of its gap.
    const double band = 0.01 * out.equilibrium;
    int side = -1;
    for (const double h : out.gap) {
        const int now = h > out.equilibrium + band ? 1 : h < out.equilibrium - band ? -1 : side;
        out.swings += now != side ? 1 : 0;
        side = now;
    }
    out.outcome = out.swings == 0   ? ReleaseOutcome::settles
                  : out.swings <= 2 ? ReleaseOutcome::overshoots
                                    : ReleaseOutcome::oscillates;
}

OdeProblem problem_of(const ReleaseSetup& s) {
    const double g = film_integral(s.half_length, s.half_width);
    OdeProblem problem;
    problem.size = 2;
    problem.rate = [&s, g](double, const double* y, double* d) {
        const double h = std::max(y[0], s.contact_gap / 2), w = y[1];
        const double damping = s.squeeze ? 12 * s.viscosity * g / (h * h * h) : 0.0;
        const double extra = s.gap_mass ? s.density * g / h : 0.0, slope = s.gap_mass ? -s.density * g / (h * h) : 0.0;
        d[0] = w;
        d[1] =
            (s.film.force(h) + s.extra_force - damping * w - s.quadratic_drag * w * std::abs(w) - 0.5 * slope * w * w) /
            (s.mass + extra);
    };
    problem.direction = {-1, -1};
    problem.events = [&s](double, const double* y, double* e) {
        e[0] = s.escape_gap - y[0];
        e[1] = y[0] - s.contact_gap;
    };
    return problem;
}

}  // namespace

Release release(const ReleaseSetup& s) {
    if (!(s.mass > 0) || !(s.start > 0) || !(s.film.viscous > 0)) {
        throw core::InputError("range", "a release needs a mass, a gap to start at and a film force");
    }
    Release out;
    out.equilibrium = stable_gap(s);
    OdeProblem problem = problem_of(s);
    OdeOptions options;
    options.relative = 1e-9;
    options.absolute = {1e-12, 1e-12};
    Ode ode(std::move(problem), options);
    double t = 0;
    std::vector<double> y{std::max(s.start, s.contact_gap), 0.0};
    ode.start(t, y);
    out.time.push_back(0);
    out.gap.push_back(y[0]);
    out.velocity.push_back(0);
    while (t < s.duration) {
        const Ode::Stop stop = ode.advance(std::min(s.duration, t + s.duration / 2000));
        t = stop.t;
        out.time.push_back(t);
        out.gap.push_back(ode.state()[0]);
        out.velocity.push_back(ode.state()[1]);
        if (!stop.event) {
            continue;
        }
        if (stop.which[0] != 0) {
            out.outcome = ReleaseOutcome::escapes;
            return out;
        }
        y = {s.contact_gap, 0.0};
        ode.start(t, y);
    }
    judge(out);
    return out;
}

double escape_threshold(ReleaseSetup setup, double upper, double precision) {
    double lo = 0, hi = upper;
    while (hi - lo > precision) {
        setup.extra_force = (lo + hi) / 2;
        (release(setup).outcome == ReleaseOutcome::escapes ? hi : lo) = setup.extra_force;
    }
    return (lo + hi) / 2;
}

core::Figure release_figure(const std::vector<Release>& releases, const std::vector<std::string>& names) {
    core::Figure figure;
    figure.title = "Release over the bottom jet";
    figure.x = {"time", "s"};
    figure.y = {"gap", "mm"};
    figure.y.logarithmic = true;  // some settle within a millimetre, some leave
    for (std::size_t i = 0; i < releases.size(); ++i) {
        core::FigureCurve curve{
            (i < names.size() ? names[i] + ": " : std::string()) + release_outcome_name(releases[i].outcome),
            releases[i].time,
            {},
            core::palette(i)};
        for (const double h : releases[i].gap) {
            curve.y.push_back(1e3 * h);
        }
        figure.curves.push_back(std::move(curve));
    }
    figure.caption = "Film force, squeeze damping and the added mass of the gap, from rest near contact.";
    return figure;
}

}  // namespace underbody::dynamics
