#include "surrogates/tables/fit/hull.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace underbody::tables {

namespace {

bool logarithmic(const TableAxis& axis) { return axis.name == "gap" && axis.lower > 0 && axis.upper >= 4 * axis.lower; }

}  // namespace

Hull::Hull(const std::vector<TableAxis>& axes, const std::vector<std::vector<double>>& points)
    : axes_(axes), made_of_(points) {
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
    return logarithmic(axis) ? std::log(x / axis.lower) / std::log(axis.upper / axis.lower)
                             : (x - axis.lower) / (axis.upper - axis.lower);
}

namespace {

/// A point of a hull as a mean of a few of its points: their columns, and their weights.
struct MeanOfCorners {
    std::vector<Eigen::Index> corners;
    std::vector<double> weight;
};

/// Toward the nearest point to the origin of the plane through the corners, until a corner's weight vanishes, which is
/// then dropped; again until the nearest point itself is a mean of them.
void move_to_nearest(MeanOfCorners& mean, const Eigen::MatrixXd& q) {
    using Eigen::Index;
    auto& [corners, weight] = mean;
    while (true) {
        const auto m = static_cast<Index>(corners.size());
        Eigen::MatrixXd system = Eigen::MatrixXd::Ones(m + 1, m + 1);
        system(m, m) = 0;
        for (Index i = 0; i < m; ++i) {
            for (Index j = 0; j < m; ++j) {
                system(i, j) =
                    q.col(corners[static_cast<std::size_t>(i)]).dot(q.col(corners[static_cast<std::size_t>(j)]));
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
}

/// Of the hull of the columns. The nearest point is a mean of a few of them, found by adding the column furthest along
/// the way to the origin (Wolfe 1976).
double distance_from_origin(const Eigen::MatrixXd& q) {
    Eigen::Index first = 0;
    q.colwise().squaredNorm().minCoeff(&first);
    MeanOfCorners mean{{first}, {1}};
    Eigen::VectorXd nearest = q.col(first);
    for (int outer = 0; outer < 100 && nearest.squaredNorm() > 1e-20; ++outer) {
        Eigen::Index next = 0;
        const double lowest = (q.transpose() * nearest).minCoeff(&next);
        if (lowest >= nearest.squaredNorm() - 1e-12 ||
            std::find(mean.corners.begin(), mean.corners.end(), next) != mean.corners.end()) {
            break;
        }
        mean.corners.push_back(next);
        mean.weight.push_back(0);
        move_to_nearest(mean, q);
        nearest.setZero();
        for (std::size_t i = 0; i < mean.corners.size(); ++i) {
            nearest += mean.weight[i] * q.col(mean.corners[i]);
        }
    }
    return nearest.norm();
}

}  // namespace

double Hull::distance(const double* low, const double* high) const {
    using Eigen::Index;
    const auto n = static_cast<Index>(axes_.size());
    const Eigen::Map<const Eigen::MatrixXd> hull(points_.data(), n, static_cast<Index>(points_.size()) / n);
    // Differences between the corners of the box and the points: the hull of these is as far from 0 as the box is from
    // the hull.
    Index corners_of_box = 1;
    for (Index k = 0; k < n; ++k) {
        corners_of_box *= low[k] < high[k] ? 2 : 1;
    }
    Eigen::MatrixXd q(n, hull.cols() * corners_of_box);
    for (Index corner = 0; corner < corners_of_box; ++corner) {
        Eigen::VectorXd at(n);
        Index bits = corner;
        for (Index k = 0; k < n; ++k) {
            const bool wide = low[k] < high[k];
            at(k) = coordinate(static_cast<std::size_t>(k), wide && (bits & 1) != 0 ? high[k] : low[k]);
            bits /= wide ? 2 : 1;
        }
        q.middleCols(corner * hull.cols(), hull.cols()) = hull.colwise() - at;
    }
    const double distance = distance_from_origin(q);
    return distance < 1e-9 ? 0 : distance;
}

const Support& Hull::support() const {
    std::call_once(made_->once, [this] {
        constexpr std::size_t cells_of[] = {64, 48, 16, 8};  // an axis, by the number of axes
        const std::size_t cells = cells_of[axes_.size() - 1];
        std::vector<std::vector<double>> lines;
        for (const TableAxis& axis : axes_) {
            const bool log = logarithmic(axis);
            std::vector<double> x{axis.lower};
            for (std::size_t i = 1; i < cells; ++i) {
                const double share = static_cast<double>(i) / static_cast<double>(cells);
                x.push_back(log ? axis.lower * std::pow(axis.upper / axis.lower, share)
                                : axis.lower + share * (axis.upper - axis.lower));
            }
            x.push_back(axis.upper);
            lines.push_back(std::move(x));
        }
        made_->support = Support(std::move(lines),
                                 [this](const double* low, const double* high) { return distance(low, high) == 0; });
    });
    return made_->support;
}

}  // namespace underbody::tables
