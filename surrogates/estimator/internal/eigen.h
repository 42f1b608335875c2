// Between the room's plain matrices and Eigen; for .cpp files of this room only.
#pragma once

#include <Eigen/Core>

#include "surrogates/estimator/matrix.h"

namespace underbody::estimator::internal {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline Eigen::Map<const RowMajor> view(const Matrix& m) {
    return {m.data(), static_cast<Eigen::Index>(m.rows()), static_cast<Eigen::Index>(m.columns())};
}

inline Eigen::Map<const Eigen::VectorXd> view(const Vector& v) { return {v.data(), static_cast<Eigen::Index>(v.size())}; }

inline Matrix plain(const Eigen::MatrixXd& m) {
    Matrix out(static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols()));
    Eigen::Map<RowMajor>(out.data(), m.rows(), m.cols()) = m;
    return out;
}

inline Vector plain_vector(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

}  // namespace underbody::estimator::internal
