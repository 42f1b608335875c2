#include "surrogates/dynamics/model/dense.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

extern "C" {
void dgeev_(const char* jobvl, const char* jobvr, const int* n, double* a, const int* lda, double* wr, double* wi,
            double* vl, const int* ldvl, double* vr, const int* ldvr, double* work, const int* lwork, int* info);
void dgees_(const char* jobvs, const char* sort, int (*select)(const double*, const double*), const int* n, double* a,
            const int* lda, int* sdim, double* wr, double* wi, double* vs, const int* ldvs, double* work,
            const int* lwork, int* bwork, int* info);
void dgesv_(const int* n, const int* nrhs, double* a, const int* lda, int* ipiv, double* b, const int* ldb, int* info);
void dgesvd_(const char* jobu, const char* jobvt, const int* m, const int* n, double* a, const int* lda, double* s,
             double* u, const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* info);
}

namespace underbody::dynamics {

Dense::Dense(std::initializer_list<std::initializer_list<double>> rows)
    : rows_(rows.size()), columns_(rows.size() ? rows.begin()->size() : 0) {
    for (const auto& row : rows) {
        data_.insert(data_.end(), row.begin(), row.end());
    }
}

Dense Dense::identity(std::size_t size) { return diagonal(std::vector<double>(size, 1.0)); }

Dense Dense::diagonal(const std::vector<double>& values) {
    Dense result(values.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        result(i, i) = values[i];
    }
    return result;
}

Dense Dense::transposed() const {
    Dense result(columns_, rows_);
    for (std::size_t i = 0; i < rows_; ++i) {
        for (std::size_t j = 0; j < columns_; ++j) {
            result(j, i) = (*this)(i, j);
        }
    }
    return result;
}

double Dense::largest() const {
    double most = 0;
    for (const double value : data_) {
        most = std::max(most, std::abs(value));
    }
    return most;
}

Dense operator*(const Dense& a, const Dense& b) {
    Dense result(a.rows_, b.columns_);
    for (std::size_t i = 0; i < a.rows_; ++i) {
        for (std::size_t k = 0; k < a.columns_; ++k) {
            for (std::size_t j = 0; j < b.columns_; ++j) {
                result(i, j) += a(i, k) * b(k, j);
            }
        }
    }
    return result;
}

Dense operator+(const Dense& a, const Dense& b) {
    Dense result = a;
    for (std::size_t i = 0; i < result.data_.size(); ++i) {
        result.data_[i] += b.data_[i];
    }
    return result;
}

Dense operator-(const Dense& a, const Dense& b) { return a + -1.0 * b; }

Dense operator*(double factor, const Dense& a) {
    Dense result = a;
    for (double& value : result.data_) {
        value *= factor;
    }
    return result;
}

namespace {

/// LAPACK reads by columns.
std::vector<double> by_columns(const Dense& a) {
    std::vector<double> data(a.rows() * a.columns());
    for (std::size_t i = 0; i < a.rows(); ++i) {
        for (std::size_t j = 0; j < a.columns(); ++j) {
            data[j * a.rows() + i] = a(i, j);
        }
    }
    return data;
}

void check(int info, const char* what) {
    if (info != 0) {
        throw core::Error("control", std::string("the ") + what + " failed (LAPACK info " + std::to_string(info) + ")");
    }
}

int is_stable(const double* real, const double*) { return *real < 0; }

}  // namespace

std::vector<Eigen1> eigen(const Dense& a) {
    const int n = static_cast<int>(a.rows());
    const std::size_t size = a.rows();
    std::vector<double> m = by_columns(a), wr(size), wi(size), vl(size * size), vr(size * size), work(size * 40 + 64);
    const int lwork = static_cast<int>(work.size());
    int info = 0;
    dgeev_("V", "V", &n, m.data(), &n, wr.data(), wi.data(), vl.data(), &n, vr.data(), &n, work.data(), &lwork, &info);
    check(info, "eigenvalue computation");
    std::vector<Eigen1> result(size);
    const auto vector_of = [&](const std::vector<double>& v, std::size_t k) {
        std::vector<std::complex<double>> out(size);
        for (std::size_t i = 0; i < size; ++i) {
            if (wi[k] == 0) {
                out[i] = v[k * size + i];
            } else {
                const std::size_t first = wi[k] > 0 ? k : k - 1;
                out[i] = {v[first * size + i], (wi[k] > 0 ? 1.0 : -1.0) * v[(first + 1) * size + i]};
            }
        }
        return out;
    };
    for (std::size_t k = 0; k < size; ++k) {
        result[k].value = {wr[k], wi[k]};
        result[k].right = vector_of(vr, k);
        result[k].left = vector_of(vl, k);
        std::complex<double> product = 0;
        for (std::size_t i = 0; i < size; ++i) {
            product += std::conj(result[k].left[i]) * result[k].right[i];
        }
        for (auto& part : result[k].left) {
            part /= std::abs(product) > 1e-300 ? std::conj(product) : std::complex<double>(1.0);
        }
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const Eigen1& l, const Eigen1& r) { return l.value.real() > r.value.real(); });
    return result;
}

