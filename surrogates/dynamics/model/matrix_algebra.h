// Decompositions, equations and functions of small dense matrices, by LAPACK and Eigen.
#pragma once

#include <complex>
#include <vector>

#include "surrogates/dynamics/model/matrix.h"

namespace underbody::dynamics {

// Unless said otherwise, a matrix with a value that is not finite is a core::InputError (kind "range"), one that LAPACK
// cannot treat a core::InputError (kind "singular").

struct EigenPair {
    std::complex<double> value;
    std::vector<std::complex<double>> right, left;  ///< right unit length, left scaled so that left^H right = 1
};
/// All eigenvalues with vectors, by falling real part.
std::vector<EigenPair> eigen(const Matrix& a);

using Poles = std::vector<std::complex<double>>;
/// Eigenvalues, by descending real part, then descending imaginary part.
Poles eigenvalues(const Matrix& a);

/// a = u diag(s) v' with square orthogonal u and v; s descending, min(rows, columns) of them.
struct SingularValues {
    Matrix u;
    std::vector<double> s;
    Matrix v;
};
SingularValues singular_value_decomposition(const Matrix& a);
/// Singular values, descending.
std::vector<double> singular_values(const Matrix& a);
/// How many singular values exceed `tolerance` times the largest.
int rank(const Matrix& a, double tolerance = 1e-10);
/// Moore-Penrose inverse; singular values at or below `tolerance` (absolute) count as zero.
Matrix pseudo_inverse(const Matrix& a, double tolerance);

/// Of a symmetric matrix (its lower triangle is read): values descending, unit vectors in the columns.
struct SymmetricEigen {
    std::vector<double> values;
    Matrix vectors;
};
SymmetricEigen symmetric_eigen(const Matrix& a);

/// X of A X = B for a square regular A; values that are not finite go through.
Matrix solve(const Matrix& a, const Matrix& b);
std::vector<double> solve(const Matrix& a, const std::vector<double>& b);
Matrix inverse(const Matrix& a);

double frobenius_norm(const Matrix& a);

/// exp(A).
Matrix exponential(const Matrix& a);
/// Principal logarithm. Throws core::InputError when an eigenvalue is zero or negative real.
Matrix logarithm(const Matrix& a);

/// The stabilising X of A'X + X A - X B R^-1 B' X + Q = 0, by the ordered real Schur form of the Hamiltonian (Laub
/// 1979). Throws core::Error (kind "control") when there is none: not stabilisable, or an eigenvalue on the imaginary
/// axis.
Matrix riccati(const Matrix& a, const Matrix& b, const Matrix& q, const Matrix& r);
/// P with A' P + P A + Q = 0. Throws core::InputError (kind "unstable") when A is not Hurwitz.
Matrix lyapunov(const Matrix& a, const Matrix& q);

}  // namespace underbody::dynamics
