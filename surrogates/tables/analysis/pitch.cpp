#include "surrogates/tables/analysis/pitch.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/analysis/zero_lines.h"
#include "surrogates/tables/fit/grid.h"

namespace underbody::tables {

namespace {

/// Does the table go through set points by slopes of its own, which turn at points only?
bool turns_at_points(const ForceTable& table, std::size_t axis) {
    return table.knots(axis) == table.axes()[axis].points && table.knots(axis).size() >= 4;
}

/// The moment along pitch, smooth where it turns.
Line smooth_line(const ForceTable& table, std::size_t axis, const std::vector<double>& point, bool through_points) {
    if (!through_points) {
        return {table, axis, point};
    }
    const std::vector<double>& x = table.axes()[axis].points;
    std::vector<double> at = point, value, slope(x.size());
    for (const double pitch : x) {
        at[axis] = pitch;
        value.push_back(table.value_by_policy(at.data(), nullptr, 1U << axis));
    }
    line_slopes(SlopeRule::not_a_knot, x, value, slope);
    return {x, std::move(value), std::move(slope)};
}

struct Range {
    double lower = 0, upper = 0;
};

/// Where the line falls.
std::vector<Range> falling(const Line& line) {
    const double from = line.lower(), to = line.upper();
    const auto falls = [&](double x) {
        double slope = 0;
        static_cast<void>(line.value(x, &slope));
        return slope < 0;
    };
    const auto edge =
        [&](double low, double high) {  // where the slope vanishes between a place that restores and one that does not
            const bool above = falls(high);
            for (int i = 0; i < 80 && high - low > 1e-15 * (std::abs(low) + std::abs(high)); ++i) {
                const double middle = 0.5 * (low + high);
                (falls(middle) == above ? high : low) = middle;
            }
            return 0.5 * (low + high);
        };
    std::vector<Range> found;
    const int samples = 2000;
    double last = from;
    bool open = falls(from);
    Range range{from, from};
    for (int i = 1; i <= samples; ++i) {
        const double x = i == samples ? to : from + (to - from) * i / samples;
        const bool now = falls(x);
        if (now && !open) {
            range.lower = edge(last, x);
        }
        if (open && (!now || i == samples)) {
            range.upper = now ? to : edge(last, x);
            found.push_back(range);
        }
        open = now;
        last = x;
    }
    return found;
}

/// Where the parabola through the highest or lowest of the points around an extremum and its neighbours turns; the
/// extremum itself where there is none.
double turn_of_parabola(const Line& line, double extremum) {
    const auto& x = line.points();
    const auto nearest = std::min_element(x.begin() + 1, x.end() - 1, [&](double a, double b) {
        return std::abs(a - extremum) < std::abs(b - extremum);
    });
    const double h0 = *nearest - *(nearest - 1), h1 = *(nearest + 1) - *nearest;
    const double middle = line.value(*nearest);
    const double d0 = (middle - line.value(*(nearest - 1))) / h0, d1 = (line.value(*(nearest + 1)) - middle) / h1;
    return d0 * d1 < 0 ? *nearest - (d0 * h1 + d1 * h0) / (h0 + h1) * (h0 + h1) / (2 * (d1 - d0)) : extremum;
}

/// Standard deviations of the edges.
void set_edge_errors(std::vector<PitchWindow>& windows, const ForceTable& moment, std::size_t axis,
                     const std::vector<double>& point, bool through_points, const Line& line) {
    constexpr int draws = 40;
    std::vector<std::vector<Range>> drawn;
    for (int draw = 0; draw < draws; ++draw) {
        const ForceTable other = moment.drawn(static_cast<std::uint64_t>(draw));
        if (!through_points) {
            drawn.push_back(falling(Line(other, axis, point)));
            continue;
        }
        const std::vector<double>& x = moment.axes()[axis].points;
        std::vector<double> at = point, value, slope(x.size());
        for (const double pitch : x) {
            at[axis] = pitch;
            value.push_back(other.value(at.data()));
        }
        line_slopes(SlopeRule::not_a_knot, x, value, slope);
        drawn.push_back(falling(Line(x, std::move(value), std::move(slope))));
    }
    const auto error = [&](double edge, double Range::*side) {
        if (edge == line.lower() || edge == line.upper()) {
            return 0.0;
        }
        double square = 0, count = 0;
        for (const auto& ranges : drawn) {
            double nearest = INFINITY;
            for (const Range& r : ranges) {
                nearest = std::min(nearest, std::abs(r.*side - edge));
            }
            if (std::isfinite(nearest)) {
                square += nearest * nearest;
                ++count;
            }
        }
        const double of_points = count > 0 ? std::sqrt(square / count) : 0;
        return std::hypot(of_points, through_points ? turn_of_parabola(line, edge) - edge : 0);
    };
    for (PitchWindow& w : windows) {
        w.lower_sigma = error(w.lower, &Range::lower);
        w.upper_sigma = error(w.upper, &Range::upper);
    }
}

}  // namespace

std::vector<PitchWindow> pitch_windows(const ForceTable& moment, const Held& held) {
    const std::size_t axis = axis_index(moment, "pitch");
    std::vector<double> point = held_point(moment, axis, held);
    const bool through_points = turns_at_points(moment, axis);
    const Line line = smooth_line(moment, axis, point, through_points);
    const auto at = [&](double pitch, double& slope) { return line.value(pitch, &slope); };
    std::vector<PitchWindow> windows;
    for (const Range& range : falling(line)) {
        PitchWindow window;
        window.lower = range.lower;
        window.upper = range.upper;
        windows.push_back(window);
    }
    set_edge_errors(windows, moment, axis, point, through_points, line);
    for (auto& w : windows) {
        w.side = w.lower > 0 ? "nose up" : w.upper < 0 ? "nose down" : "level";
        w.stiffness = -1;
        w.trim_lower = INFINITY;
        w.trim_upper = -INFINITY;
        for (int i = 0; i <= 200; ++i) {
            double slope = 0;
            const double pitch = w.lower + (w.upper - w.lower) * i / 200;
            const double torque = -at(pitch, slope);
            w.trim_lower = std::min(w.trim_lower, torque);
            w.trim_upper = std::max(w.trim_upper, torque);
            if (-slope > w.stiffness) {
                w.stiffness = -slope;
                w.best_pitch = pitch;
                w.trim_torque = torque;
            }
        }
    }
    return windows;
}

core::Figure pitch_figure(const ForceTable& moment, const Held& held) {
    FigureOptions options;
    options.axis = "pitch";
    options.held = held;
    options.title = "pitch moment against pitch, nose up positive";
    core::Figure figure = curve_figure(moment, options);
    const auto x = core::conversion("rad", figure.x.unit);
    for (const auto& w : pitch_windows(moment, held)) {
        core::FigureLine line;
        line.vertical = true;
        line.colour = core::palette(2);
        line.at = x(w.lower);
        line.label = w.side + ": stable " + core::format_number(x(w.lower), 3) + " to " +
                     core::format_number(x(w.upper), 3) + " " + figure.x.unit;
        figure.lines.push_back(line);
        line.at = x(w.upper);
        line.label.clear();
        figure.lines.push_back(line);
    }
    return figure;
}

void to_json(nlohmann::json& json, const PitchWindow& w) {
    json = nlohmann::json{{"lower", w.lower},
                          {"upper", w.upper},
                          {"lower_sigma", w.lower_sigma},
                          {"upper_sigma", w.upper_sigma},
                          {"side", w.side},
                          {"best_pitch", w.best_pitch},
                          {"stiffness", w.stiffness},
                          {"trim_torque", w.trim_torque},
                          {"trim_lower", w.trim_lower},
                          {"trim_upper", w.trim_upper}};
}

namespace {

/// One table over gap and pitch, its other axes held.
class Side {
public:
    Side(const ForceTable& table, Held held)
        : table_(table), gap_(axis_index(table, "gap")), pitch_(axis_index(table, "pitch")) {
        for (const auto& [name, value] : held) {
            if (name == "gap" || name == "pitch") {
                throw core::UsageError("axis", name + " cannot be held: heave and pitch balance where both are free");
            }
        }
        held.emplace_back("gap", gap().lower);
        held.emplace_back("pitch", pitch().lower);
        point_ = held_point(table, {}, held);
    }
    [[nodiscard]] const TableAxis& gap() const { return table_.axes()[gap_]; }
    [[nodiscard]] const TableAxis& pitch() const { return table_.axes()[pitch_]; }