std::vector<double> singular_values(const Dense& a) {
    if (a.rows() == 0 || a.columns() == 0) {
        return {};
    }
    const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.columns()), one = 1;
    std::vector<double> data = by_columns(a), s(std::min(a.rows(), a.columns())),
                        work(10 * (a.rows() + a.columns()) + 64);
    const int lwork = static_cast<int>(work.size());
    int info = 0;
    double unused = 0;
    dgesvd_("N", "N", &m, &n, data.data(), &m, s.data(), &unused, &one, &unused, &one, work.data(), &lwork, &info);
    check(info, "singular value decomposition");
    return s;
}

int rank(const Dense& a, double tolerance) {
    const std::vector<double> s = singular_values(a);
    return static_cast<int>(
        std::count_if(s.begin(), s.end(), [&](double value) { return value > tolerance * s.front(); }));
}

Dense solve(const Dense& a, const Dense& b) {
    const int n = static_cast<int>(a.rows()), count = static_cast<int>(b.columns());
    std::vector<double> m = by_columns(a), x = by_columns(b);
    std::vector<int> pivots(a.rows());
    int info = 0;
    dgesv_(&n, &count, m.data(), &n, pivots.data(), x.data(), &n, &info);
    check(info, "solution of a linear system");
    Dense result(a.columns(), b.columns());
    for (std::size_t i = 0; i < result.rows(); ++i) {
        for (std::size_t j = 0; j < result.columns(); ++j) {
            result(i, j) = x[j * a.rows() + i];
        }
    }
    return result;
}

Dense riccati(const Dense& a, const Dense& b, const Dense& q, const Dense& r) {
    const std::size_t n = a.rows();
    const Dense g = b * solve(r, b.transposed());
    Dense hamiltonian(2 * n, 2 * n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            hamiltonian(i, j) = a(i, j);
            hamiltonian(i, n + j) = -g(i, j);
            hamiltonian(n + i, j) = -q(i, j);
            hamiltonian(n + i, n + j) = -a(j, i);
        }
    }
    const int size = static_cast<int>(2 * n);
    std::vector<double> m = by_columns(hamiltonian), wr(2 * n), wi(2 * n), schur(4 * n * n), work(40 * n + 64);
    std::vector<int> flags(2 * n);
    const int lwork = static_cast<int>(work.size());
    int stable = 0, info = 0;
    dgees_("V", "S", &is_stable, &size, m.data(), &size, &stable, wr.data(), wi.data(), schur.data(), &size,
           work.data(), &lwork, flags.data(), &info);
    if (info != 0 || stable != static_cast<int>(n)) {
        throw core::Error("control",
                          "there is no stabilising feedback: the system is not stabilisable by these inputs, or its "
                          "weights do not see an "
                          "undamped mode");
    }
    Dense u1(n, n), u2(n, n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            u1(i, j) = schur[j * 2 * n + i];
            u2(i, j) = schur[j * 2 * n + n + i];
        }
    }
    // X = U2 U1^-1
    const Dense x = solve(u1.transposed(), u2.transposed()).transposed();
    return 0.5 * (x + x.transposed());
}

Dense lyapunov(const Dense& a, const Dense& q) {
    // Kronecker form: fine for the few states here.
    const std::size_t n = a.rows();
    Dense system(n * n, n * n), right(n * n, 1);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            for (std::size_t k = 0; k < n; ++k) {
                system(i * n + j, k * n + j) += a(k, i);
                system(i * n + j, i * n + k) += a(k, j);
            }
            right(i * n + j, 0) = -q(i, j);
        }
    }
    const Dense p = solve(system, right);
    Dense result(n, n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            result(i, j) = 0.5 * (p(i * n + j, 0) + p(j * n + i, 0));
        }
    }
    return result;
}

}  // namespace underbody::dynamics
