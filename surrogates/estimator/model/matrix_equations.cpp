// Systems in steps of time: exact discretisation, the discrete equations of Lyapunov and Riccati.
#include <cmath>

#include "core/error.h"
#include "surrogates/estimator/model/linear_system.h"

namespace underbody::estimator {

Discrete discretise(const Matrix& a, const Matrix& b, double step) {
    const std::size_t n = a.rows(), m = b.columns();
    Matrix big(n + m, n + m);
    big.set_block(0, 0, step * a);
    big.set_block(0, n, step * b);
    const Matrix e = exponential(big);
    return {e.block(0, 0, n, n), e.block(0, n, n, m)};
}

DiscreteFirstOrderHold discretise_first_order_hold(const Matrix& a, const Matrix& b, double step) {
    const std::size_t n = a.rows(), m = b.columns();
    Matrix big(n + 2 * m, n + 2 * m);
    big.set_block(0, 0, step * a);
    big.set_block(0, n, step * b);
    big.set_block(n, n + m, Matrix::identity(m));
    const Matrix e = exponential(big);
    const Matrix gamma1 = e.block(0, n + m, n, m);
    return {e.block(0, 0, n, n), e.block(0, n, n, m) - gamma1, gamma1};
}

Matrix discrete_noise(const Matrix& a, const Matrix& q, double step) {
    const std::size_t n = a.rows();
    Matrix big(2 * n, 2 * n);
    big.set_block(0, 0, -step * a);
    big.set_block(0, n, step * q);
    big.set_block(n, n, step * a.transposed());
    const Matrix e = exponential(big);
    const Matrix phi = e.block(n, n, n, n).transposed();
    const Matrix noise = phi * e.block(0, n, n, n);
    return 0.5 * (noise + noise.transposed());
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
    Matrix a = phi.transposed(), g = c.transposed() * dynamics::solve(r, c), h = q;
    const Matrix one = Matrix::identity(phi.rows());
    for (int i = 0; i < 100 && h.finite() && g.finite(); ++i) {
        const Matrix w = one + g * h, wa = dynamics::solve(w, a), wg = dynamics::solve(w, g);
        const Matrix next = h + a.transposed() * h * wa;
        g = g + a * wg * a.transposed();
        a = a * wa;
        const double change = dynamics::frobenius_norm(next - h);
        h = 0.5 * (next + next.transposed());
        if (change <= 1e-15 * dynamics::frobenius_norm(h)) {
            return h;
        }
    }
    throw core::InputError("unobservable",
                           "the filter's covariance does not settle: some mode is not seen or not excited", {},
                           "give process noise to every state, or measure more");
}

}  // namespace underbody::estimator
