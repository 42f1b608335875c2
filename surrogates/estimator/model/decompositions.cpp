#include "surrogates/estimator/model/decompositions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "surrogates/estimator/model/linear_system.h"

extern "C" {
void dgesvd_(const char* jobu, const char* jobvt, const int* m, const int* n, double* a, const int* lda, double* s,
             double* u, const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* info);
void dsyev_(const char* jobz, const char* uplo, const int* n, double* a, const int* lda, double* w, double* work,
            const int* lwork, int* info);
void dgesv_(const int* n, const int* nrhs, double* a, const int* lda, int* ipiv, double* b, const int* ldb, int* info);
void dgeev_(const char* jobvl, const char* jobvr, const int* n, double* a, const int* lda, double* wr, double* wi,
            double* vl, const int* ldvl, double* vr, const int* ldvr, double* work, const int* lwork, int* info);
}

namespace underbody::estimator {

namespace {

void check(int info, const char* what) {
    if (info != 0) {
        throw core::InputError(
            "singular", std::string("the ") + what + " of a matrix failed (LAPACK info " + std::to_string(info) + ")");
    }
}

void check_finite(const Matrix& a) {
    if (!a.finite()) {
        throw core::InputError("range", "a matrix holds a value that is not finite");
    }
}

}  // namespace

namespace internal {

SingularValues singular_value_decomposition(const Matrix& a) {
    check_finite(a);
    const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.columns());
    Matrix columns = a.transposed(), u(a.rows(), a.rows()), vt(a.columns(), a.columns());  // LAPACK reads by columns
    SingularValues out;
    out.s.resize(std::min(a.rows(), a.columns()));
    Vector work(10 * (a.rows() + a.columns()) + 64);
    const int lwork = static_cast<int>(work.size());
    int info = 0;
    dgesvd_("A", "A", &m, &n, columns.data(), &m, out.s.data(), u.data(), &m, vt.data(), &n, work.data(), &lwork,
            &info);
    check(info, "singular value decomposition");
    out.u = u.transposed();
    out.v = std::move(vt);  // V' by columns is V by rows
    return out;
}

SymmetricEigen symmetric_eigen(const Matrix& a) {
    check_finite(a);
    const std::size_t n = a.rows();
    const int size = static_cast<int>(n);
    Matrix vectors = a;
    Vector values(n), work(10 * n + 64);
    const int lwork = static_cast<int>(work.size());
    int info = 0;
    dsyev_("V", "U", &size, vectors.data(), &size, values.data(), work.data(), &lwork,
           &info);  // upper by columns: lower by rows
    check(info, "eigenvalue computation");
    SymmetricEigen out{values, Matrix(n, n)};
    std::reverse(out.values.begin(), out.values.end());
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t i = 0; i < n; ++i) {
            out.vectors(i, n - 1 - k) = vectors(k, i);
        }
    }
    return out;
}

Matrix solve(const Matrix& a, const Matrix& b) {
    const int n = static_cast<int>(a.rows()), count = static_cast<int>(b.columns());
    Matrix columns = a.transposed(), x = b.transposed();
    std::vector<int> pivots(a.rows());
    int info = 0;
    dgesv_(&n, &count, columns.data(), &n, pivots.data(), x.data(), &n, &info);
    check(info, "solution of the linear system");
    return x.transposed();
}

double norm_1(const Matrix& a) {
    double largest = 0;
    for (std::size_t j = 0; j < a.columns(); ++j) {
        double sum = 0;
        for (std::size_t i = 0; i < a.rows(); ++i) {
            sum += std::abs(a(i, j));
        }
        largest = std::max(largest, sum);
    }
    return largest;
}

double norm_f(const Matrix& a) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rows() * a.columns(); ++i) {
        sum += a.data()[i] * a.data()[i];
    }
    return std::sqrt(sum);
}

}  // namespace internal

Poles eigenvalues(const Matrix& a) {
    if (a.rows() != a.columns()) {
        throw core::InputError("shape", "a square matrix is wanted");
    }
    check_finite(a);
    const std::size_t n = a.rows();
    const int size = static_cast<int>(n), one = 1;
    Matrix columns = a.transposed();
    Vector real(n), imaginary(n), work(10 * n + 64);
    const int lwork = static_cast<int>(work.size());
    int info = 0;
    double unused = 0;
    if (n > 0) {
        dgeev_("N", "N", &size, columns.data(), &size, real.data(), imaginary.data(), &unused, &one, &unused, &one,
               work.data(), &lwork, &info);
    }
    check(info, "eigenvalue computation");
    Poles poles;
    for (std::size_t i = 0; i < n; ++i) {
        poles.emplace_back(real[i], imaginary[i]);
    }
    std::sort(poles.begin(), poles.end(), [](const auto& p, const auto& q) {
        return p.real() != q.real() ? p.real() > q.real() : p.imag() > q.imag();
    });
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

Vector singular_values(const Matrix& a) { return internal::singular_value_decomposition(a).s; }

Matrix pseudo_inverse(const Matrix& a, double tolerance) {
    const auto d = internal::singular_value_decomposition(a);
    Matrix out(a.columns(), a.rows());
    for (std::size_t k = 0; k < d.s.size(); ++k) {
        for (std::size_t i = 0; i < a.columns() && d.s[k] > tolerance; ++i) {
            for (std::size_t j = 0; j < a.rows(); ++j) {
                out(i, j) += d.v(i, k) * d.u(j, k) / d.s[k];
            }
        }
    }
    return out;
}

Vector solve(const Matrix& a, const Vector& b) { return internal::solve(a, Matrix::column(b)).column_of(0); }

Matrix inverse(const Matrix& a) { return internal::solve(a, Matrix::identity(a.rows())); }

}  // namespace underbody::estimator
