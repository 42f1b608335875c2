#include "surrogates/tables/pitch.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/figures.h"

namespace underbody::tables {

std::vector<PitchWindow> pitch_windows(const ForceTable& moment, const Held& held) {
    const std::size_t axis = axis_index(moment, "pitch");
    std::vector<double> point = held_point(moment, axis, held);
    const auto at = [&](double pitch, double& slope) {
        std::array<double, max_axes> s{};
        point[axis] = pitch;
        const double m = moment.value_by_policy(point.data(), s.data(), 1U << axis);
        slope = s[axis];
        return m;
    };
    std::vector<PitchWindow> windows;
    const auto& a = moment.axes()[axis];
    const int samples = 2000;
    double last_slope = 0;
    double last = a.lower;
    at(a.lower, last_slope);
    const auto edge = [&](double low, double high) {  // where the slope vanishes between a place that restores and one that does not
        double s = 0;
        at(high, s);
        const bool restores_above = s < 0;
        for (int i = 0; i < 80 && high - low > 1e-15 * (std::abs(low) + std::abs(high)); ++i) {
            const double middle = 0.5 * (low + high);
            at(middle, s);
            ((s < 0) == restores_above ? high : low) = middle;
        }
        return 0.5 * (low + high);
    };
    bool open = last_slope < 0;
    PitchWindow window;
    window.lower = a.lower;
    for (int i = 1; i <= samples; ++i) {
        const double pitch = i == samples ? a.upper : a.lower + (a.upper - a.lower) * i / samples;
        double slope = 0;
        at(pitch, slope);
        const bool restoring = slope < 0;
        if (restoring && !open) {
            window = {};
            window.lower = edge(last, pitch);
        }
        if (open && (!restoring || i == samples)) {
            window.upper = restoring ? a.upper : edge(last, pitch);
            windows.push_back(window);
        }
        open = restoring;
        last = pitch;
    }
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
        line.label = w.side + ": stable " + core::format_number(x(w.lower), 3) + " to " + core::format_number(x(w.upper), 3) + " " + figure.x.unit;
        figure.lines.push_back(line);
        line.at = x(w.upper);
        line.label.clear();
        figure.lines.push_back(line);
    }
    return figure;
}

void to_json(nlohmann::json& json, const PitchWindow& w) {
    json = nlohmann::json{{"lower", w.lower},         {"upper", w.upper},           {"side", w.side},           {"best_pitch", w.best_pitch},
                          {"stiffness", w.stiffness}, {"trim_torque", w.trim_torque}, {"trim_lower", w.trim_lower}, {"trim_upper", w.trim_upper}};
}

