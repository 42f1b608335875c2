// Bounded nonlinear least squares with a likelihood's log-determinant beside it.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace underbody::discovery {

struct FitParameter {
    std::string name;
    std::string unit;  ///< SI
    double lower = 0;
    double upper = 0;
    double start = 0;
    double typical = 1;  ///< size of a change that matters; sets finite differences and the prior's width
};

/// Fills the whitened residuals for parameters `p` (always the same length) and returns sum log S, the log-determinant
/// that makes residual' residual + sum log S a -2 log likelihood.
using WhitenedResiduals = std::function<double(std::span<const double> p, std::vector<double>& residuals)>;

struct FitOptions {
    int iterations = 12;
    double tolerance = 1e-3;  ///< stop when the cost falls by less
    double ridge = 0;         ///< weight of ((p - start)/typical)^2 in the cost: a weak prior
    bool about_zero = false;  ///< the ridge pulls to zero instead
};

struct Fit {
    std::vector<double> parameters;
    std::vector<double> sigma;       ///< standard deviations from the curvature, infinite where the data say nothing
    std::vector<double> covariance;  ///< row-major
    std::vector<double> residuals;   ///< whitened, at the optimum
    double log_determinant = 0;
    double cost = 0;  ///< -2 log likelihood at the optimum, without the ridge
    bool at_bound = false;
    int evaluations = 0;
};

/// Levenberg-Marquardt with projection onto the bounds, Jacobian by forward differences of `typical` * 1e-3.
/// Deterministic. Throws nothing of its own; a non-finite cost is treated as infinitely bad.
Fit least_squares(const std::vector<FitParameter>& parameters, const WhitenedResiduals& residuals,
                  const FitOptions& options = {});

}  // namespace underbody::discovery
