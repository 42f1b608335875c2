// The smallest grid that keeps an error: axis by axis a shortest path over the grid lines there are; for consumers that
// evaluate the cubic, and for those that draw straight lines between the points.
#include <algorithm>
#include <cmath>
#include <limits>

#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

/// Data of all grid lines along one axis: value and slope at each point, line by line.
struct Lines {
    std::vector<double> x;
    std::size_t count = 0;
    std::vector<double> value;  ///< [line * points + i]
    std::vector<double> slope;
};

Lines lines_along(const CubicGrid& grid, std::size_t k) {
    Lines lines;
    lines.x = grid.axis(k).points();
    const std::size_t n = grid.dimensions();
    std::size_t stride = 1;
    for (std::size_t j = n; j-- > k + 1;) {
        stride *= grid.axis(j).size();
    }
    for (std::size_t start = 0; start < grid.nodes(); ++start) {
        if (start / stride % lines.x.size() != 0) {
            continue;
        }
        ++lines.count;
        for (std::size_t i = 0; i < lines.x.size(); ++i) {
            const double* node = &grid.hermite()[(start + i * stride) << n];
            lines.value.push_back(node[0]);
            lines.slope.push_back(node[std::size_t{1} << k]);
        }
    }
    return lines;
}

double hermite(double t, double h, double a, double b, double sa, double sb) {
    const double r = 1 - t;
    return a * r * r * (1 + 2 * t) + b * t * t * (3 - 2 * t) + h * t * r * (sa * r - sb * t);
}

enum class Between { cubic, straight };

/// Does one cubic, or one straight line, from point i to point j stay within `allowed` of the fine function on every
/// line?
bool joins(const Lines& lines, Between between, std::size_t i, std::size_t j, double allowed) {
    const double h = lines.x[j] - lines.x[i];
    const std::size_t m = lines.x.size();
    for (std::size_t line = 0; line < lines.count; ++line) {
        const double* value = &lines.value[line * m];
        const double* slope = &lines.slope[line * m];
        for (std::size_t cell = i; cell < j; ++cell) {
            const double width = lines.x[cell + 1] - lines.x[cell];
            for (const double part : {0.25, 0.5, 0.75, 1.0}) {
                const double x = lines.x[cell] + part * width;
                const double fine = hermite(part, width, value[cell], value[cell + 1], slope[cell], slope[cell + 1]);
                const double t = (x - lines.x[i]) / h;
                const double coarse = between == Between::straight
                                          ? (1 - t) * value[i] + t * value[j]
                                          : hermite(t, h, value[i], value[j], slope[i], slope[j]);
                if (std::abs(fine - coarse) > allowed) {
                    return false;
                }
            }
        }
    }
    return true;
}

std::vector<double> fewest_points(const Lines& lines, Between between, double allowed, core::Progress& progress) {
    const std::size_t m = lines.x.size();
    constexpr std::size_t unreached = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> steps(m, unreached);
    std::vector<std::size_t> from(m, 0);
    steps[0] = 0;
    for (std::size_t i = 0; i + 1 < m; ++i) {
        progress.check();
        std::size_t failures = 0;
        // Past a few misfits in a row a longer stretch hardly ever fits again.
        for (std::size_t j = i + 1; j < m && failures < 4; ++j) {
            if (j > i + 1 && !joins(lines, between, i, j, allowed)) {
                ++failures;
                continue;
            }
            failures = 0;
            if (steps[i] + 1 < steps[j]) {
                steps[j] = steps[i] + 1;
                from[j] = i;
            }
        }
    }
    std::vector<double> kept;
    for (std::size_t i = m - 1; i > 0; i = from[i]) {
        kept.push_back(lines.x[i]);
    }
    kept.push_back(lines.x[0]);
    std::reverse(kept.begin(), kept.end());
    return kept;
}

/// Fewest of the surface's lines an axis such that what `made` makes of them stays within `allowed`; all of them when
/// none fits.
template <class Make>
Resampled fewest_lines(const CubicGrid& surface, Between between, double allowed, Make&& made,
                       core::Progress& progress) {
    std::vector<Lines> lines;
    for (std::size_t k = 0; k < surface.dimensions(); ++k) {
        lines.push_back(lines_along(surface, k));
    }
    // The errors of the axes add at worst; how much of the allowance each may spend is found by trying.
    for (const double share : {0.98, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.01}) {
        std::vector<std::vector<double>> points;
        for (const auto& axis : lines) {
            points.push_back(fewest_points(axis, between, share * allowed, progress));
        }
        if (Resampled thin = made(std::move(points)); thin.difference <= allowed) {
            return thin;
        }
    }
    return made(surface.points());
}

/// Does a straight line over the cell err by more than `allowed` anywhere on the grid's lines along axis k?
bool bends(const CubicGrid& surface, std::size_t k, double low, double high, double allowed) {
    const std::size_t n = surface.dimensions();
    const std::size_t lines = surface.nodes() / surface.axis(k).size();
    for (std::size_t line = 0; line < lines; ++line) {
        double at[CubicGrid::max_axes];
        std::size_t rest = line;
        for (std::size_t j = n; j-- > 0;) {
            if (j != k) {
                at[j] = surface.axis(j).points()[rest % surface.axis(j).size()];
                rest /= surface.axis(j).size();
            }
        }
        const auto value = [&](double x) {
            at[k] = x;
            return surface.value(at, nullptr);
        };
        const double a = value(low), b = value(high);
        for (const double t : {0.25, 0.5, 0.75}) {  // a cubic may cross its chord in the middle
            if (std::abs(value(low + t * (high - low)) - (1 - t) * a - t * b) > allowed) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

Resampled thinned(const CubicGrid& full, const CubicGrid& surface, double allowed, core::Progress& progress) {
    const auto made = [&](std::vector<std::vector<double>> points) {
        return resampled(full, std::move(points), progress);
    };
    return fewest_lines(surface, Between::cubic, allowed, made, progress);
}

std::vector<std::vector<double>> points_for_straight_lines(const CubicGrid& surface, double allowed, std::size_t most,
                                                           core::Progress& progress) {
    auto points = surface.points();
    const std::size_t n = surface.dimensions();
    for (std::size_t k = 0; k < n; ++k) {
        for (bool refining = true; refining;) {
            progress.check();
            std::vector<double> refined;
            const auto& x = points[k];
            for (std::size_t i = 0; i + 1 < x.size(); ++i) {
                refined.push_back(x[i]);
                if (bends(surface, k, x[i], x[i + 1], allowed / static_cast<double>(n))) {
                    refined.push_back(0.5 * (x[i] + x[i + 1]));
                }
            }
            refined.push_back(x.back());
            refining = refined.size() > x.size() && refined.size() <= most;
            if (refining) {
                points[k] = std::move(refined);
            }
        }
    }
    return points;
}

Resampled thinned_for_straight_lines(const CubicGrid& full, const CubicGrid& surface, double allowed, std::size_t most,
                                     core::Progress& progress) {
    // Candidates twice as dense as they need be.
    const CubicGrid fine = surface.resampled(points_for_straight_lines(surface, allowed / 4, most, progress));
    const auto made = [&](std::vector<std::vector<double>> points) {
        return straight_resampled(full, std::move(points), progress);
    };
    return fewest_lines(fine, Between::straight, allowed, made, progress);
}

}  // namespace underbody::tables
