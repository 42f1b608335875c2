#include "surrogates/tables/hull.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace underbody::tables {

Hull::Hull(const std::vector<TableAxis>& axes, const std::vector<std::vector<double>>& points) : axes_(axes), made_of_(points) {
    for (auto& axis : axes_) {
        axis.points.clear();
    }
    for (const auto& point : points) {
        for (std::size_t k = 0; k < axes_.size(); ++k) {
            points_.push_back(coordinate(k, point[k]));
        }
    }
}

double Hull::coordinate(std::size_t k, double x) const {
    const TableAxis& axis = axes_[k];
    x = std::clamp(x, axis.lower, axis.upper);
    const bool log = axis.name == "gap" && axis.lower > 0 && axis.upper >= 4 * axis.lower;
    return log ? std::log(x / axis.lower) / std::log(axis.upper / axis.lower) : (x - axis.lower) / (axis.upper - axis.lower);
}

double Hull::distance(const double* point) const {
    using Eigen::Index;
    const auto n = static_cast<Index>(axes_.size());
    Eigen::VectorXd at(n);
    for (Index k = 0; k < n; ++k) {
        at(k) = coordinate(static_cast<std::size_t>(k), point[k]);
    }
    const Eigen::Map<const Eigen::MatrixXd> q(points_.data(), n, static_cast<Index>(points_.size()) / n);
    // The nearest point of the hull is a mean of a few of its points ("corners"), found by adding the point furthest along the way to `at`.
    std::vector<Index> corners;
    std::vector<double> weight;
    Index first = 0;
    (q.colwise() - at).colwise().squaredNorm().minCoeff(&first);
    corners.push_back(first);
    weight.push_back(1);
    Eigen::VectorXd nearest = q.col(first) - at;
    for (int outer = 0; outer < 100 && nearest.squaredNorm() > 1e-20; ++outer) {
        Index next = 0;
        const double lowest = ((q.colwise() - at).transpose() * nearest).minCoeff(&next);
        if (lowest >= nearest.squaredNorm() - 1e-12 || std::find(corners.begin(), corners.end(), next) != corners.end()) {
            break;
        }
        corners.push_back(next);
        weight.push_back(0);
        while (true) {
            // Nearest point of the plane through the corners.
            const auto m = static_cast<Index>(corners.size());
            Eigen::MatrixXd system = Eigen::MatrixXd::Ones(m + 1, m + 1);
            system(m, m) = 0;
            for (Index i = 0; i < m; ++i) {
                for (Index j = 0; j < m; ++j) {
                    system(i, j) = (q.col(corners[static_cast<std::size_t>(i)]) - at).dot(q.col(corners[static_cast<std::size_t>(j)]) - at);
                }
            }
            Eigen::VectorXd right = Eigen::VectorXd::Zero(m + 1);
            right(m) = 1;
            const Eigen::VectorXd wanted = system.fullPivLu().solve(right).head(m);
            double share = 1;
            for (Index i = 0; i < m; ++i) {
                const double w = weight[static_cast<std::size_t>(i)];
                if (wanted(i) < 1e-12 && w > wanted(i)) {
                    share = std::min(share, w / (w - wanted(i)));
                }
            }
            for (Index i = m; i-- > 0;) {
                double& w = weight[static_cast<std::size_t>(i)];
                w += share * (wanted(i) - w);
                if (w < 1e-12 && corners.size() > 1) {
                    weight.erase(weight.begin() + i);
                    corners.erase(corners.begin() + i);
                }
            }
            if (share >= 1 || corners.size() == 1) {
                break;
            }
        }
        nearest.setZero();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            nearest += weight[i] * (q.col(corners[i]) - at);
        }
    }
    const double distance = nearest.norm();
    return distance < 1e-9 ? 0 : distance;
}

}  // namespace underbody::tables
