#include "surrogates/dynamics/model/matrix_algebra.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/error.h"
#include "core/no_limit.h"

extern "C" {
void dgeev_(const char* jobvl, const char* jobvr, const int* n, double* a, const int* lda, double* wr, double* wi,
            double* vl, const int* ldvl, double* vr, const int* ldvr, double* work, const int* lwork, int* info);
void dgees_(const char* jobvs, const char* sort, int (*select)(const double*, const double*), const int* n, double* a,
            const int* lda, int* sdim, double* wr, double* wi, double* vs, const int* ldvs, double* work,
            const int* lwork, int* bwork, int* info);
void dgesv_(const int* n, const int* nrhs, double* a, const int* lda, int* ipiv, double* b, const int* ldb, int* info);
void dgesvd_(const char* jobu, const char* jobvt, const int* m, const int* n, double* a, const int* lda, double* s,
             double* u, const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* info);
void dsyev_(const char* jobz, const char* uplo, const int* n, double* a, const int* lda, double* w, double* work,
            const int* lwork, int* info);
}

namespace underbody::dynamics {

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

void check_square(const Matrix& a) {
    if (a.rows() != a.columns()) {
        throw core::InputError("shape", "a square matrix is wanted");
    }
    check_finite(a);
}

int is_stable(const double* real, const double*) { return *real < 0; }

/// Eigenvalues by LAPACK, and its vectors by columns where they are asked for.
struct RawEigen {
    explicit RawEigen(const Matrix& a, bool vectors) : real(a.rows()), imaginary(a.rows()) {
        check_square(a);
        const int n = static_cast<int>(a.rows());
        Matrix columns = a.transposed();
        std::vector<double> work(40 * a.rows() + 64);
        left.resize(vectors ? a.rows() * a.rows() : 1);
        right = left;
        const int lwork = static_cast<int>(work.size()), width = vectors ? std::max(n, 1) : 1;
        const char* job = vectors ? "V" : "N";
        int info = 0;
        if (n > 0) {
            dgeev_(job, job, &n, columns.data(), &n, real.data(), imaginary.data(), left.data(), &width, right.data(),
                   &width, work.data(), &lwork, &info);
        }
        check(info, "eigenvalue computation");
    }
    /// Complex pairs share two real columns.
    [[nodiscard]] std::vector<std::complex<double>> vector(const std::vector<double>& v, std::size_t k) const {
        const std::size_t size = real.size(), first = imaginary[k] < 0 ? k - 1 : k;
        std::vector<std::complex<double>> out(size);
        for (std::size_t i = 0; i < size; ++i) {
            out[i] = v[first * size + i];
            if (imaginary[k] != 0) {
                out[i].imag((imaginary[k] > 0 ? 1.0 : -1.0) * v[(first + 1) * size + i]);
            }
        }
        return out;
    }
    std::vector<double> real, imaginary, left, right;
};

Eigen::MatrixXd by_columns(const Matrix& a) {
    return Eigen::Map<const Eigen::MatrixXd>(a.data(), static_cast<Eigen::Index>(a.columns()),
                                             static_cast<Eigen::Index>(a.rows()))
        .transpose();
}

Matrix by_rows(const Eigen::MatrixXd& m) {
    Matrix a(static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols()));
    Eigen::Map<Eigen::MatrixXd>(a.data(), m.cols(), m.rows()) = m.transpose();
    return a;
}

}  // namespace

std::vector<EigenPair> eigen(const Matrix& a) {
    const RawEigen raw(a, true);
    std::vector<EigenPair> result(a.rows());
    for (std::size_t k = 0; k < result.size(); ++k) {
        EigenPair& one = result[k];
        one = {{raw.real[k], raw.imaginary[k]}, raw.vector(raw.right, k), raw.vector(raw.left, k)};
        std::complex<double> product = 0;
        for (std::size_t i = 0; i < one.left.size(); ++i) {
            product += std::conj(one.left[i]) * one.right[i];
        }
        for (auto& part : one.left) {
            part /= std::abs(product) > core::least_divisor ? std::conj(product) : std::complex<double>(1.0);
        }
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const EigenPair& l, const EigenPair& r) { return l.value.real() > r.value.real(); });
    return result;
}

Poles eigenvalues(const Matrix& a) {
    const RawEigen raw(a, false);
    Poles poles;
    for (std::size_t i = 0; i < a.rows(); ++i) {
        poles.emplace_back(raw.real[i], raw.imaginary[i]);
    }
    std::sort(poles.begin(), poles.end(), [](const auto& p, const auto& q) {
        return p.real() != q.real() ? p.real() > q.real() : p.imag() > q.imag();
    });
    return poles;
}

