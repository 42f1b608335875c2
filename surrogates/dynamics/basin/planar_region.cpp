#include "surrogates/dynamics/basin/planar_region.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "surrogates/dynamics/model/dense.h"
#include "surrogates/dynamics/simulate/dormand_prince.h"

namespace underbody::dynamics {

namespace {

struct Rate {
    const PlanarSystem* system;
    void operator()(double, const double* y, double* d) const { system->rate(y, d); }
};
using Integrator = DormandPrince<2, Rate>;

struct Attractor {
    std::array<double, 2> at{};
    Dense p;
    double level = 0;
};

Dense jacobian(const PlanarSystem& s, const std::array<double, 2>& at) {
    const double size[2] = {s.x_upper - s.x_lower, s.y_upper - s.y_lower};
    Dense j(2, 2);
    for (std::size_t k = 0; k < 2; ++k) {
        std::array<double, 2> plus = at, minus = at;
        plus[k] += 1e-6 * size[k];
        minus[k] -= 1e-6 * size[k];
        double up[2], down[2];
        s.rate(plus.data(), up);
        s.rate(minus.data(), down);
        for (std::size_t i = 0; i < 2; ++i) {
            j(i, k) = (up[i] - down[i]) / (2e-6 * size[k]);
        }
    }
    return j;
}

bool newton(const PlanarSystem& s, std::array<double, 2>& at) {
    for (int step = 0; step < 50; ++step) {
        double f[2];
        s.rate(at.data(), f);
        const Dense j = jacobian(s, at);
        const double determinant = j(0, 0) * j(1, 1) - j(0, 1) * j(1, 0);
        if (!(std::abs(determinant) > 1e-14)) {
            return false;
        }
        const double dx = -(f[0] * j(1, 1) - f[1] * j(0, 1)) / determinant,
                     dy = -(f[1] * j(0, 0) - f[0] * j(1, 0)) / determinant;
        at[0] += dx;
        at[1] += dy;
        if (!(at[0] > s.x_lower && at[0] < s.x_upper && at[1] > s.y_lower && at[1] < s.y_upper)) {
            return false;
        }
        if (std::abs(dx) < 1e-12 * (s.x_upper - s.x_lower) && std::abs(dy) < 1e-12 * (s.y_upper - s.y_lower)) {
            return true;
        }
    }
    return false;
}

/// The largest level of x'Px (within the bounds) on whose shells the motion goes inward.
void grow(const PlanarSystem& s, Attractor& a) {
    const auto falls = [&](double radius) {
        for (int k = 0; k < 360; ++k) {
            const double angle = 2 * 3.14159265358979323846 * k / 360;
            double x[2] = {std::cos(angle) * (s.x_upper - s.x_lower), std::sin(angle) * (s.y_upper - s.y_lower)};
            const double norm =
                std::sqrt(a.p(0, 0) * x[0] * x[0] + 2 * a.p(0, 1) * x[0] * x[1] + a.p(1, 1) * x[1] * x[1]);
            x[0] *= radius / norm;
            x[1] *= radius / norm;
            const double at[2] = {a.at[0] + x[0], a.at[1] + x[1]};
            if (at[0] <= s.x_lower || at[0] >= s.x_upper || at[1] <= s.y_lower || at[1] >= s.y_upper) {
                return false;
            }
            double d[2];
            s.rate(at, d);
            if (!(x[0] * (a.p(0, 0) * d[0] + a.p(0, 1) * d[1]) + x[1] * (a.p(1, 0) * d[0] + a.p(1, 1) * d[1]) < 0)) {
                return false;
            }
        }
        return true;
    };
    double radius = 1e-8;
    while (radius < 1e8 && falls(radius)) {
        radius *= 1.1;
    }
    radius /= 1.1 * 1.1;
    a.level = radius * radius;
}

std::vector<Attractor> attractors_of(const PlanarSystem& s) {
    std::vector<std::array<double, 2>> seeds = s.seeds;
    if (seeds.empty()) {
        for (int i = 0; i <= 20; ++i) {
            for (int j = 0; j <= 20; ++j) {
                seeds.push_back(
                    {s.x_lower + (s.x_upper - s.x_lower) * i / 20, s.y_lower + (s.y_upper - s.y_lower) * j / 20});
            }
        }
    }
    std::vector<Attractor> found;
    for (std::array<double, 2> at : seeds) {
        if (!newton(s, at)) {
            continue;
        }
        const bool known = std::any_of(found.begin(), found.end(), [&](const Attractor& a) {
            return std::abs(a.at[0] - at[0]) < 1e-7 * (s.x_upper - s.x_lower) &&
                   std::abs(a.at[1] - at[1]) < 1e-7 * (s.y_upper - s.y_lower);
        });
        const Dense j = jacobian(s, at);
        const double trace = j(0, 0) + j(1, 1), determinant = j(0, 0) * j(1, 1) - j(0, 1) * j(1, 0);
        if (known || !(trace < 0) || !(determinant > 0)) {
            continue;
        }
        Attractor a;
        a.at = at;
        const double wx = 1 / (s.x_upper - s.x_lower), wy = 1 / (s.y_upper - s.y_lower);
        a.p = lyapunov(j, Dense::diagonal({wx * wx, wy * wy}));
        grow(s, a);
        found.push_back(std::move(a));
    }
    std::sort(found.begin(), found.end(), [](const Attractor& l, const Attractor& r) { return l.at < r.at; });
    return found;
}

/// What one start does: an attractor's number, or -1 escape, -2 undecided, -3 a cycle (its turn in `cycle`).
int follow(const PlanarSystem& s, const std::vector<Attractor>& attractors, const std::array<double, 2>& start,
           double duration, double tolerance, std::vector<std::array<double, 2>>& cycle) {
    const double sx = s.x_upper - s.x_lower, sy = s.y_upper - s.y_lower;
    const Rate rate{&s};
    Integrator ode(rate, 0.0, start, {tolerance * sx, tolerance * sy}, 1e-3);
    double last_crossing = std::nan("");
    int same = 0;
    std::vector<std::array<double, 2>> turn;
    while (ode.t() < duration) {
        if (!ode.step(duration) || ode.tries() > 1000000) {
            return -2;
        }
        const auto& y = ode.y();
        if (y[0] <= s.x_lower || y[0] >= s.x_upper || y[1] <= s.y_lower || y[1] >= s.y_upper) {
            return -1;
        }
        for (std::size_t k = 0; k < attractors.size(); ++k) {
            const Attractor& a = attractors[k];
            const double x0 = y[0] - a.at[0], x1 = y[1] - a.at[1];
            if (a.p(0, 0) * x0 * x0 + 2 * a.p(0, 1) * x0 * x1 + a.p(1, 1) * x1 * x1 < a.level) {
                return static_cast<int>(k);
            }
        }
        for (int k = 1; k <= 4; ++k) {
            turn.push_back({ode.between(k / 4.0, 0), ode.between(k / 4.0, 1)});
        }
        // Section: the rate of x changes from positive to negative (a turning point on the right).
        if (ode.before_rate()[0] > 0 && ode.rate()[0] <= 0) {
            const double part = ode.before_rate()[0] / (ode.before_rate()[0] - ode.rate()[0]);
            const double crossing = ode.between(part, 0);
            same = std::abs(crossing - last_crossing) < 1e-6 * sx ? same + 1 : 0;
            last_crossing = crossing;
            if (same >= 3) {
                cycle = turn;
                return -3;
            }
            turn.clear();
        }
    }
    return -2;
}

}  // namespace

PlanarRegion planar_region(const PlanarSystem& system, const std::vector<core::NamedRange>& axes, std::size_t columns,
                           std::size_t rows, double duration, double tolerance, core::Progress& progress) {
    if (axes.size() != 2 || columns < 1 || rows < 1 || !(duration > 0)) {
        throw core::InputError("range", "a region needs two axes, starts and a duration");
    }
    const std::vector<Attractor> attractors = attractors_of(system);
    PlanarRegion region;
    region.axes = axes;
    region.columns = columns;
    region.rows = rows;
    std::vector<int> ends(columns * rows);
    std::vector<std::vector<std::array<double, 2>>> cycles(ends.size());
    core::parallel_blocks(
        ends.size(), 64,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const auto part = [](const core::NamedRange& axis, std::size_t i, std::size_t count) {
                    return axis.lower +
                           (axis.upper - axis.lower) * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
                };
                ends[k] =
                    follow(system, attractors, {part(axes[0], k % columns, columns), part(axes[1], k / columns, rows)},
                           duration, tolerance, cycles[k]);
            }
        },
        progress);
    for (const Attractor& a : attractors) {
        region.classes.push_back({std::string(1, static_cast<char>('A' + static_cast<int>(region.classes.size()) % 26)),
                                  EndKind::attractor, a.at[0], 0});
        region.attractors.push_back(a.at);
    }
    const auto first_cycle = static_cast<int>(region.classes.size());
    // Cycles are told apart by their extent.
    const auto extent = [](const std::vector<std::array<double, 2>>& line) {
        double most = -1e300;
        for (const auto& point : line) {
            most = std::max(most, point[0]);
        }
        return most;
    };
    std::vector<int> number(ends.size(), 0);
    for (std::size_t k = 0; k < ends.size(); ++k) {
        if (ends[k] != -3) {
            continue;
        }
        std::size_t c = 0;
        while (c < region.cycles.size() &&
               std::abs(extent(region.cycles[c]) - extent(cycles[k])) > 1e-4 * (system.x_upper - system.x_lower)) {
            ++c;
        }
        if (c == region.cycles.size()) {
            region.cycles.push_back(cycles[k]);
            region.classes.push_back({"cycle " + std::to_string(c + 1), EndKind::cycle});
        }
        number[k] = static_cast<int>(c);
    }
    const int escape = static_cast<int>(region.classes.size());
    region.classes.push_back({"escape", EndKind::escape});
    region.classes.push_back({"undecided", EndKind::undecided});
    for (std::size_t k = 0; k < ends.size(); ++k) {
        const int index = ends[k] >= 0    ? ends[k]
                          : ends[k] == -3 ? first_cycle + number[k]
                          : ends[k] == -1 ? escape
                                          : escape + 1;
        region.index.push_back(index);
        region.classes[static_cast<std::size_t>(index)].fraction += 1.0 / static_cast<double>(ends.size());
    }
    return region;
}

double PlanarRegion::fraction(const std::string& name) const {
    for (const EndClass& end : classes) {
        if (end.name == name) {
            return end.fraction;
        }
    }
    return 0;
}

double enclosed_area(const std::vector<std::array<double, 2>>& line) {
    double sum = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const auto& a = line[i];
        const auto& b = line[(i + 1) % line.size()];
        sum += a[0] * b[1] - b[0] * a[1];
    }
    return std::abs(sum) / 2;
}

}  // namespace underbody::dynamics
