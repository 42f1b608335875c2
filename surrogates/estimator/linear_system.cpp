#include "surrogates/estimator/linear_system.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/error.h"
#include "surrogates/estimator/internal/eigen.h"

namespace underbody::estimator {

using internal::plain;
using internal::plain_vector;
using internal::view;
using MatrixC = Eigen::MatrixXcd;

namespace {

void check_square(const Matrix& a) {
    if (a.rows() != a.columns()) {
        throw core::InputError("shape", "a square matrix is wanted");
    }
    if (!a.finite()) {
        throw core::InputError("range", "a matrix holds a value that is not finite");
    }
}

void sort_poles(Poles& poles) {
    std::sort(poles.begin(), poles.end(), [](const auto& p, const auto& q) {
        return p.real() != q.real() ? p.real() > q.real() : p.imag() > q.imag();
    });
}

}  // namespace

Poles eigenvalues(const Matrix& a) {
    check_square(a);
    if (a.rows() == 0) {
        return {};
    }
    const Eigen::MatrixXd m = view(a);
    Eigen::EigenSolver<Eigen::MatrixXd> solver(m, false);
    Poles poles;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
        poles.emplace_back(solver.eigenvalues()[i]);
    }
    sort_poles(poles);
    return poles;
}

double spectral_abscissa(const Matrix& a) { return eigenvalues(a).front().real(); }

double spectral_radius(const Matrix& a) {
    double radius = 0;
    for (const auto& pole : eigenvalues(a)) {
        radius = std::max(radius, std::abs(pole));
    }
    return radius;
}

Vector singular_values(const Matrix& a) {
    const Eigen::MatrixXd m = view(a);
    return plain_vector(Eigen::JacobiSVD<Eigen::MatrixXd>(m).singularValues());
}

Matrix pseudo_inverse(const Matrix& a, double tolerance) {
    const Eigen::MatrixXd m = view(a);
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(m, Eigen::ComputeThinU | Eigen::ComputeThinV);
    Eigen::VectorXd s = svd.singularValues();
    for (Eigen::Index i = 0; i < s.size(); ++i) {
        s[i] = s[i] > tolerance ? 1 / s[i] : 0;
    }
    return plain(svd.matrixV() * s.asDiagonal() * svd.matrixU().transpose());
}

Vector solve(const Matrix& a, const Vector& b) {
    const Eigen::MatrixXd m = view(a);
    return plain_vector(m.fullPivLu().solve(Eigen::VectorXd(view(b))));
}

Matrix inverse(const Matrix& a) {
    const Eigen::MatrixXd m = view(a);
    return plain(m.fullPivLu().inverse());
}

Matrix exponential(const Matrix& a) {
    check_square(a);
    const Eigen::MatrixXd m = view(a);
    return plain(m.exp());
}

Matrix logarithm(const Matrix& a) {
    for (const auto& pole : eigenvalues(a)) {
        if (pole.real() <= 0 && std::abs(pole.imag()) < 1e-12 * (1 + std::abs(pole.real()))) {
            throw core::InputError("singular", "a discrete model with an eigenvalue at or below zero has no continuous-time form", {},
                                   "take a shorter time step or fewer modes");
        }
    }
    const Eigen::MatrixXd m = view(a);
    return plain(m.log());
}

std::string direction_text(const Vector& direction, const std::vector<std::string>& names) {
    std::string text;
    double largest = 0;
    for (const double v : direction) {
        largest = std::max(largest, std::abs(v));
    }
    for (std::size_t i = 0; i < direction.size(); ++i) {
        if (std::abs(direction[i]) < 1e-3 * largest) {
            continue;
        }
        char number[40];
        std::snprintf(number, sizeof number, "%.3g ", std::abs(direction[i]));
        text += text.empty() ? (direction[i] < 0 ? "-" : "") : (direction[i] < 0 ? " - " : " + ");
        text += number;
        text += i < names.size() ? names[i] : "state " + std::to_string(i + 1);
    }
    return text;
}

