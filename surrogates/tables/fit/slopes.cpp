// Slopes of one line of points: monotone, or of the not-a-knot spline.
#include <algorithm>
#include <cmath>
#include <vector>

#include "surrogates/tables/fit/grid.h"

namespace underbody::tables {

namespace {

/// Derivative at x[at] of the polynomial through the points first .. first+count-1 (Lagrange).
double polynomial_slope(std::span<const double> x, std::span<const double> y, std::size_t first, std::size_t count,
                        std::size_t at) {
    double slope = 0;
    for (std::size_t j = first; j < first + count; ++j) {
        double weight = 0;
        if (j == at) {
            for (std::size_t k = first; k < first + count; ++k) {
                if (k != at) {
                    weight += 1 / (x[at] - x[k]);
                }
            }
        } else {
            weight = 1 / (x[j] - x[at]);
            for (std::size_t k = first; k < first + count; ++k) {
                if (k != j && k != at) {
                    weight *= (x[at] - x[k]) / (x[j] - x[k]);
                }
            }
        }
        slope += weight * (y[j] - y[at]);
    }
    return slope;
}

/// Weighted harmonic mean of the secants (Fritsch and Butland 1984): always monotone.
double harmonic_slope(double h0, double h1, double d0, double d1) {
    const double w0 = 2 * h1 + h0;
    const double w1 = h1 + 2 * h0;
    return (w0 + w1) / (w0 / d0 + w1 / d1);
}

void monotone_slopes(std::span<const double> x, std::span<const double> y, std::span<double> slope) {
    const std::size_t n = x.size();
    const auto secant = [&](std::size_t i) { return (y[i + 1] - y[i]) / (x[i + 1] - x[i]); };
    if (n == 2) {
        slope[0] = slope[1] = secant(0);
        return;
    }
    const std::size_t count = std::min<std::size_t>(5, n);
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t first = std::min(i >= 2 ? i - 2 : 0, n - count);
        const double wanted = polynomial_slope(x, y, first, count, i);
        if (i == 0 || i == n - 1) {
            // At an end only the cell beside it limits the slope.
            const double d = i == 0 ? secant(0) : secant(n - 2);
            double three_point = wanted;
            if (!(wanted * d >= 0 && std::abs(wanted) <= 3 * std::abs(d))) {
                three_point = polynomial_slope(x, y, i == 0 ? 0 : n - 3, 3, i);
            }
            slope[i] = three_point * d <= 0 ? 0 : std::copysign(std::min(std::abs(three_point), 3 * std::abs(d)), d);
            continue;
        }
        const double d0 = secant(i - 1);
        const double d1 = secant(i);
        if (d0 * d1 <= 0) {
            slope[i] = 0;
            continue;
        }
        const double limit = 3 * std::min(std::abs(d0), std::abs(d1));
        const bool fits = wanted * d0 > 0 && std::abs(wanted) <= limit;
        slope[i] = fits ? wanted : harmonic_slope(x[i] - x[i - 1], x[i + 1] - x[i], d0, d1);
    }
}

/// Tridiagonal system of the spline's slopes; the not-a-knot ends reach one place further.
void spline_slopes(std::span<const double> x, std::span<const double> y, std::span<double> slope) {
    const std::size_t n = x.size();
    if (n <= 3) {
        // Two points: the line. Three: the parabola.
        for (std::size_t i = 0; i < n; ++i) {
            slope[i] = polynomial_slope(x, y, 0, n, i);
        }
        return;
    }
    std::vector<double> h(n - 1), d(n - 1), lower(n), diagonal(n), upper(n);
    for (std::size_t i = 0; i + 1 < n; ++i) {
        h[i] = x[i + 1] - x[i];
        d[i] = (y[i + 1] - y[i]) / h[i];
    }
    for (std::size_t i = 1; i + 1 < n; ++i) {
        lower[i] = h[i];
        diagonal[i] = 2 * (h[i - 1] + h[i]);
        upper[i] = h[i - 1];
        slope[i] = 3 * (h[i] * d[i - 1] + h[i - 1] * d[i]);
    }
    // De Boor, A Practical Guide to Splines, ch. IV: the third derivative is continuous across the second and the last
    // but one point.
    diagonal[0] = h[1];
    upper[0] = h[0] + h[1];
    slope[0] = ((h[0] + 2 * upper[0]) * h[1] * d[0] + h[0] * h[0] * d[1]) / upper[0];
    diagonal[n - 1] = h[n - 3];
    lower[n - 1] = h[n - 2] + h[n - 3];
    slope[n - 1] =
        (h[n - 2] * h[n - 2] * d[n - 3] + (2 * lower[n - 1] + h[n - 2]) * h[n - 3] * d[n - 2]) / lower[n - 1];
    for (std::size_t i = 1; i < n; ++i) {
        const double factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        slope[i] -= factor * slope[i - 1];
    }
    slope[n - 1] /= diagonal[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) {
        slope[i] = (slope[i] - upper[i] * slope[i + 1]) / diagonal[i];
    }
}

}  // namespace

void line_slopes(SlopeRule rule, std::span<const double> x, std::span<const double> value, std::span<double> slope) {
    if (rule == SlopeRule::monotone) {
        monotone_slopes(x, value, slope);
    } else {
        spline_slopes(x, value, slope);
    }
}

}  // namespace underbody::tables
