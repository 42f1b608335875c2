// Small dense matrices and what linear analysis needs of them, by LAPACK.
#pragma once

#include <complex>
#include <cstddef>
#include <initializer_list>
#include <vector>

namespace underbody::dynamics {

/// Row-major, by value.
class Dense {
public:
    Dense() = default;
    Dense(std::size_t rows, std::size_t columns) : rows_(rows), columns_(columns), data_(rows * columns, 0.0) {}
    Dense(std::initializer_list<std::initializer_list<double>> rows);
    static Dense identity(std::size_t size);
    static Dense diagonal(const std::vector<double>& values);

    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t columns() const { return columns_; }
    double& operator()(std::size_t i, std::size_t j) { return data_[i * columns_ + j]; }
    double operator()(std::size_t i, std::size_t j) const { return data_[i * columns_ + j]; }
    [[nodiscard]] Dense transposed() const;
    [[nodiscard]] double largest() const;  ///< largest absolute entry
    friend Dense operator*(const Dense& a, const Dense& b);
    friend Dense operator+(const Dense& a, const Dense& b);
    friend Dense operator-(const Dense& a, const Dense& b);
    friend Dense operator*(double factor, const Dense& a);

private:
    std::size_t rows_ = 0, columns_ = 0;
    std::vector<double> data_;
};

struct Eigen1 {
    std::complex<double> value;
    std::vector<std::complex<double>> right, left;  ///< right unit length, left scaled so that left^H right = 1
};
/// All eigenvalues with vectors, by falling real part. Throws core::Error when LAPACK fails.
std::vector<Eigen1> eigen(const Dense& a);
std::vector<double> singular_values(const Dense& a);
int rank(const Dense& a, double tolerance = 1e-10);
/// a x = b. Throws core::Error when a is singular.
Dense solve(const Dense& a, const Dense& b);

/// The stabilising X of A'X + X A - X B R^-1 B' X + Q = 0, by the ordered real Schur form of the Hamiltonian (Laub
/// 1979). Throws core::Error (kind "control") when there is none: not stabilisable, or an eigenvalue on the imaginary
/// axis.
Dense riccati(const Dense& a, const Dense& b, const Dense& q, const Dense& r);
/// P of A'P + P A + Q = 0.
Dense lyapunov(const Dense& a, const Dense& q);

}  // namespace underbody::dynamics
