#include "surrogates/tables/fit/line.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "core/told.h"

namespace underbody::tables {

std::size_t axis_index(const ForceTable& table, const std::string& name) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < table.axes().size(); ++k) {
        if (table.axes()[k].name == name) {
            return k;
        }
        names.push_back(table.axes()[k].name);
    }
    throw core::UsageError("axis", "the table has no axis '" + name + "'", {table.source(), {}, {}, {}},
                           core::did_you_mean(name, names));
}

namespace {

/// A value that may be held of an axis.
void check_held(const ForceTable& table, std::size_t k, std::optional<std::size_t> free_axis, double value) {
    const auto& axes = table.axes();
    const std::string& name = axes[k].name;
    if (k == free_axis) {
        throw core::UsageError("axis", name + " cannot be held: it is what varies", {table.source(), {}, {}, {}});
    }
    if (!std::isfinite(value)) {
        throw core::UsageError("range", name + " is not finite", {table.source(), {}, {}, {}});
    }
    if (name == "gap" && value < 0 && axes[k].lower >= 0) {
        throw core::UsageError("range", "a gap of " + core::format_number(1e3 * value, 6) + " mm lies in the ground",
                               {table.source(), {}, {}, {}},
                               "the table begins at " + core::format_number(1e3 * axes[k].lower, 6) + " mm");
    }
}

}  // namespace

std::vector<double> held_point(const ForceTable& table, std::optional<std::size_t> free_axis, const Held& held,
                               core::Problems* remarks) {
    const auto& axes = table.axes();
    std::vector<double> point(axes.size(), std::nan(""));
    for (const auto& [name, value] : held) {
        bool known = false;
        for (const auto& [condition, constant] : table.conditions()) {
            if (condition == name) {
                known = true;
                if (std::abs(value - constant) > 1e-9 * std::max(std::abs(value), std::abs(constant))) {
                    throw core::UsageError(
                        "axis",
                        "the table holds for " + core::told_condition(name, constant) + " only, not for " +
                            core::told_condition(name, value),
                        {table.source(), {}, {}, {}},
                        "take points at several values of " + name + ", or scale the force by a law");
                }
            }
        }
        if (!known) {
            const std::size_t k = axis_index(table, name);
            check_held(table, k, free_axis, value);
            point[k] = value;
        }
    }
    for (std::size_t k = 0; k < axes.size(); ++k) {
        if (k == free_axis) {
            point[k] = 0.5 * (axes[k].lower + axes[k].upper);
        } else if (std::isnan(point[k])) {
            const bool level = axes[k].name == "pitch" && axes[k].lower <= 0 && axes[k].upper >= 0;
            if (!level) {
                throw core::UsageError(
                    "axis", "the table has an axis '" + axes[k].name + "' whose value is not given",
                    {table.source(), {}, {}, {}},
                    "say " + axes[k].name + "=VALUE, " + core::told_range(axes[k].lower, axes[k].upper, axes[k].unit));
            }
            point[k] = 0;
            if (remarks != nullptr) {
                remarks->push_back({core::Problem::Severity::note,
                                    axes[k].name + " is not given: 0 is taken",
                                    {table.source(), {}, {}, {}}});
            }
        }
    }
    return point;
}

Line::Line(const ForceTable& table, std::size_t axis, std::vector<double> point) : x_(table.knots(axis)) {
    std::array<double, max_axes> slope{};
    for (const double x : x_) {
        point[axis] = x;
        value_.push_back(table.value_by_policy(point.data(), slope.data(), 1U << axis));
        slope_.push_back(slope[axis]);
    }
    prepare();
}

Line::Line(std::vector<double> x, std::vector<double> value, std::vector<double> slope)
    : x_(std::move(x)), value_(std::move(value)), slope_(std::move(slope)) {
    prepare();
}

void Line::prepare() {
    integral_.assign(x_.size(), 0.0);
    for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
        const double h = x_[i + 1] - x_[i];
        integral_[i + 1] =
            integral_[i] + h * (value_[i] + value_[i + 1]) / 2 + h * h * (slope_[i] - slope_[i + 1]) / 12;
    }
}

Line Line::scaled(double scale, double shift) const {
    std::vector<double> value = value_;
    std::vector<double> slope = slope_;
    for (std::size_t i = 0; i < value.size(); ++i) {
        value[i] = scale * value[i] + shift;
        slope[i] *= scale;
    }
    return {x_, std::move(value), std::move(slope)};
}

double Line::size() const {
    double size = 0;
    for (const double v : value_) {
        size = std::max(size, std::abs(v));
    }
    return size;
}

std::size_t Line::cell(double x) const noexcept {
    const auto next = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
    return static_cast<std::size_t>(next - x_.begin()) - 1;
}

