#include "surrogates/estimator/model/linear_system.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/no_limit.h"

namespace underbody::estimator {

namespace {

void check_square(const Matrix& a) {
    if (a.rows() != a.columns()) {
        throw core::InputError("shape", "a square matrix is wanted");
    }
    if (!a.finite()) {
        throw core::InputError("range", "a matrix holds a value that is not finite");
    }
}

double norm(const Vector& v) {
    double sum = 0;
    for (const double x : v) {
        sum += x * x;
    }
    return std::sqrt(sum);
}

}  // namespace

double spectral_abscissa(const Matrix& a) { return eigenvalues(a).front().real(); }

double spectral_radius(const Matrix& a) {
    double radius = 0;
    for (const auto& pole : eigenvalues(a)) {
        radius = std::max(radius, std::abs(pole));
    }
    return radius;
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

namespace {

/// An orthonormal basis of what is not seen, in the coordinates of the states; the largest entry of each direction is
/// positive.
Matrix unobservable_directions(const Matrix& v, std::size_t rank, const Vector& s) {
    const std::size_t n = s.size();
    Matrix basis = v.block(0, rank, n, n - rank);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < basis.columns(); ++j) {
            basis(i, j) *= s[i];
        }
    }
    Matrix q = dynamics::singular_value_decomposition(basis).u.block(0, 0, n, basis.columns());
    for (std::size_t j = 0; j < q.columns(); ++j) {  // the largest entry is positive
        const Vector column = q.column_of(j);
        const auto at = std::max_element(column.begin(), column.end(),
                                         [](double x, double y) { return std::abs(x) < std::abs(y); });
        for (std::size_t i = 0; i < n && *at < 0; ++i) {
            q(i, j) = -q(i, j);
        }
    }
    return q;
}

/// In coordinates x = s x', so that sizes of the states do not decide the rank.
struct Scaled {
    Matrix a, c;
};

Scaled scaled(const Matrix& a, const Matrix& c, const Vector& s) {
    const std::size_t n = a.rows(), p = c.rows();
    // In coordinates x = s x', so that sizes of the states do not decide the rank.
    Matrix as = a, cs = c;
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t i = 0; i < n; ++i) {
            as(i, j) *= s[j] / s[i];
        }
        for (std::size_t i = 0; i < p; ++i) {
            cs(i, j) *= s[j];
        }
    }
    for (std::size_t i = 0; i < p; ++i) {
        const double size = norm(cs.row(i));
        for (std::size_t j = 0; j < n && size > 0; ++j) {
            cs(i, j) /= size;
        }
    }
    as = (1 / std::max(dynamics::frobenius_norm(as), 1e-6)) * as;  // rates below 1e-6 1/s (eleven days) count as none
    return {as, cs};
}

}  // namespace

Observability observability(const Matrix& a, const Matrix& c, const Vector& scale, double tolerance) {
    check_square(a);
    const std::size_t n = a.rows(), p = c.rows();
    const Vector s = scale.empty() ? Vector(n, 1.0) : scale;
    const auto [as, cs] = scaled(a, c, s);
    Matrix o(p * n, n);
    o.set_block(0, 0, cs);
    for (std::size_t k = 1; k < n; ++k) {
        o.set_block(k * p, 0, o.block((k - 1) * p, 0, p, n) * as);
    }
    const auto d = dynamics::singular_value_decomposition(o);
    Observability result;
    result.singular_values = d.s;
    const double cut = tolerance * core::never_zero(d.s.front());
    for (const double v : d.s) {
        result.rank += v > cut ? 1U : 0U;
    }
    if (result.rank == n) {
        return result;
    }
    result.unobservable = unobservable_directions(d.v, result.rank, s);
    const Matrix& q = result.unobservable;
    result.unobservable_poles = eigenvalues(q.transposed() * a * q);
    for (const auto& pole : result.unobservable_poles) {
        result.detectable = result.detectable && pole.real() < -1e-9;
    }
    return result;
}

void refuse_unobservable(const Observability& seen, const std::vector<std::string>& names) {
    throw core::InputError(
        "unobservable",
        "the measurements cannot see the direction " + direction_text(seen.unobservable.column_of(0), names) +
            ": no gain can move its pole",
        {}, "estimate the sum that can be seen (total_force), measure more, or trust a drag law and say so");
}