    /// Value and its slopes along gap and pitch.
    double at(double h, double p, double* slope) {
        point_[gap_] = h;
        point_[pitch_] = p;
        std::array<double, max_axes> s{};
        const double v = table_.value_by_policy(point_.data(), s.data(), 1U << gap_ | 1U << pitch_);
        slope[0] = s[gap_];
        slope[1] = s[pitch_];
        return v;
    }
    [[nodiscard]] double value(double h, double p) {
        double slope[2];
        return at(h, p, slope);
    }
    [[nodiscard]] double sigma(double h, double p) {
        point_[gap_] = h;
        point_[pitch_] = p;
        return table_.sigma(point_.data());
    }

private:
    const ForceTable& table_;
    std::size_t gap_, pitch_;
    std::vector<double> point_;
};

/// Lift and moment, and the box of gap and pitch that both cover.
struct Sides {
    Side force, torque;
    double gap_lower, gap_upper, pitch_lower, pitch_upper;

    Sides(const ForceTable& lift, const ForceTable& moment, const CoupledOptions& options)
        : force(lift, options.held), torque(moment, options.held) {
        if (!(options.virtual_mass >= 0) || !(options.virtual_inertia >= 0) ||
            (options.virtual_mass > 0) != (options.virtual_inertia > 0)) {
            throw core::UsageError("range", "mass and inertia must be positive, and both be given or none");
        }
        gap_lower = std::max(force.gap().lower, torque.gap().lower);
        gap_upper = std::min(force.gap().upper, torque.gap().upper);
        pitch_lower = std::max(force.pitch().lower, torque.pitch().lower);
        pitch_upper = std::min(force.pitch().upper, torque.pitch().upper);
        if (!(gap() > 0) || !(pitch() > 0)) {
            throw core::UsageError("range", "lift and moment have no common range of gap and pitch");
        }
    }
    [[nodiscard]] bool holds(double h, double p) const {
        return h >= gap_lower && h <= gap_upper && p >= pitch_lower && p <= pitch_upper;
    }
    [[nodiscard]] double gap() const { return gap_upper - gap_lower; }
    [[nodiscard]] double pitch() const { return pitch_upper - pitch_lower; }
    /// At shares of the ranges; small gaps, where the forces change, lie closer.
    [[nodiscard]] double gap_at(double t) const {
        const bool log = gap_lower > 0 && gap_upper / gap_lower > 4;
        return t >= 1 ? gap_upper : log ? gap_lower * std::pow(gap_upper / gap_lower, t) : gap_lower + gap() * t;
    }
    [[nodiscard]] double pitch_at(double t) const { return t >= 1 ? pitch_upper : pitch_lower + pitch() * t; }
};

struct Place {
    double gap = 0, pitch = 0;
};

/// Newton on (force, moment) = 0; nothing when it leaves the box, or its first step is longer than `reach`.
std::optional<Place> balance_near(Sides& sides, const CoupledOptions& options, Place at, Place reach) {
    double fs[2], ms[2];
    for (int k = 0; k < 30; ++k) {
        const double f = sides.force.at(at.gap, at.pitch, fs) - options.net_weight;
        const double m = sides.torque.at(at.gap, at.pitch, ms) + options.trim_torque;
        const double det = fs[0] * ms[1] - fs[1] * ms[0];
        if (det == 0) {
            return std::nullopt;
        }
        const double dh = (f * ms[1] - fs[1] * m) / det;
        const double dp = (fs[0] * m - f * ms[0]) / det;
        if (k == 0 && (std::abs(dh) > reach.gap || std::abs(dp) > reach.pitch)) {
            return std::nullopt;
        }
        at.gap -= dh;
        at.pitch -= dp;
        if (!sides.holds(at.gap, at.pitch)) {
            return std::nullopt;
        }
        if (std::abs(dh) < 1e-13 * sides.gap() && std::abs(dp) < 1e-13 * sides.pitch()) {
            return at;
        }
    }
    return std::nullopt;
}

CoupledEquilibrium described(Sides& sides, const CoupledOptions& options, Place at) {
    double fs[2], ms[2];
    sides.force.at(at.gap, at.pitch, fs);
    sides.torque.at(at.gap, at.pitch, ms);
    CoupledEquilibrium e;
    e.gap = at.gap;
    e.pitch = at.pitch;
    e.stiffness = {{{-fs[0], -fs[1]}, {-ms[0], -ms[1]}}};
    const double lift_sigma = sides.force.sigma(at.gap, at.pitch), moment_sigma = sides.torque.sigma(at.gap, at.pitch);
    if (lift_sigma > 0 || moment_sigma > 0) {
        const double det = std::abs(fs[0] * ms[1] - fs[1] * ms[0]);
        e.gap_sigma = std::hypot(ms[1] * lift_sigma, fs[1] * moment_sigma) / det;
        e.pitch_sigma = std::hypot(ms[0] * lift_sigma, fs[0] * moment_sigma) / det;
    }
    const bool masses = options.virtual_mass > 0;
    const double mass = masses ? options.virtual_mass : 1, inertia = masses ? options.virtual_inertia : 1;
    const double a = e.stiffness[0][0] / mass, b = e.stiffness[0][1] / mass;
    const double c = e.stiffness[1][0] / inertia, d = e.stiffness[1][1] / inertia;
    const std::complex<double> root = std::sqrt(std::complex<double>((a - d) * (a - d) / 4 + b * c));
    e.eigenvalues = {(a + d) / 2 - root, (a + d) / 2 + root};
    e.kind = root.imag() != 0 ? "flutter" : e.eigenvalues[0].real() > 0 ? "stable" : "divergent";
    for (std::size_t i = 0; i < 2 && masses && e.kind == "stable"; ++i) {
        e.frequency[i] = std::sqrt(e.eigenvalues[i].real()) / (2 * std::numbers::pi);
    }
    return e;
}

}  // namespace

std::vector<CoupledEquilibrium> coupled_equilibria(const ForceTable& lift, const ForceTable& moment,
                                                   const CoupledOptions& options) {
    Sides sides(lift, moment, options);
    const int n = 60;
    std::vector<CoupledEquilibrium> found;
    for (int i = 0; i < n; ++i) {
        // From the middle of its cell a start may walk a few cells, no further: every equilibrium has starts near it.
        const Place reach{6 * (sides.gap_at((i + 1.0) / n) - sides.gap_at(static_cast<double>(i) / n)),
                          6 * sides.pitch() / n};
        for (int j = 0; j < n; ++j) {
            const auto place =
                balance_near(sides, options, {sides.gap_at((i + 0.5) / n), sides.pitch_at((j + 0.5) / n)}, reach);
            const bool known = place && std::any_of(found.begin(), found.end(), [&](const auto& e) {
                                   return std::abs(e.gap - place->gap) < 1e-7 * sides.gap() &&
                                          std::abs(e.pitch - place->pitch) < 1e-7 * sides.pitch();
                               });
            if (place && !known) {
                found.push_back(described(sides, options, *place));
            }
        }
    }
    std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
    return found;
}

namespace {

/// Over gap and pitch, in steps that show what a grid of the tables shows.
std::vector<ZeroLine> balance_lines(const Sides& sides, const PlaneFunction& f) {
    std::vector<double> gaps, pitches;
    const int n = 200;
    for (int i = 0; i <= n; ++i) {
        gaps.push_back(sides.gap_at(static_cast<double>(i) / n));
        pitches.push_back(sides.pitch_at(static_cast<double>(i) / n));
    }
    return zero_lines(f, gaps, pitches);
}

}  // namespace

std::optional<std::pair<double, double>> trim_range(const ForceTable& lift, const ForceTable& moment,
                                                    const CoupledOptions& options) {
    Sides sides(lift, moment, options);
    double low = INFINITY, high = -INFINITY;
    for (const auto& line :
         balance_lines(sides, [&](double h, double p) { return sides.force.value(h, p) - options.net_weight; })) {
        for (const auto& [h, p] : line) {
            low = std::min(low, -sides.torque.value(h, p));
            high = std::max(high, -sides.torque.value(h, p));
        }
    }
    return low <= high ? std::optional(std::pair(low, high)) : std::nullopt;
}

core::Figure coupled_figure(const ForceTable& lift, const ForceTable& moment, const CoupledOptions& options) {
    Sides sides(lift, moment, options);
    core::Figure figure;
    figure.title = "balance of heave and pitch";
    figure.caption = "Net weight " + core::format_number(options.net_weight, 4) + " N, trim torque " +
                     core::format_number(options.trim_torque, 4) + " N m nose up.";
    figure.x = {"gap", shown_unit(lift, "gap"), 0, 0, spans_decades(sides.gap_lower, sides.gap_upper)};
    figure.y = {"pitch", shown_unit(lift, "pitch"), 0, 0, false};
    const auto x_shown = core::conversion("m", figure.x.unit), y_shown = core::conversion("rad", figure.y.unit);
    const auto draw = [&](const PlaneFunction& f, std::string name, core::Colour colour) {
        for (const auto& line : balance_lines(sides, f)) {
            core::FigureCurve curve;
            curve.name = std::exchange(name, "");
            curve.colour = colour;
            for (const auto& [h, p] : line) {
                curve.x.push_back(x_shown(h));
                curve.y.push_back(y_shown(p));
            }
            figure.curves.push_back(std::move(curve));
        }
    };
    draw([&](double h, double p) { return sides.force.value(h, p) - options.net_weight; }, "lift holds the weight",
         core::palette(0));
    draw([&](double h, double p) { return sides.torque.value(h, p) + options.trim_torque; },
         "pitch moment holds the trim", core::palette(1));
    const auto found = coupled_equilibria(lift, moment, options);
    for (const std::string kind : {"stable", "flutter", "divergent"}) {
        core::FigurePoints marks;
        marks.name = kind;
        marks.shape = kind == "stable" ? core::FigurePoints::Shape::disc : core::FigurePoints::Shape::circle;
        marks.colour = core::palette(kind == "stable" ? 2 : kind == "flutter" ? 4 : 5);
        marks.size = 11;
        for (const auto& e : found) {
            if (e.kind == kind) {
                marks.x.push_back(x_shown(e.gap));
                marks.y.push_back(y_shown(e.pitch));
            }
        }
        if (!marks.x.empty()) {
            figure.points.push_back(std::move(marks));
        }
    }
    return figure;
}

void to_json(nlohmann::json& json, const CoupledEquilibrium& e) {
    json = nlohmann::json{{"gap", e.gap},
                          {"gap_sigma", e.gap_sigma},
                          {"pitch", e.pitch},
                          {"pitch_sigma", e.pitch_sigma},
                          {"stiffness", e.stiffness},
                          {"kind", e.kind},
                          {"stable", e.kind == "stable"},
                          {"frequency", e.frequency}};
    for (const auto& v : e.eigenvalues) {
        json["eigenvalues"].push_back({{"real", v.real()}, {"imaginary", v.imag()}});
    }
}

}  // namespace underbody::tables
