// Decompositions of small dense matrices by LAPACK; for .cpp files of this room only.
#pragma once

#include "surrogates/estimator/model/matrix.h"

namespace underbody::estimator::internal {

/// a = u diag(s) v' with square orthogonal u and v; s descending, min(rows, columns) of them.
struct SingularValues {
    Matrix u;
    Vector s;
    Matrix v;
};
SingularValues singular_value_decomposition(const Matrix& a);

/// Of a symmetric matrix (its lower triangle is read): values descending, unit vectors in the columns.
struct SymmetricEigen {
    Vector values;
    Matrix vectors;
};
SymmetricEigen symmetric_eigen(const Matrix& a);

/// X of A X = B for a square regular A. Throws core::InputError (kind "singular").
Matrix solve(const Matrix& a, const Matrix& b);

double norm_1(const Matrix& a);  ///< largest column sum of absolute values
double norm_f(const Matrix& a);  ///< Frobenius

}  // namespace underbody::estimator::internal
