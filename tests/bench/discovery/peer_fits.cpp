#include "tests/bench/discovery/peer_fits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>

namespace underbody::bench {

namespace {

Eigen::MatrixXd columns_of(const Eigen::MatrixXd& library, const std::vector<Eigen::Index>& kept) {
    Eigen::MatrixXd part(library.rows(), static_cast<Eigen::Index>(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) {
        part.col(static_cast<Eigen::Index>(k)) = library.col(kept[k]);
    }
    return part;
}

/// The columns that stay above the threshold, round after round.
std::vector<Eigen::Index> survivors(const Eigen::MatrixXd& library, const Eigen::VectorXd& y, double threshold,
                                    double ridge) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < library.cols(); ++k) {
        kept.push_back(k);
    }
    for (int round = 0; round < 12 && !kept.empty(); ++round) {
        const Eigen::MatrixXd part = columns_of(library, kept);
        Eigen::MatrixXd normal = part.transpose() * part;
        normal.diagonal().array() += ridge;  // effects of one rig look alike: without it coefficients run away in pairs
        const Eigen::VectorXd c = normal.ldlt().solve(part.transpose() * y);
        std::vector<Eigen::Index> longer;
        for (std::size_t k = 0; k < kept.size(); ++k) {
            if (std::abs(c(static_cast<Eigen::Index>(k))) > threshold) {
                longer.push_back(kept[k]);
            }
        }
        if (longer.size() == kept.size()) {
            break;
        }
        kept = std::move(longer);
    }
    return kept;
}

/// Squared-exponential kernel: p = log amplitude, log lengths.
Eigen::MatrixXd kernel(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const std::vector<double>& p) {
    Eigen::MatrixXd k(a.rows(), b.rows());
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
        for (Eigen::Index j = 0; j < b.rows(); ++j) {
            double square = 0;
            for (Eigen::Index v = 0; v < a.cols(); ++v) {
                square += std::pow((a(i, v) - b(j, v)) * std::exp(-p[static_cast<std::size_t>(v) + 1]), 2);
            }
            k(i, j) = std::exp(2 * p[0] - 0.5 * square);
        }
    }
    return k;
}

double twice_log_evidence(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const std::vector<double>& p) {
    Eigen::MatrixXd k = kernel(x, x, p);
    k.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> factor(k);
    const Eigen::VectorXd z = factor.matrixL().solve(y);
    return -z.squaredNorm() - 2 * factor.matrixLLT().diagonal().array().log().sum();
}

/// All products of the columns of `x` up to a degree.
Eigen::MatrixXd monomials(const Eigen::MatrixXd& x, int degree) {
    std::vector<Eigen::VectorXd> columns;
    const std::function<void(Eigen::Index, int, Eigen::VectorXd)> grow = [&](Eigen::Index from, int left,
                                                                             const Eigen::VectorXd& product) {
        columns.push_back(product);
        for (Eigen::Index k = from; left > 0 && k < x.cols(); ++k) {
            grow(k, left - 1, product.cwiseProduct(x.col(k)));
        }
    };
    grow(0, degree, Eigen::VectorXd::Ones(x.rows()));
    Eigen::MatrixXd matrix(x.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) {
        matrix.col(static_cast<Eigen::Index>(k)) = columns[k];
    }
    return matrix;
}

}  // namespace

Eigen::VectorXd thresholded_least_squares(const Eigen::MatrixXd& library, const Eigen::VectorXd& y) {
    double best = y.squaredNorm();
    Eigen::VectorXd chosen = Eigen::VectorXd::Zero(library.cols());
    for (const double threshold : {2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 14.0, 20.0}) {
        for (const double ridge : {1e-6, 0.05, 0.5}) {
            const std::vector<Eigen::Index> kept = survivors(library, y, threshold, ridge);
            Eigen::VectorXd full = Eigen::VectorXd::Zero(library.cols());
            if (!kept.empty()) {
                const Eigen::VectorXd c =
                    columns_of(library, kept).colPivHouseholderQr().solve(y);  // what is kept, fitted freely
                for (std::size_t k = 0; k < kept.size(); ++k) {
                    full(kept[k]) = c(static_cast<Eigen::Index>(k));
                }
            }
            const double criterion = (y - library * full).squaredNorm() +
                                     static_cast<double>(kept.size()) * std::log(static_cast<double>(y.size()));
            if (criterion < best) {
                best = criterion;
                chosen = full;
            }
        }
    }
    return chosen;
}

Eigen::VectorXd Polynomial::at(const Eigen::MatrixXd& x) const {
    return degree < 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(x.rows()))
                      : Eigen::VectorXd(monomials(x, degree) * coefficients);
}

Polynomial fit_polynomial(const Eigen::MatrixXd& x, const Eigen::VectorXd& y) {
    Polynomial best;
    double least = y.squaredNorm();
    for (int degree = 0; degree <= 3; ++degree) {
        const Eigen::MatrixXd basis = monomials(x, degree);
        if (3 * basis.cols() > basis.rows()) {
            break;
        }
        const Eigen::VectorXd c = basis.colPivHouseholderQr().solve(y);
        const double criterion = (y - basis * c).squaredNorm() +
                                 static_cast<double>(basis.cols()) * std::log(static_cast<double>(basis.rows()));
        if (criterion < least) {
            least = criterion;
            best = {degree, c};
        }
    }
    return best;
}

Eigen::VectorXd GaussianProcess::at(const Eigen::MatrixXd& there) const { return kernel(there, x, p) * weights; }

bool GaussianProcess::depends_on(std::size_t column) const { return p[column + 1] < std::log(5.0); }

GaussianProcess fit_gaussian_process(const Eigen::MatrixXd& x, const Eigen::VectorXd& y) {
    GaussianProcess fit;
    fit.x = x;
    fit.p.assign(static_cast<std::size_t>(x.cols()) + 1, 0.7);
    fit.p[0] = 0;
    double best = twice_log_evidence(x, y, fit.p);
    for (double step = 0.8; step > 0.15; step *= 0.5) {
        bool moved = true;
        for (int round = 0; round < 3 && moved; ++round) {
            moved = false;
            for (std::size_t k = 0; k < fit.p.size(); ++k) {
                for (const double sign : {1.0, -1.0}) {
                    std::vector<double> trial = fit.p;
                    trial[k] = std::clamp(trial[k] + sign * step, -3.0, 4.0);
                    const double value = twice_log_evidence(x, y, trial);
                    if (value > best + 1e-6) {
                        best = value;
                        fit.p = trial;
                        moved = true;
                    }
                }
            }
        }
    }
    fit.found = best + y.squaredNorm() >= static_cast<double>(fit.p.size()) * std::log(static_cast<double>(y.size()));
    if (fit.found) {
        Eigen::MatrixXd k = kernel(x, x, fit.p);
        k.diagonal().array() += 1;
        fit.weights = k.llt().solve(y);
    }
    return fit;
}

}  // namespace underbody::bench