Observability observability(const Matrix& a, const Matrix& c, const Vector& scale, double tolerance) {
    check_square(a);
    const auto n = static_cast<Eigen::Index>(a.rows());
    Eigen::VectorXd s = Eigen::VectorXd::Ones(n);
    if (!scale.empty()) {
        s = view(scale);
    }
    // In coordinates x = s x', so that sizes of the states do not decide the rank.
    const Eigen::MatrixXd as = s.cwiseInverse().asDiagonal() * Eigen::MatrixXd(view(a)) * s.asDiagonal();
    Eigen::MatrixXd cs = Eigen::MatrixXd(view(c)) * s.asDiagonal();
    for (Eigen::Index i = 0; i < cs.rows(); ++i) {
        const double norm = cs.row(i).norm();
        if (norm > 0) {
            cs.row(i) /= norm;
        }
    }
    const double rate = std::max(as.norm(), 1e-300);
    Eigen::MatrixXd o(cs.rows() * n, n);
    o.topRows(cs.rows()) = cs;
    for (Eigen::Index k = 1; k < n; ++k) {
        o.middleRows(k * cs.rows(), cs.rows()) = o.middleRows((k - 1) * cs.rows(), cs.rows()) * as / rate;
    }
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(o, Eigen::ComputeFullV);
    Observability result;
    result.singular_values = plain_vector(svd.singularValues());
    const double cut = tolerance * std::max(svd.singularValues()[0], 1e-300);
    for (const double v : result.singular_values) {
        result.rank += v > cut ? 1U : 0U;
    }
    const auto hidden = n - static_cast<Eigen::Index>(result.rank);
    if (hidden == 0) {
        return result;
    }
    const Eigen::MatrixXd basis = s.asDiagonal() * svd.matrixV().rightCols(hidden);
    Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(basis).householderQ() * Eigen::MatrixXd::Identity(n, hidden);
    for (Eigen::Index j = 0; j < hidden; ++j) {
        Eigen::Index at = 0;
        q.col(j).cwiseAbs().maxCoeff(&at);
        q.col(j) *= q(at, j) < 0 ? -1 : 1;
    }
    result.unobservable = plain(q);
    result.unobservable_poles = eigenvalues(plain(q.transpose() * Eigen::MatrixXd(view(a)) * q));
    for (const auto& pole : result.unobservable_poles) {
        result.detectable = result.detectable && pole.real() < -1e-9;
    }
    return result;
}

namespace {

[[noreturn]] void refuse_unobservable(const Observability& seen, const std::vector<std::string>& names) {
    throw core::InputError("unobservable",
                           "the measurements cannot see the direction " + direction_text(seen.unobservable.column_of(0), names) +
                               ": no gain can move its pole",
                           {}, "estimate the sum that can be seen (total_force), measure more, or trust a drag law and say so");
}

/// Coefficients of the monic polynomial with these zeros, highest power first.
std::vector<double> polynomial(const Poles& zeros) {
    std::vector<std::complex<double>> p{1.0};
    for (const auto& z : zeros) {
        p.emplace_back(0.0);
        for (std::size_t i = p.size() - 1; i > 0; --i) {
            p[i] -= z * p[i - 1];
        }
    }
    std::vector<double> real;
    for (const auto& v : p) {
        if (std::abs(v.imag()) > 1e-9 * (1 + std::abs(v.real()))) {
            throw core::InputError("poles", "complex poles must come in conjugate pairs");
        }
        real.push_back(v.real());
    }
    return real;
}

}  // namespace

Matrix place_single_output(const Matrix& a, const Matrix& c, const Poles& poles, const std::vector<std::string>& names) {
    check_square(a);
    const auto n = static_cast<Eigen::Index>(a.rows());
    if (poles.size() != a.rows()) {
        throw core::InputError("poles", "as many poles as states are wanted: " + std::to_string(a.rows()));
    }
    const Observability seen = observability(a, c);
    if (seen.rank < a.rows()) {
        refuse_unobservable(seen, names);
    }
    const Eigen::MatrixXd m = view(a);
    Eigen::MatrixXd o(n, n);
    o.row(0) = Eigen::MatrixXd(view(c)).row(0);
    for (Eigen::Index k = 1; k < n; ++k) {
        o.row(k) = o.row(k - 1) * m;
    }
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(n, n);
    for (const double coefficient : polynomial(poles)) {
        p = p * m + coefficient * Eigen::MatrixXd::Identity(n, n);
    }
    Eigen::VectorXd last = Eigen::VectorXd::Zero(n);
    last[n - 1] = 1;
    return plain(p * o.fullPivLu().solve(last));
}