namespace {

/// Cubic on a cell in t = x - x0.
struct Cubic {
    double c0, c1, c2, c3;
    [[nodiscard]] double operator()(double t) const { return c0 + t * (c1 + t * (c2 + t * c3)); }
    [[nodiscard]] double slope(double t) const { return c1 + t * (2 * c2 + 3 * t * c3); }
};

Cubic cubic_of(double h, double a, double b, double s, double t) {
    const double secant = (b - a) / h;
    return {a, s, (3 * secant - 2 * s - t) / h, (s + t - 2 * secant) / (h * h)};
}

/// Zeros of the slope inside (0, h), ascending.
std::vector<double> turning_points(const Cubic& c, double h) {
    std::vector<double> found;
    const double a = 3 * c.c3;
    const double b = 2 * c.c2;
    const double discriminant = b * b - 4 * a * c.c1;
    if (discriminant >= 0) {
        const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
        for (const double t : {q != 0 ? c.c1 / q : h + h, a != 0 ? q / a : h + h}) {
            if (t > 0 && t < h) {
                found.push_back(t);
            }
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

int sign_of(double v, double tolerance) { return v > tolerance ? 1 : v < -tolerance ? -1 : 0; }

/// The zero between two ends of opposite sign where the cubic is monotone: Newton kept inside a bracket.
double zero_between(const Cubic& c, double low, double high) {
    const bool rising = c(high) > c(low);
    double t = 0.5 * (low + high);
    for (int i = 0; i < 200; ++i) {
        const double v = c(t);
        if (v == 0) {
            return t;
        }
        ((v > 0) == rising ? high : low) = t;
        const double s = c.slope(t);
        double next = s != 0 ? t - v / s : low;
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        if (next == t || high - low <= 4e-16 * std::max(std::abs(low), std::abs(high))) {
            return next;
        }
        t = next;
    }
    return t;
}

}  // namespace

double Line::value(double x, double* slope) const noexcept {
    if (!(x >= x_.front())) {
        if (slope != nullptr) {
            *slope = 0;
        }
        return std::isnan(x) ? x : value_.front();
    }
    if (x > x_.back()) {
        if (slope != nullptr) {
            *slope = 0;
        }
        return value_.back();
    }
    const std::size_t i = cell(x);
    const Cubic c = cubic_of(x_[i + 1] - x_[i], value_[i], value_[i + 1], slope_[i], slope_[i + 1]);
    if (slope != nullptr) {
        *slope = c.slope(x - x_[i]);
    }
    return c(x - x_[i]);
}

double Line::integral(double x) const noexcept {
    const std::size_t i = cell(x);
    const Cubic c = cubic_of(x_[i + 1] - x_[i], value_[i], value_[i + 1], slope_[i], slope_[i + 1]);
    const double t = x - x_[i];
    return integral_[i] + t * (c.c0 + t * (c.c1 / 2 + t * (c.c2 / 3 + t * c.c3 / 4)));
}

/// The line is cut into monotone stretches; the signs at their ends tell where zeros lie.
std::vector<Line::Extreme> Line::extremes() const {
    // Knots and turning points part the line into pieces that rise or fall throughout.
    std::vector<std::pair<double, double>> marks;
    const auto mark = [&](double x, double value) {
        if (marks.empty() || value != marks.back().second) {
            marks.emplace_back(x, value);
        }
    };
    for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
        const double h = x_[i + 1] - x_[i];
        const Cubic c = cubic_of(h, value_[i], value_[i + 1], slope_[i], slope_[i + 1]);
        mark(x_[i], value_[i]);
        for (const double t : turning_points(c, h)) {
            mark(x_[i] + t, c(t));
        }
    }
    mark(x_.back(), value_.back());
    std::vector<Extreme> found;
    const double rounding = 1e-13 * size();
    for (std::size_t i = 1; i + 1 < marks.size(); ++i) {
        const double before = marks[i].second - marks[i - 1].second, after = marks[i + 1].second - marks[i].second;
        if (before * after < 0 && std::min(std::abs(before), std::abs(after)) > rounding) {
            found.push_back({marks[i].first, marks[i].second, before > 0});
        }
    }
    return found;
}

namespace {

/// Where a line may be zero or turn.
struct Mark {
    double x, value, slope;
};

/// Zeros at the marks themselves: knots and touching extrema; neighbours that are both zero make a stretch.
void add_zeros_at(const std::vector<Mark>& marks, double tolerance, std::vector<Line::Zero>& crossings) {
    for (std::size_t i = 0; i < marks.size();) {
        if (sign_of(marks[i].value, tolerance) != 0) {
            ++i;
            continue;
        }
        std::size_t last = i;
        while (last + 1 < marks.size() && sign_of(marks[last + 1].value, tolerance) == 0) {
            ++last;
        }
        Line::Zero zero;
        zero.x = 0.5 * (marks[i].x + marks[last].x);
        zero.extent = marks[last].x - marks[i].x;
        zero.slope = last > i ? 0 : marks[i].slope;
        zero.before = i > 0 ? sign_of(marks[i - 1].value, tolerance) : 0;
        zero.after = last + 1 < marks.size() ? sign_of(marks[last + 1].value, tolerance) : 0;
        crossings.push_back(zero);
        i = last + 1;
    }
}

}  // namespace

std::vector<Line::Zero> Line::zeros() const {
    const double tolerance = 1e-14 * size();
    std::vector<Mark> marks;
    std::vector<Zero> crossings;
    for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
        const double h = x_[i + 1] - x_[i];
        const Cubic c = cubic_of(h, value_[i], value_[i + 1], slope_[i], slope_[i + 1]);
        marks.push_back({x_[i], value_[i], slope_[i]});
        double low = 0;
        double at_low = value_[i];
        std::vector<double> stops = turning_points(c, h);
        stops.push_back(h);
        for (const double high : stops) {
            const double at_high = high == h ? value_[i + 1] : c(high);
            const int before = sign_of(at_low, tolerance);
            const int after = sign_of(at_high, tolerance);
            if (before * after < 0) {
                const double t = zero_between(c, low, high);
                crossings.push_back({x_[i] + t, c.slope(t), before, after, 0});
            }
            if (high != h) {
                marks.push_back({x_[i] + high, at_high, 0});
            }
            low = high;
            at_low = at_high;
        }
    }
    marks.push_back({x_.back(), value_.back(), slope_.back()});
    add_zeros_at(marks, tolerance, crossings);
    std::sort(crossings.begin(), crossings.end(), [](const Zero& a, const Zero& b) { return a.x < b.x; });
    return crossings;
}

}  // namespace underbody::tables
