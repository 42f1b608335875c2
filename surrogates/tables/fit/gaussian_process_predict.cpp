// Predictions of a Gaussian process at single points, with slopes: what a search asks for thousands of times.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "surrogates/tables/fit/gaussian_process_state.h"

namespace underbody::tables {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Covariances of the process (without trend) with the data, made up axis by axis; with rates [point, axis] the
/// derivative of their logarithm by the point's coordinates.
struct Product {
    ArrayXd exponent, factor;
    ArrayXXd rate;

    Product(const ArrayXXd& data, const GpParameters& p, bool rates)
        : exponent(ArrayXd::Zero(data.rows())), factor(ArrayXd::Constant(data.rows(), p.scale * p.scale)) {
        if (rates) {
            rate.resize(data.rows(), data.cols());
        }
    }

    void take(const ArrayXXd& data, Kernel kernel, const GpParameters& p, Eigen::Index a, double x) {
        const double length = p.length[static_cast<std::size_t>(a)];
        const ArrayXd d = (x - data.col(a)) / length;
        if (kernel == Kernel::squared_exponential) {
            exponent += 0.5 * d.square();
            if (rate.size() > 0) {
                rate.col(a) = -d / length;
            }
        } else {
            const ArrayXd s = std::sqrt(5.0) * d.abs();
            const ArrayXd polynomial = 1 + s + s.square() / 3;
            exponent += s;
            factor *= polynomial;
            if (rate.size() > 0) {
                rate.col(a) = -5.0 / 3.0 * d * (1 + s) / (polynomial * length);
            }
        }
    }

    [[nodiscard]] ArrayXd covariances() const { return factor * (-exponent).exp(); }
};

ArrayXd covariances(const ArrayXXd& data, Kernel kernel, const GpParameters& p, std::span<const double> x,
                    ArrayXXd* rate) {
    Product product(data, p, rate != nullptr);
    for (Eigen::Index a = 0; a < data.cols(); ++a) {
        product.take(data, kernel, p, a, x[static_cast<std::size_t>(a)]);
    }
    if (rate != nullptr) {
        *rate = std::move(product.rate);
    }
    return product.covariances();
}

/// Correlations with the data along one axis, and the derivative of their logarithm.
struct OnAxis {
    ArrayXd factor, rate;

    OnAxis() = default;
    OnAxis(const ArrayXXd& data, Kernel kernel, GpParameters p, Eigen::Index a, double x) {
        p.scale = 1;
        Product alone(data, p, true);
        alone.take(data, kernel, p, a, x);
        factor = alone.covariances();
        rate = alone.rate.col(a);
    }
};

/// Axes in which not all points [point, axis] are equal.
std::vector<Eigen::Index> axes_that_vary(const Eigen::Map<const RowMajor>& points) {
    std::vector<Eigen::Index> varying;
    for (Eigen::Index a = 0; a < points.cols(); ++a) {
        if ((points.col(a).array() != points(0, a)).any()) {
            varying.push_back(a);
        }
    }
    return varying;
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

GpMeans GaussianProcess::means(std::span<const double> x, std::span<const double> trend,
                               std::span<const double> trend_slope) const {
    const State& s = *state_;
    const auto axes = static_cast<Eigen::Index>(s.data.axes), trends = static_cast<Eigen::Index>(s.data.trends);
    const auto points = static_cast<Eigen::Index>(x.size()) / axes;
    const Eigen::Map<const RowMajor> at(x.data(), points, axes), own(trend.data(), points, trends);
    const Eigen::Map<const VectorXd> weights(s.weights.data(), static_cast<Eigen::Index>(s.weights.size()));
    const Eigen::Map<const VectorXd> coefficients(s.coefficients.data(), trends);
    const bool slopes = !trend_slope.empty();
    const std::vector<Eigen::Index> varying = axes_that_vary(at);
    Product shared(s.x, s.parameters, slopes);
    for (Eigen::Index a = 0; a < axes; ++a) {
        if (std::find(varying.begin(), varying.end(), a) == varying.end()) {
            shared.take(s.x, s.kernel, s.parameters, a, at(0, a));
        }
    }
    const ArrayXd weighted = shared.covariances() * weights.array();
    std::map<std::pair<Eigen::Index, double>, OnAxis> known;  // the nodes of a curve have few coordinates
    GpMeans result;
    for (Eigen::Index i = 0; i < points; ++i) {
        ArrayXd here = weighted;
        for (const Eigen::Index a : varying) {
            const auto [factor, fresh] = known.try_emplace({a, at(i, a)});
            if (fresh) {
                factor->second = OnAxis(s.x, s.kernel, s.parameters, a, at(i, a));
            }
            here *= factor->second.factor;
            if (slopes) {
                shared.rate.col(a) = factor->second.rate;
            }
        }
        result.mean.push_back(here.sum() + own.row(i).dot(coefficients));
        if (slopes) {
            const Eigen::Map<const RowMajor> dh(&trend_slope[static_cast<std::size_t>(i * trends * axes)], trends,
                                                axes);
            const VectorXd slope = shared.rate.matrix().transpose() * here.matrix() + dh.transpose() * coefficients;
            result.slope.insert(result.slope.end(), slope.data(), slope.data() + axes);
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