Matrix place(const Matrix& a, const Matrix& c, const Vector& poles, const std::vector<std::string>& names) {
    check_square(a);
    const auto n = static_cast<Eigen::Index>(a.rows());
    if (static_cast<Eigen::Index>(poles.size()) != n) {
        throw core::InputError("poles", "as many poles as states are wanted: " + std::to_string(n));
    }
    const Observability seen = observability(a, c);
    if (seen.rank < a.rows()) {
        refuse_unobservable(seen, names);
    }
    if (c.rows() == 1) {
        return place_single_output(a, c, Poles(poles.begin(), poles.end()), names);
    }
    // The dual problem: eigenvectors of A' - C' L' lie in S_j = ker(U1' (A' - p_j)), C' = U0 Z; keep each as orthogonal to the others
    // as possible (KNV 1985, method 0).
    const Eigen::MatrixXd at = Eigen::MatrixXd(view(a)).transpose();
    const Eigen::MatrixXd b = Eigen::MatrixXd(view(c)).transpose();
    Eigen::HouseholderQR<Eigen::MatrixXd> qr(b);
    const Eigen::MatrixXd q = qr.householderQ();
    const Eigen::Index p = b.cols();
    const Eigen::MatrixXd u0 = q.leftCols(p);
    const Eigen::MatrixXd u1 = q.rightCols(n - p);
    const Eigen::MatrixXd z = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
    std::vector<Eigen::MatrixXd> spaces;
    Eigen::MatrixXd x(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::MatrixXd t = u1.transpose() * (at - poles[static_cast<std::size_t>(j)] * Eigen::MatrixXd::Identity(n, n));
        Eigen::JacobiSVD<Eigen::MatrixXd> svd(t, Eigen::ComputeFullV);
        spaces.emplace_back(svd.matrixV().rightCols(p));
        x.col(j) = spaces.back().col(j % p);
    }
    for (int sweep = 0; sweep < 60; ++sweep) {
        for (Eigen::Index j = 0; j < n; ++j) {
            Eigen::MatrixXd others(n, n - 1);
            for (Eigen::Index k = 0, at_column = 0; k < n; ++k) {
                if (k != j) {
                    others.col(at_column++) = x.col(k);
                }
            }
            const Eigen::MatrixXd full = Eigen::HouseholderQR<Eigen::MatrixXd>(others).householderQ();
            const auto& space = spaces[static_cast<std::size_t>(j)];
            const Eigen::VectorXd v = space * (space.transpose() * full.col(n - 1));
            if (v.norm() > 1e-12) {
                x.col(j) = v.normalized();
            }
        }
    }
    const Eigen::MatrixXd target = x * view(poles).asDiagonal() * x.fullPivLu().inverse();
    const Eigen::MatrixXd gain = z.fullPivLu().solve(u0.transpose() * (at - target));
    if (!gain.allFinite() || (at - b * gain - target).norm() > 1e-6 * (1 + target.norm())) {
        throw core::InputError("poles", "these poles cannot be placed: a pole repeats more often than there are measurements");
    }
    return plain(gain.transpose());
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

Matrix lyapunov(const Matrix& a, const Matrix& q) {
    check_square(a);
    if (spectral_abscissa(a) >= 0) {
        throw core::InputError("unstable", "the Lyapunov equation needs a matrix whose eigenvalues all lie in the left half plane");
    }
    // Complex Schur A = U T U*: T* Y + Y T = -U* Q U, solved column by column.
    const auto n = static_cast<Eigen::Index>(a.rows());
    const MatrixC m = Eigen::MatrixXd(view(a)).cast<std::complex<double>>();
    Eigen::ComplexSchur<MatrixC> schur(m);
    const MatrixC& t = schur.matrixT();
    const MatrixC& u = schur.matrixU();
    const MatrixC f = -(u.adjoint() * Eigen::MatrixXd(view(q)).cast<std::complex<double>>() * u);
    MatrixC y = MatrixC::Zero(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < n; ++i) {
            std::complex<double> sum = f(i, j);
            for (Eigen::Index k = 0; k < i; ++k) {
                sum -= std::conj(t(k, i)) * y(k, j);
            }
            for (Eigen::Index k = 0; k < j; ++k) {
                sum -= y(i, k) * t(k, j);
            }
            y(i, j) = sum / (std::conj(t(i, i)) + t(j, j));
        }
    }
    const Eigen::MatrixXd p = (u * y * u.adjoint()).real();
    return plain(0.5 * (p + p.transpose()));
}