SingularValues singular_value_decomposition(const Matrix& a) {
    check_finite(a);
    const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.columns());
    Matrix columns = a.transposed(), u(a.rows(), a.rows()), vt(a.columns(), a.columns());  // LAPACK reads by columns
    SingularValues out;
    out.s.resize(std::min(a.rows(), a.columns()));
    std::vector<double> work(10 * (a.rows() + a.columns()) + 64);
    const int lwork = static_cast<int>(work.size());
    int info = 0;
    if (!out.s.empty()) {
        dgesvd_("A", "A", &m, &n, columns.data(), &m, out.s.data(), u.data(), &m, vt.data(), &n, work.data(), &lwork,
                &info);
    }
    check(info, "singular value decomposition");
    out.u = u.transposed();
    out.v = std::move(vt);  // V' by columns is V by rows
    return out;
}

std::vector<double> singular_values(const Matrix& a) { return singular_value_decomposition(a).s; }

int rank(const Matrix& a, double tolerance) {
    const std::vector<double> s = singular_values(a);
    return static_cast<int>(
        std::count_if(s.begin(), s.end(), [&](double value) { return value > tolerance * s.front(); }));
}

Matrix pseudo_inverse(const Matrix& a, double tolerance) {
    const auto d = singular_value_decomposition(a);
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

SymmetricEigen symmetric_eigen(const Matrix& a) {
    check_finite(a);
    const std::size_t n = a.rows();
    const int size = static_cast<int>(n);
    Matrix vectors = a;
    std::vector<double> values(n), work(10 * n + 64);
    const int lwork = static_cast<int>(work.size());
    int info = 0;
    dsyev_("V", "U", &size, vectors.data(), &size, values.data(), work.data(), &lwork,
           &info);  // upper by columns: lower by rows
    check(info, "eigenvalue computation");
    std::reverse(values.begin(), values.end());
    SymmetricEigen out{values, Matrix(n, n)};
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

std::vector<double> solve(const Matrix& a, const std::vector<double>& b) {
    return solve(a, Matrix::column(b)).column_of(0);
}

Matrix inverse(const Matrix& a) { return solve(a, Matrix::identity(a.rows())); }

double frobenius_norm(const Matrix& a) { return by_columns(a).norm(); }

Matrix exponential(const Matrix& a) {
    if (a.rows() != a.columns() || !a.finite()) {
        throw core::InputError("shape", "the exponential needs a square matrix of finite values");
    }
    return by_rows(by_columns(a).exp());
}

Matrix logarithm(const Matrix& a) {
    for (const auto& pole : eigenvalues(a)) {
        if (pole.real() <= 0 && std::abs(pole.imag()) < 1e-12 * (1 + std::abs(pole.real()))) {
            throw core::InputError("singular",
                                   "a discrete model with an eigenvalue at or below zero has no continuous-time form",
                                   {}, "take a shorter time step or fewer modes");
        }
    }
    return by_rows(by_columns(a).log());
}

Matrix riccati(const Matrix& a, const Matrix& b, const Matrix& q, const Matrix& r) {
    const Eigen::Index n = static_cast<Eigen::Index>(a.rows());
    Eigen::MatrixXd hamiltonian(2 * n, 2 * n), schur(2 * n, 2 * n);
    hamiltonian << by_columns(a), -by_columns(b * solve(r, b.transposed())), -by_columns(q), -by_columns(a).transpose();
    const int size = static_cast<int>(2 * n), lwork = 40 * size + 64;
    Eigen::VectorXd real(2 * n), imaginary(2 * n), work(lwork);
    std::vector<int> flags(static_cast<std::size_t>(size));
    int stable = 0, info = 0;
    dgees_("V", "S", &is_stable, &size, hamiltonian.data(), &size, &stable, real.data(), imaginary.data(), schur.data(),
           &size, work.data(), &lwork, flags.data(), &info);
    if (info != 0 || stable != static_cast<int>(n)) {
        throw core::Error("control",
                          "there is no stabilising feedback: the system is not stabilisable by these inputs, or its "
                          "weights do not see an "
                          "undamped mode");
    }
    // X = U2 U1^-1
    const Matrix x =
        solve(by_rows(schur.topLeftCorner(n, n).transpose()), by_rows(schur.bottomLeftCorner(n, n).transpose()))
            .transposed();
    return 0.5 * (x + x.transposed());
}

Matrix lyapunov(const Matrix& a, const Matrix& q) {
    if (eigenvalues(a).front().real() >= 0) {
        throw core::InputError("unstable",
                               "the Lyapunov equation needs a matrix whose eigenvalues all lie in the left half plane");
    }
    // Kronecker form: fine for the few states here.
    const std::size_t n = a.rows();
    Matrix system(n * n, n * n), right(n * n, 1);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            for (std::size_t k = 0; k < n; ++k) {
                system(i * n + j, k * n + j) += a(k, i);
                system(i * n + j, i * n + k) += a(k, j);
            }
            right(i * n + j, 0) = -q(i, j);
        }
    }
    const Matrix p = solve(system, right);
    Matrix result(n, n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            result(i, j) = 0.5 * (p(i * n + j, 0) + p(j * n + i, 0));
        }
    }
    return result;
}

}  // namespace underbody::dynamics
