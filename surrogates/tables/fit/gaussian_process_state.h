// What a GaussianProcess points to. For the files of this room only.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "surrogates/tables/fit/gaussian_process.h"

namespace underbody::tables {

struct GaussianProcess::State {
    GpData data;
    Kernel kernel = Kernel::matern52;
    GpParameters parameters;
    Eigen::ArrayXXd x;  ///< [point, axis] of the data
    Eigen::LLT<Eigen::MatrixXd> factor;
    std::vector<double> weights;
    std::vector<double> coefficients;
    double log_likelihood = 0;
};

}  // namespace underbody::tables