namespace {

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

Matrix place_single_output(const Matrix& a, const Matrix& c, const Poles& poles,
                           const std::vector<std::string>& names) {
    check_square(a);
    const std::size_t n = a.rows();
    if (poles.size() != n) {
        throw core::InputError("poles", "as many poles as states are wanted: " + std::to_string(n));
    }
    const Observability seen = observability(a, c);
    if (seen.rank < n) {
        refuse_unobservable(seen, names);
    }
    Matrix o(n, n), p(n, n), last(n, 1);
    o.set_block(0, 0, c.block(0, 0, 1, n));
    for (std::size_t k = 1; k < n; ++k) {
        o.set_block(k, 0, o.block(k - 1, 0, 1, n) * a);
    }
    for (const double coefficient : polynomial(poles)) {
        p = p * a + coefficient * Matrix::identity(n);
    }
    last(n - 1, 0) = 1;
    return p * dynamics::solve(o, last);
}

namespace {

// Eigenvectors of A' - C' L': each within its space, as orthogonal to the others as possible (KNV 1985, method 0).
Matrix spread_eigenvectors(const std::vector<Matrix>& spaces) {
    const std::size_t n = spaces.size(), p = spaces.front().columns();
    Matrix x(n, n);
    const auto set_column = [&](std::size_t j, const Vector& v) {
        for (std::size_t i = 0; i < n; ++i) {
            x(i, j) = v[i];
        }
    };
    for (std::size_t j = 0; j < n; ++j) {
        set_column(j, spaces[j].column_of(j % p));
    }
    for (int sweep = 0; sweep < 60; ++sweep) {
        for (std::size_t j = 0; j < n; ++j) {
            Matrix others(n, n - 1);
            for (std::size_t k = 0; k < n; ++k) {
                for (std::size_t i = 0; i < n && k != j; ++i) {
                    others(i, k < j ? k : k - 1) = x(i, k);
                }
            }
            const Vector away = dynamics::singular_value_decomposition(others).u.column_of(n - 1);
            Vector v = spaces[j] * (spaces[j].transposed() * away);
            const double size = norm(v);
            if (size > 1e-12) {
                for (double& value : v) {
                    value /= size;
                }
                set_column(j, v);
            }
        }
    }
    return x;
}

}  // namespace

Matrix place(const Matrix& a, const Matrix& c, const Vector& poles, const std::vector<std::string>& names) {
    check_square(a);
    const std::size_t n = a.rows(), p = c.rows();
    if (poles.size() != n) {
        throw core::InputError("poles", "as many poles as states are wanted: " + std::to_string(n));
    }
    const Observability seen = observability(a, c);
    if (seen.rank < n) {
        refuse_unobservable(seen, names);
    }
    if (p == 1) {
        return place_single_output(a, c, Poles(poles.begin(), poles.end()), names);
    }
    if (p >= n) {  // every state is seen at once: the error matrix is what we like
        return (a - Matrix::diagonal(poles)) * pseudo_inverse(c, 1e-12 * c.largest());
    }
    // The dual problem: eigenvectors of A' - C' L' lie in S_j = ker(U1' (A' - p_j)), C' = U0 Z.
    const Matrix at = a.transposed(), b = c.transposed();
    const auto d = dynamics::singular_value_decomposition(b);
    const Matrix u0 = d.u.block(0, 0, n, p), u1 = d.u.block(0, p, n, n - p), z = u0.transposed() * b;
    std::vector<Matrix> spaces;
    for (std::size_t j = 0; j < n; ++j) {
        const Matrix t = u1.transposed() * (at - poles[j] * Matrix::identity(n));
        spaces.push_back(dynamics::singular_value_decomposition(t).v.block(0, n - p, n, p));
    }
    const char* refusal = "these poles cannot be placed: a pole repeats more often than there are measurements";
    const Matrix x = spread_eigenvectors(spaces);
    const Vector independent = singular_values(x);
    if (independent.back() < 1e-10 * independent.front()) {
        throw core::InputError("poles", refusal);
    }
    const Matrix target = x * Matrix::diagonal(poles) * inverse(x);
    const Matrix gain = dynamics::solve(z, u0.transposed() * (at - target));
    if (!gain.finite() ||
        dynamics::frobenius_norm(at - b * gain - target) > 1e-6 * (1 + dynamics::frobenius_norm(target))) {
        throw core::InputError("poles", refusal);
    }
    return gain.transposed();
}

}  // namespace underbody::estimator
