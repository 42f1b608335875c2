// Equations of Lyapunov and Riccati.
#include <cmath>

#include "core/error.h"
#include "surrogates/dynamics/model/dense.h"
#include "surrogates/estimator/model/decompositions.h"
#include "surrogates/estimator/model/linear_system.h"

namespace underbody::estimator {

Matrix lyapunov(const Matrix& a, const Matrix& q) {
    if (spectral_abscissa(a) >= 0) {
        throw core::InputError("unstable",
                               "the Lyapunov equation needs a matrix whose eigenvalues all lie in the left half plane");
    }
    const auto dense = [](const Matrix& m) {
        dynamics::Dense d(m.rows(), m.columns());
        for (std::size_t i = 0; i < m.rows(); ++i) {
            for (std::size_t j = 0; j < m.columns(); ++j) {
                d(i, j) = m(i, j);
            }
        }
        return d;
    };
    const dynamics::Dense p = dynamics::lyapunov(dense(a), dense(q));
    Matrix out(p.rows(), p.columns());
    for (std::size_t i = 0; i < p.rows(); ++i) {
        for (std::size_t j = 0; j < p.columns(); ++j) {
            out(i, j) = p(i, j);
        }
    }
    return out;
}

Matrix discrete_lyapunov(const Matrix& phi, const Matrix& q) {
    if (spectral_radius(phi) >= 1) {
        throw core::InputError("unstable", "the discrete Lyapunov equation needs eigenvalues inside the unit circle");
    }
    Matrix p = q, a = phi;
    for (int i = 0; i < 64; ++i) {  // Smith's doubling
        const Matrix next = p + a * p * a.transposed();
        if ((next - p).largest() <= 1e-16 * next.largest()) {
            return next;
        }
        p = next;
        a = a * a;
    }
    return p;
}

Matrix discrete_riccati(const Matrix& phi, const Matrix& c, const Matrix& q, const Matrix& r,
                        const std::vector<std::string>& names) {
    // An unseen mode on or outside the unit circle has no bounded covariance.
    const Observability seen = observability(phi, c);
    for (const auto& pole : seen.unobservable_poles) {
        if (std::abs(pole) >= 1 - 1e-9) {
            refuse_unobservable(seen, names);
        }
    }
    // Structured doubling (Chu, Fan, Lin and Wang 2004) on the dual control problem.
    Matrix a = phi.transposed(), g = c.transposed() * internal::solve(r, c), h = q;
    const Matrix one = Matrix::identity(phi.rows());
    for (int i = 0; i < 100 && h.finite() && g.finite(); ++i) {
        const Matrix w = one + g * h, wa = internal::solve(w, a), wg = internal::solve(w, g);
        const Matrix next = h + a.transposed() * h * wa;
        g = g + a * wg * a.transposed();
        a = a * wa;
        const double change = internal::norm_f(next - h);
        h = 0.5 * (next + next.transposed());
        if (change <= 1e-15 * internal::norm_f(h)) {
            return h;
        }
    }
    throw core::InputError("unobservable",
                           "the filter's covariance does not settle: some mode is not seen or not excited", {},
                           "give process noise to every state, or measure more");
}

}  // namespace underbody::estimator
