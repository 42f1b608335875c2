#include "surrogates/estimator/control/bounds.h"

#include <cmath>

#include "surrogates/estimator/model/linear_system.h"

namespace underbody::estimator {

namespace {
Matrix symmetric_part(const Matrix& a) { return 0.5 * (a + a.transposed()); }
}  // namespace

RobustnessBounds robustness_bounds(const Matrix& a, const Matrix& structure) {
    RobustnessBounds bounds;
    const std::size_t n = a.rows();
    bounds.stability_degree = -spectral_abscissa(a);
    bounds.hurwitz = bounds.stability_degree > 1e-12 * (1 + a.largest());
    if (!bounds.hurwitz) {
        return bounds;
    }
    bounds.p = lyapunov(a, 2.0 * Matrix::identity(n));
    bounds.patel_toda = 1 / singular_values(bounds.p).front();
    bounds.patel_toda_element = bounds.patel_toda / static_cast<double>(n);
    Matrix u = structure;
    if (u.empty()) {
        u = Matrix(n, n);
        for (std::size_t i = 0; i < n * n; ++i) {
            u.data()[i] = 1;
        }
    }
    Matrix absolute = bounds.p;
    for (std::size_t i = 0; i < n * n; ++i) {
        absolute.data()[i] = std::abs(absolute.data()[i]);
    }
    bounds.yedavalli = 1 / singular_values(symmetric_part(absolute * u)).front();
    return bounds;
}

double symmetric_part_abscissa(const Matrix& a) { return spectral_abscissa(symmetric_part(a)); }

double performance_ratio(const Matrix& j_zeta, const Matrix& j_x) {
    return singular_values(j_zeta).front() / singular_values(j_x).front();
}

SteadyState steady_state(const Matrix& j_x, const Matrix& j_zeta, const Vector& x_ss) {
    SteadyState result;
    const double abscissa = spectral_abscissa(j_zeta);
    result.converges = abscissa < 0;
    result.slowest_time = abscissa == 0 ? INFINITY : 1 / std::abs(abscissa);
    if (result.converges) {
        result.limit = solve(j_zeta, j_x * x_ss);
        for (double& v : result.limit) {
            v = -v;
        }
    }
    return result;
}

}  // namespace underbody::estimator
