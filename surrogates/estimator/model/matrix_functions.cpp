// Exponential and logarithm of a matrix.
#include <array>
#include <cmath>

#include "core/error.h"
#include "surrogates/estimator/model/decompositions.h"
#include "surrogates/estimator/model/linear_system.h"

namespace underbody::estimator {

// Scaling and squaring with the diagonal Pade approximant of order 13 (Higham 2005).
Matrix exponential(const Matrix& a) {
    if (a.rows() != a.columns() || !a.finite()) {
        throw core::InputError("shape", "the exponential needs a square matrix of finite values");
    }
    constexpr std::array<double, 14> b{64764752532480000,
                                       32382376266240000,
                                       7771770303897600,
                                       1187353796428800,
                                       129060195264000,
                                       10559470521600,
                                       670442572800,
                                       33522128640,
                                       1323241920,
                                       40840800,
                                       960960,
                                       16380,
                                       182,
                                       1};
    const double size = internal::norm_1(a);
    const int squarings =
        size > 5.371920351148152 ? static_cast<int>(std::ceil(std::log2(size / 5.371920351148152))) : 0;
    const Matrix one = Matrix::identity(a.rows()), x = std::ldexp(1.0, -squarings) * a;
    const Matrix x2 = x * x, x4 = x2 * x2, x6 = x4 * x2;
    const Matrix odd =
        x * (x6 * (b[13] * x6 + b[11] * x4 + b[9] * x2) + b[7] * x6 + b[5] * x4 + b[3] * x2 + b[1] * one);
    const Matrix even = x6 * (b[12] * x6 + b[10] * x4 + b[8] * x2) + b[6] * x6 + b[4] * x4 + b[2] * x2 + b[0] * one;
    Matrix e = internal::solve(even - odd, even + odd);
    for (int i = 0; i < squarings; ++i) {
        e = e * e;
    }
    return e;
}

namespace {

// Principal square root: the product form of the iteration of Denman and Beavers (Cheng, Higham, Kenney and Laub 2001).
Matrix square_root(const Matrix& a) {
    const Matrix one = Matrix::identity(a.rows());
    Matrix m = a, x = a;
    for (int i = 0; i < 60; ++i) {
        const Matrix inverted = inverse(m);
        x = 0.5 * (x * (one + inverted));
        m = 0.5 * one + 0.25 * (m + inverted);
        if ((m - one).largest() <= 1e-15 * static_cast<double>(a.rows())) {
            break;
        }
    }
    return x;
}

}  // namespace

// Inverse scaling and squaring; near one, log(1 + X) = integral of X/(1 + tX) over t in [0, 1] by seven Gauss points,
// which is the diagonal Pade approximant of order 7 (Higham 2008, chapter 11).
Matrix logarithm(const Matrix& a) {
    for (const auto& pole : eigenvalues(a)) {
        if (pole.real() <= 0 && std::abs(pole.imag()) < 1e-12 * (1 + std::abs(pole.real()))) {
            throw core::InputError("singular",
                                   "a discrete model with an eigenvalue at or below zero has no continuous-time form",
                                   {}, "take a shorter time step or fewer modes");
        }
    }
    constexpr std::array<double, 4> node{0, 0.405845151377397166906606412077, 0.741531185599394439863864773281,
                                         0.949107912342758524526189684048};
    constexpr std::array<double, 4> weight{0.417959183673469387755102040816, 0.381830050505118944950369775489,
                                           0.279705391489276667901467771424, 0.129484966168869693270611432679};
    const Matrix one = Matrix::identity(a.rows());
    Matrix root = a;
    int roots = 0;
    for (; internal::norm_1(root - one) > 0.25 && roots < 60; ++roots) {
        root = square_root(root);
    }
    const Matrix x = root - one;
    Matrix sum(a.rows(), a.rows());
    for (std::size_t k = 0; k < node.size(); ++k) {
        for (const double side : {-1.0, 1.0}) {
            if (k > 0 || side > 0) {
                const double t = 0.5 * (1 + side * node[k]);
                sum = sum + (0.5 * weight[k]) * internal::solve(one + t * x, x);
            }
        }
    }
    return std::ldexp(1.0, roots) * sum;
}

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

}  // namespace underbody::estimator
