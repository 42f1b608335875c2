// What the parameters of a Gaussian process could also be: points and weights that stand for their posterior around its
// maximum.
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "surrogates/tables/fit/gaussian_process.h"

namespace underbody::tables {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

GpParameters moved(const GpParameters& p, const VectorXd& by) {
    GpParameters q = p;
    for (std::size_t i = 0; i < q.length.size(); ++i) {
        q.length[i] *= std::exp(by(static_cast<Eigen::Index>(i)));
    }
    q.scale *= std::exp(by(static_cast<Eigen::Index>(q.length.size())));
    return q;
}

/// Minus the second derivatives of the log posterior by log lengths and log scale, from differences of its gradient.
MatrixXd curvature(const GpData& data, const GpOptions& options, const GpParameters& p) {
    const auto d = static_cast<Eigen::Index>(p.length.size() + 1);
    constexpr double step = 0.05;
    MatrixXd hessian(d, d);
    for (Eigen::Index i = 0; i < d; ++i) {
        std::vector<double> up, down;
        VectorXd by = VectorXd::Zero(d);
        by(i) = step;
        GaussianProcess::log_posterior(data, options, moved(p, by), &up);
        GaussianProcess::log_posterior(data, options, moved(p, -by), &down);
        for (Eigen::Index j = 0; j < d; ++j) {
            hessian(i, j) = (down[static_cast<std::size_t>(j)] - up[static_cast<std::size_t>(j)]) / (2 * step);
        }
    }
    return 0.5 * (hessian + hessian.transpose());
}

}  // namespace

double GaussianProcess::scatter_uncertainty(const GpData& data, const GpOptions& options, const GpParameters& best) {
    constexpr double step = 0.1;
    std::vector<double> up, down;
    GpParameters p = best;
    p.scatter = best.scatter * std::exp(step);
    log_posterior(data, options, p, &up);
    p.scatter = best.scatter * std::exp(-step);
    log_posterior(data, options, p, &down);
    const double curvature = (down.back() - up.back()) / (2 * step);
    return 1 / std::sqrt(std::max(curvature, 0.05));
}

/// The rule of degree three with a centre: exact for the mean and the covariance of a normal distribution (Arasaratnam
/// and Haykin 2009), then weighted by what the posterior is there and the normal one is not (Rue, Martino and Chopin
/// 2009).
std::vector<GpWeighted> GaussianProcess::posterior_design(const GpData& data, const GpOptions& options,
                                                          const GpParameters& best) {
    const MatrixXd hessian = curvature(data, options, best);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(hessian);
    const Eigen::Index d = hessian.rows();
    const double reach = std::sqrt(static_cast<double>(d) + 1);
    const double at_best = log_posterior(data, options, best, nullptr);
    std::vector<GpWeighted> design{{best, 1 / (static_cast<double>(d) + 1)}};
    for (Eigen::Index i = 0; i < d; ++i) {
        // The priors alone bend it by 0.4 at least.
        const double deviation = 1 / std::sqrt(std::max(eigen.eigenvalues()(i), 0.4));
        for (const double side : {-1.0, 1.0}) {
            VectorXd by = side * reach * deviation * eigen.eigenvectors().col(i);
            const double largest = by.cwiseAbs().maxCoeff();
            by *= largest > 2.5 ? 2.5 / largest : 1;
            const GpParameters p = moved(best, by);
            const double beyond_normal =
                log_posterior(data, options, p, nullptr) - at_best + 0.5 * std::pow(by.norm() / deviation, 2);
            design.push_back({p, std::exp(std::clamp(beyond_normal, -6.0, 1.5)) / (2 * (static_cast<double>(d) + 1))});
        }
    }
    double sum = 0;
    for (const auto& point : design) {
        sum += point.weight;
    }
    for (auto& point : design) {
        point.weight /= sum;
    }
    return design;
}

}  // namespace underbody::tables
