// Evaluation of piecewise cubic grids: where a point lies, and the polynomials there.

#include "surrogates/tables/fit/grid.h"

namespace underbody::tables {

namespace {

using Pair = double __attribute__((vector_size(16)));

inline Pair pair_at(const double* from) {
    Pair pair;
    __builtin_memcpy(&pair, from, sizeof pair);
    return pair;
}

/// c0 + v c1 + v^2 c2 + v^3 c3 of two columns of a cell's coefficients, and its derivative by v.
inline Pair cubic_pair(const double* c, double v, Pair& derivative) {
    const Pair c1 = pair_at(c + 4), c2 = pair_at(c + 8), c3 = pair_at(c + 12);
    derivative = c1 + v * (2 * c2 + 3 * v * c3);
    return pair_at(c) + v * (c1 + v * (c2 + v * c3));
}

/// Hermite functions on a cell of width h at distance `offset` from its start: [differentiated][corner][derivative].
void hermite_weights(double h, double offset, double (&w)[2][2][2]) {
    const double t = offset / h;
    const double r = 1 - t;
    w[0][0][0] = r * r * (1 + 2 * t);
    w[0][1][0] = t * t * (3 - 2 * t);
    w[0][0][1] = h * t * r * r;
    w[0][1][1] = -h * t * t * r;
    w[1][0][0] = -6 * t * r / h;
    w[1][1][0] = 6 * t * r / h;
    w[1][0][1] = r * (1 - 3 * t);
    w[1][1][1] = t * (3 * t - 2);
}

}  // namespace

double CubicGrid::value_1(double x, double* slope) const noexcept {
    const Spot s = spot(0, x);
    const double* c = &cells_[4 * s.cell];
    const double u = s.offset;
    if (slope != nullptr) {
        slope[0] = s.held ? 0 : c[1] + u * (2 * c[2] + 3 * u * c[3]);
    }
    return c[0] + u * (c[1] + u * (c[2] + u * c[3]));
}

double CubicGrid::value_2(const double* point, double* slope) const noexcept {
    const Spot a = spot(0, point[0]);
    const Spot b = spot(1, point[1]);
    const double* c = bicubics_[a.cell * bicubic_columns_ + b.cell].c;
    const double u = a.offset;
    // Along the second axis for each power of the first, two powers side by side: p the values, d the slopes.
    Pair d01, d23;
    const Pair p01 = cubic_pair(c, b.offset, d01);
    const Pair p23 = cubic_pair(c + 2, b.offset, d23);
    // Then along the first, value and slope along the second side by side.
    const Pair r0 = {p01[0], d01[0]}, r1 = {p01[1], d01[1]}, r2 = {p23[0], d23[0]}, r3 = {p23[1], d23[1]};
    const Pair result = r0 + u * (r1 + u * (r2 + u * r3));
    if (slope != nullptr) {
        slope[0] = a.held ? 0 : p01[1] + u * (2 * p23[0] + 3 * u * p23[1]);
        slope[1] = b.held ? 0 : result[1];
    }
    return result[0];
}

void CubicGrid::set_weights(const double* point, CellWeights& w) const noexcept {
    w.node = 0;
    for (std::size_t k = 0; k < dimensions_; ++k) {
        const Spot s = spot(k, point[k]);
        const auto& x = axes_[k].points();
        hermite_weights(x[s.cell + 1] - x[s.cell], s.offset, w.of[k]);
        w.node += s.cell * stride_[k];
        w.held[k] = s.held;
    }
}

/// Sum over the corners of a cell and their Hermite data of the products of Hermite functions, once differentiated
/// along every axis whose bit is set. On the lines of the grid most of them are nought: these are left out, which
/// changes no bit of the sum.
double CubicGrid::sum(const CellWeights& w, std::size_t differentiated) const noexcept {
    const std::size_t width = std::size_t{1} << dimensions_;
    double result = 0;
    for (std::size_t corner = 0; corner < width; ++corner) {
        std::size_t node = w.node, no_value = 0, no_slope = 0;  // axes whose function of that kind is nought here
        for (std::size_t k = 0; k < dimensions_; ++k) {
            const auto& here = w.of[k][differentiated >> k & 1][corner >> k & 1];
            node += (corner >> k & 1) * stride_[k];
            no_value |= static_cast<std::size_t>(here[0] == 0) << k;
            no_slope |= static_cast<std::size_t>(here[1] == 0) << k;
        }
        if ((no_value & no_slope) != 0) {
            continue;
        }
        const double* data = &nodes_[node * width];
        for (std::size_t mask = 0; mask < width; ++mask) {
            if (((mask & no_slope) | (~mask & no_value)) != 0) {
                continue;
            }
            double product = data[mask];
            for (std::size_t k = 0; k < dimensions_; ++k) {
                product *= w.of[k][differentiated >> k & 1][corner >> k & 1][mask >> k & 1];
            }
            result += product;
        }
    }
    return result;
}

double CubicGrid::continued(const double* point, double* slope, unsigned going_on) const noexcept {
    CellWeights w;
    set_weights(point, w);
    for (std::size_t k = 0; k < dimensions_; ++k) {
        if (!w.held[k] || (going_on >> k & 1) == 0) {
            continue;
        }
        const double beyond = point[k] - (point[k] < axes_[k].lower() ? axes_[k].lower() : axes_[k].upper());
        for (std::size_t corner = 0; corner < 2; ++corner) {
            for (std::size_t m = 0; m < 2; ++m) {
                w.of[k][0][corner][m] += beyond * w.of[k][1][corner][m];
            }
        }
        w.held[k] = false;
    }
    for (std::size_t k = 0; k < dimensions_ && slope != nullptr; ++k) {
        slope[k] = w.held[k] ? 0 : sum(w, std::size_t{1} << k);
    }
    return sum(w, 0);
}

void CubicGrid::derivatives(const double* point, double* result) const noexcept {
    CellWeights w;
    set_weights(point, w);
    for (std::size_t wanted = 0; wanted < std::size_t{1} << dimensions_; ++wanted) {
        result[wanted] = sum(w, wanted);
    }
}

double CubicGrid::value(const double* point, double* slope) const noexcept {
    const std::size_t n = dimensions();
    return n == 2 ? value_2(point, slope) : n == 1 ? value_1(point[0], slope) : continued(point, slope, 0);
}

}  // namespace underbody::tables
