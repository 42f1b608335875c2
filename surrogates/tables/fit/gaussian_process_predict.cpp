// Predictions of a Gaussian process at single points, with slopes: what a search asks for thousands of times.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "surrogates/tables/fit/gaussian_process_state.h"

namespace underbody::tables {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Covariances of the process (without trend) between a point and the data; with `rate` [point, axis] the derivative of
/// their logarithm by the point's coordinates.
ArrayXd covariances(const ArrayXXd& data, Kernel kernel, const GpParameters& p, std::span<const double> x,
                    ArrayXXd* rate) {
    ArrayXd exponent = ArrayXd::Zero(data.rows());
    ArrayXd factor = ArrayXd::Constant(data.rows(), p.scale * p.scale);
    if (rate != nullptr) {
        rate->resize(data.rows(), data.cols());
    }
    for (Eigen::Index a = 0; a < data.cols(); ++a) {
        const double length = p.length[static_cast<std::size_t>(a)];
        const ArrayXd d = (x[static_cast<std::size_t>(a)] - data.col(a)) / length;
        if (kernel == Kernel::squared_exponential) {
            exponent += 0.5 * d.square();
            if (rate != nullptr) {
                rate->col(a) = -d / length;
            }
        } else {
            const ArrayXd s = std::sqrt(5.0) * d.abs();
            const ArrayXd polynomial = 1 + s + s.square() / 3;
            exponent += s;
            factor *= polynomial;
            if (rate != nullptr) {
                rate->col(a) = -5.0 / 3.0 * d * (1 + s) / (polynomial * length);
            }
        }
    }
    return factor * (-exponent).exp();
}

}  // namespace

GpPrediction GaussianProcess::predict(std::span<const double> x, std::span<const double> trend,
                                      std::span<const double> trend_slope) const {
    const State& s = *state_;
    const GpData& data = s.data;
    const auto n = static_cast<Eigen::Index>(data.count());
    const auto trends = static_cast<Eigen::Index>(data.trends);
    const bool slopes = !trend_slope.empty();
    const Eigen::Map<const RowMajor> h(data.trend.data(), n, trends);
    const Eigen::Map<const VectorXd> own(trend.data(), trends);
    const Eigen::Map<const VectorXd> weights(s.weights.data(), n);

    ArrayXXd rate;
    const ArrayXd process = covariances(s.x, s.kernel, s.parameters, x, slopes ? &rate : nullptr);
    const VectorXd k = process.matrix() + data.trend_variance * (h * own);
    VectorXd u = s.factor.matrixL().solve(k);
    GpPrediction result;
    result.mean = k.dot(weights);
    const double prior = s.parameters.scale * s.parameters.scale + data.trend_variance * own.squaredNorm();
    result.variance = std::max(0.0, prior - u.squaredNorm());
    if (slopes) {
        s.factor.matrixU().solveInPlace(u);
        const auto axes = static_cast<Eigen::Index>(data.axes);
        const Eigen::Map<const RowMajor> dh(trend_slope.data(), trends, axes);
        for (Eigen::Index a = 0; a < axes; ++a) {
            const VectorXd dk = (process * rate.col(a)).matrix() + data.trend_variance * (h * dh.col(a));
            result.mean_slope.push_back(dk.dot(weights));
            result.variance_slope.push_back(2 * (data.trend_variance * own.dot(dh.col(a)) - u.dot(dk)));
        }
    }
    return result;
}

std::vector<double> GaussianProcess::covariance(std::span<const double> x, std::span<const double> trend) const {
    const State& s = *state_;
    const GpData& data = s.data;
    const auto n = static_cast<Eigen::Index>(data.count());
    const auto axes = static_cast<Eigen::Index>(data.axes);
    const auto trends = static_cast<Eigen::Index>(data.trends);
    const auto points = static_cast<Eigen::Index>(x.size()) / axes;
    const ArrayXXd at = Eigen::Map<const RowMajor>(x.data(), points, axes).array();
    const Eigen::Map<const RowMajor> own(trend.data(), points, trends);
    const Eigen::Map<const RowMajor> h(data.trend.data(), n, trends);
    MatrixXd k(n, points);
    MatrixXd result = data.trend_variance * own * own.transpose();
    for (Eigen::Index j = 0; j < points; ++j) {
        const std::span<const double> point = x.subspan(static_cast<std::size_t>(j * axes), data.axes);
        k.col(j) = covariances(s.x, s.kernel, s.parameters, point, nullptr).matrix() +
                   data.trend_variance * (h * own.row(j).transpose());
        result.col(j) += covariances(at, s.kernel, s.parameters, point, nullptr).matrix();
    }
    s.factor.matrixL().solveInPlace(k);
    result.noalias() -= k.transpose() * k;
    return {result.data(), result.data() + result.size()};
}

}  // namespace underbody::tables