Matrix discrete_lyapunov(const Matrix& phi, const Matrix& q) {
    check_square(phi);
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

Matrix discrete_riccati(const Matrix& phi, const Matrix& c, const Matrix& q, const Matrix& r, const std::vector<std::string>& names) {
    check_square(phi);
    const auto n = static_cast<Eigen::Index>(phi.rows());
    // An unseen mode on or outside the unit circle has no bounded covariance.
    const Observability seen = observability(phi, c);
    for (std::size_t i = 0; i < seen.unobservable_poles.size(); ++i) {
        if (std::abs(seen.unobservable_poles[i]) >= 1 - 1e-9) {
            refuse_unobservable(seen, names);
        }
    }
    // Structured doubling (Chu, Fan, Lin and Wang 2004) on the dual control problem.
    Eigen::MatrixXd a = Eigen::MatrixXd(view(phi)).transpose();
    const Eigen::MatrixXd ct = Eigen::MatrixXd(view(c)).transpose();
    Eigen::MatrixXd g = ct * Eigen::MatrixXd(view(r)).ldlt().solve(ct.transpose());
    Eigen::MatrixXd h = view(q);
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
    for (int i = 0; i < 100; ++i) {
        const Eigen::PartialPivLU<Eigen::MatrixXd> w(one + g * h);
        const Eigen::MatrixXd wa = w.solve(a);
        const Eigen::MatrixXd wg = w.solve(g);
        const Eigen::MatrixXd next = h + a.transpose() * h * wa;
        g += a * wg * a.transpose();
        a = a * wa;
        const double change = (next - h).norm();
        h = 0.5 * (next + next.transpose());
        if (!h.allFinite()) {
            break;
        }
        if (change <= 1e-15 * h.norm()) {
            return plain(h);
        }
    }
    throw core::InputError("unobservable", "the filter's covariance does not settle: some mode is not seen or not excited", {},
                           "give process noise to every state, or measure more");
}

Matrix continuous_riccati(const Matrix& a, const Matrix& b, const Matrix& q, const Matrix& r) {
    check_square(a);
    const auto n = static_cast<Eigen::Index>(a.rows());
    const Eigen::MatrixXd am = view(a), bm = view(b), qm = view(q);
    const Eigen::MatrixXd g = bm * Eigen::MatrixXd(view(r)).ldlt().solve(bm.transpose());
    Eigen::MatrixXd hamiltonian(2 * n, 2 * n);
    hamiltonian << am, -g, -qm, -am.transpose();
    Eigen::EigenSolver<Eigen::MatrixXd> solver(hamiltonian);
    MatrixC stable(2 * n, n);
    Eigen::Index found = 0;
    for (Eigen::Index i = 0; i < 2 * n && found < n; ++i) {
        if (solver.eigenvalues()[i].real() < -1e-12) {
            stable.col(found++) = solver.eigenvectors().col(i);
        }
    }
    if (found < n) {
        throw core::InputError("unstable", "the Riccati equation has no stabilising solution: a mode cannot be moved or is not weighted");
    }
    const MatrixC ratio = stable.bottomRows(n) * stable.topRows(n).fullPivLu().inverse();
    Eigen::MatrixXd x = ratio.real();
    for (int i = 0; i < 4; ++i) {  // Newton-Kleinman cleans what near-defective eigenvectors left
        const Eigen::MatrixXd closed = am - g * x;
        x = view(lyapunov(plain(closed), plain(qm + x * g * x)));
    }
    return plain(0.5 * (x + x.transpose()));
}

}  // namespace underbody::estimator
