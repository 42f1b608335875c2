// The regressions behind the peers of peers.h, on plain matrices: what both kinds of data share.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace underbody::bench {

/// SINDy's sequentially thresholded least squares (Brunton, Proctor and Kutz 2016): coefficients of the columns of unit
/// length, zero where dropped; threshold and ridge by the Bayesian information criterion. `y` in units of its noise.
Eigen::VectorXd thresholded_least_squares(const Eigen::MatrixXd& unit_columns, const Eigen::VectorXd& y);

struct Polynomial {
    int degree = -1;  ///< -1: nothing beats zero
    Eigen::VectorXd coefficients;
    [[nodiscard]] Eigen::VectorXd at(const Eigen::MatrixXd& x) const;
};
/// Degree of 0 to 3 by the Bayesian information criterion. `y` in units of its noise.
Polynomial fit_polynomial(const Eigen::MatrixXd& x, const Eigen::VectorXd& y);

struct GaussianProcess {
    bool found = false;     ///< twice the log evidence beats that of noise alone by the price of the hyperparameters
    std::vector<double> p;  ///< log amplitude, log lengths
    Eigen::MatrixXd x;
    Eigen::VectorXd weights;
    [[nodiscard]] Eigen::VectorXd at(const Eigen::MatrixXd& there) const;
    /// Whether it changes along a column of `x` (of variance one).
    [[nodiscard]] bool depends_on(std::size_t column) const;
};
/// Squared-exponential kernel, one length a column, by marginal likelihood (Kennedy and O'Hagan 2001 for the use). `y`
/// in units of its noise.
GaussianProcess fit_gaussian_process(const Eigen::MatrixXd& x, const Eigen::VectorXd& y);

}  // namespace underbody::bench