namespace {

/// One table over gap and pitch, its other axes held.
class Side {
public:
    Side(const ForceTable& table, Held held) : table_(table), gap_(axis_index(table, "gap")), pitch_(axis_index(table, "pitch")) {
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

private:
    const ForceTable& table_;
    std::size_t gap_, pitch_;
    std::vector<double> point_;
};

/// The box of gap and pitch that both tables cover.
struct Box {
    double gap_lower, gap_upper, pitch_lower, pitch_upper;
    [[nodiscard]] bool holds(double h, double p) const { return h >= gap_lower && h <= gap_upper && p >= pitch_lower && p <= pitch_upper; }
    [[nodiscard]] double gap() const { return gap_upper - gap_lower; }
    [[nodiscard]] double pitch() const { return pitch_upper - pitch_lower; }
};

struct Place {
    double gap = 0, pitch = 0;
};

/// Newton on (force, moment) = 0; nothing when it leaves the box, or its first step is longer than `reach`.
std::optional<Place> balance_near(Side& force, Side& torque, const CoupledOptions& options, const Box& box, Place at, Place reach) {
    double fs[2], ms[2];
    for (int k = 0; k < 30; ++k) {
        const double f = force.at(at.gap, at.pitch, fs) - options.net_weight;
        const double m = torque.at(at.gap, at.pitch, ms) + options.trim_torque;
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
        if (!box.holds(at.gap, at.pitch)) {
            return std::nullopt;
        }
        if (std::abs(dh) < 1e-13 * box.gap() && std::abs(dp) < 1e-13 * box.pitch()) {
            return at;
        }
    }
    return std::nullopt;
}

CoupledEquilibrium described(Side& force, Side& torque, const CoupledOptions& options, Place at) {
    double fs[2], ms[2];
    force.at(at.gap, at.pitch, fs);
    torque.at(at.gap, at.pitch, ms);
    CoupledEquilibrium e;
    e.gap = at.gap;
    e.pitch = at.pitch;
    e.stiffness = {{{-fs[0], -fs[1]}, {-ms[0], -ms[1]}}};
    const bool masses = options.virtual_mass > 0 && options.virtual_inertia > 0;
    const double mass = masses ? options.virtual_mass : 1, inertia = masses ? options.virtual_inertia : 1;
    const double a = e.stiffness[0][0] / mass, b = e.stiffness[0][1] / mass;
    const double c = e.stiffness[1][0] / inertia, d = e.stiffness[1][1] / inertia;
    const std::complex<double> root = std::sqrt(std::complex<double>((a - d) * (a - d) / 4 + b * c));
    e.eigenvalues = {(a + d) / 2 - root, (a + d) / 2 + root};
    e.kind = root.imag() != 0 ? "flutter" : e.eigenvalues[0].real() > 0 ? "stable" : "divergent";
    return e;
}

}  // namespace

std::vector<CoupledEquilibrium> coupled_equilibria(const ForceTable& lift, const ForceTable& moment, const CoupledOptions& options) {
    Side force(lift, options.held);
    Side torque(moment, options.held);
    const Box box{std::max(force.gap().lower, torque.gap().lower), std::min(force.gap().upper, torque.gap().upper),
                  std::max(force.pitch().lower, torque.pitch().lower), std::min(force.pitch().upper, torque.pitch().upper)};
    if (!(box.gap() > 0) || !(box.pitch() > 0)) {
        throw core::UsageError("range", "lift and moment have no common range of gap and pitch");
    }
    const int n = 60;
    const bool log = box.gap_lower > 0 && box.gap_upper / box.gap_lower > 4;
    const auto gap_at = [&](double t) { return log ? box.gap_lower * std::pow(box.gap_upper / box.gap_lower, t) : box.gap_lower + box.gap() * t; };
    std::vector<CoupledEquilibrium> found;
    for (int i = 0; i < n; ++i) {
        // From the middle of its cell a start may walk a few cells, no further: every equilibrium has starts near it.
        const Place reach{6 * (gap_at((i + 1.0) / n) - gap_at(static_cast<double>(i) / n)), 6 * box.pitch() / n};
        for (int j = 0; j < n; ++j) {
            const auto place = balance_near(force, torque, options, box, {gap_at((i + 0.5) / n), box.pitch_lower + box.pitch() * (j + 0.5) / n}, reach);
            const bool known = place && std::any_of(found.begin(), found.end(), [&](const auto& e) {
                return std::abs(e.gap - place->gap) < 1e-7 * box.gap() && std::abs(e.pitch - place->pitch) < 1e-7 * box.pitch();
            });
            if (place && !known) {
                found.push_back(described(force, torque, options, *place));
            }
        }
    }
    std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
    return found;
}

void to_json(nlohmann::json& json, const CoupledEquilibrium& e) {
    json = nlohmann::json{{"gap", e.gap}, {"pitch", e.pitch}, {"stiffness", e.stiffness}, {"kind", e.kind}, {"stable", e.kind == "stable"}};
    for (const auto& v : e.eigenvalues) {
        json["eigenvalues"].push_back({{"real", v.real()}, {"imaginary", v.imag()}});
    }
}

}  // namespace underbody::tables
