// Curves drawn whole from the joint errors of the forces at their nodes.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "core/random.h"
#include "surrogates/tables/search/curve_forces.h"

namespace underbody::tables {

namespace {

using Eigen::MatrixXd;

constexpr Eigen::Index draws = 64, most_nodes = 512;

/// Standard normal numbers [dimension, draw], the same for every design, so that an error is a smooth function of it.
/// The first dimensions have mean 0, variance 1 and no correlation over the draws exactly: the error of what is linear
/// in the forces is exact.
const MatrixXd& normals() {
    static const MatrixXd numbers = [] {
        constexpr Eigen::Index uncorrelated = 40;
        core::Random random(2718);
        MatrixXd z(2 * most_nodes, draws);
        for (Eigen::Index i = 0; i < 2 * most_nodes; ++i) {
            for (Eigen::Index d = 0; d < draws; ++d) {
                z(i, d) = random.normal();
            }
            z.row(i).array() -= z.row(i).mean();
            for (Eigen::Index k = 0; k < std::min(i, uncorrelated); ++k) {
                z.row(i) -= z.row(i).dot(z.row(k)) / static_cast<double>(draws) * z.row(k);
            }
            z.row(i) *= std::sqrt(static_cast<double>(draws) / z.row(i).squaredNorm());
        }
        return z;
    }();
    return numbers;
}

/// What draws add to the values at the nodes, [node, draw], made from rows of normals() from `first` on.
MatrixXd deviations(const std::vector<double>& covariance, const std::vector<std::size_t>& order, Eigen::Index first) {
    const auto n = static_cast<Eigen::Index>(order.size());
    MatrixXd c(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j) {
            c(i, j) =
                covariance[order[static_cast<std::size_t>(i)] * order.size() + order[static_cast<std::size_t>(j)]];
        }
    }
    const double size = std::max(c.diagonal().mean(), 1e-300);
    Eigen::LLT<MatrixXd> factor;
    for (double jitter = 1e-10;; jitter *= 100) {  // a smooth curve has fewer degrees of freedom than nodes
        factor.compute(c + jitter * size * MatrixXd::Identity(n, n));
        if (factor.info() == Eigen::Success || jitter > 1) {
            break;
        }
    }
    const MatrixXd ordered = factor.matrixL() * normals().middleRows(first, n);
    MatrixXd result(n, draws);
    for (Eigen::Index i = 0; i < n; ++i) {
        result.row(static_cast<Eigen::Index>(order[static_cast<std::size_t>(i)])) = ordered.row(i);
    }
    return result;
}

/// 0 at the ends, 1 in the middle, then quarters, ...
int fineness(std::size_t i, std::size_t count) {
    int level = 0;
    for (std::size_t times = i; count > 1 && times % (count - 1) != 0 && level < 8; times *= 2) {
        ++level;
    }
    return level;
}

/// The nodes from coarse to fine: the first few already carry most of the error of a smooth curve.
std::vector<std::size_t> coarse_to_fine(std::size_t gaps, std::size_t pitches) {
    std::vector<std::size_t> order(gaps * pitches);
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto level = [&](std::size_t i) { return std::max(fineness(i % gaps, gaps), fineness(i / gaps, pitches)); };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return level(a) < level(b); });
    return order;
}

std::vector<double> one_draw(const MatrixXd& of, Eigen::Index i) {
    return {of.col(i).data(), of.col(i).data() + of.rows()};
}

std::vector<double> moved_by(std::vector<double> a, const std::vector<double>& b) {
    std::transform(a.begin(), a.end(), b.begin(), a.begin(), std::plus<>());
    return a;
}

}  // namespace

double curve_sigma(const CurveAsked& asked, const CurveForces& forces, const CurveErrors& errors) {
    const std::vector<std::size_t> order = coarse_to_fine(forces.gaps.size(), forces.pitches.size());
    if (order.size() > most_nodes) {
        throw std::invalid_argument("a curve of too many nodes");
    }
    const double value = curve_number(asked, forces).value;
    const auto drawn = [&](const std::vector<double>& covariance, Eigen::Index first) {
        return covariance.empty() ? MatrixXd(0, draws) : deviations(covariance, order, first);
    };
    const MatrixXd lift = drawn(errors.lift, 0), moment = drawn(errors.moment, lift.rows());
    CurveForces moved = forces;
    double square = 0;
    for (Eigen::Index d = 0; d < draws; ++d) {
        if (lift.rows() > 0) {
            moved.lift = moved_by(forces.lift, one_draw(lift, d));
        }
        if (moment.rows() > 0) {
            moved.moment = moved_by(forces.moment, one_draw(moment, d));
        }
        square += std::pow(curve_number(asked, moved).value - value, 2) / static_cast<double>(draws);
    }
    return std::sqrt(square);
}

}  // namespace underbody::tables
