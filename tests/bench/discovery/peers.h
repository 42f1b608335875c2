// What others would do with the same static data: sparse regression with thresholds, a polynomial residual, a
// Gaussian-process discrepancy.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::bench {

struct PeerAnswer {
    std::string verdict;             ///< none, effect, unknown
    std::vector<std::string> names;  ///< of the effects kept; empty where the method has no names
    std::vector<std::string> depends_on;
    std::map<std::string, double> rmse;  ///< on the test data, by measured quantity
};

/// Peers are told the true noise of each quantity (`sigma`), which discover() has to find out.
using Noise = std::map<std::string, double>;

/// SINDy's sequentially thresholded least squares (Brunton, Proctor and Kutz 2016) on the residual, over a library of
/// what each effect of the catalogue does when it is small; threshold and ridge by the Bayesian information criterion.
PeerAnswer sparse_regression(const dynamics::Model& model, const dynamics::Measurements& train,
                             const dynamics::Measurements& test, const Noise& sigma);

/// All monomials of the varying channels up to a degree of 0 to 3, by the same criterion; no names.
PeerAnswer polynomial_residual(const dynamics::Model& model, const dynamics::Measurements& train,
                               const dynamics::Measurements& test, const Noise& sigma);

/// Gaussian-process discrepancy (Kennedy and O'Hagan 2001): squared-exponential kernel, one length a channel, marginal
/// likelihood; something is missing when twice its log exceeds that of noise alone by the criterion's price of the
/// hyperparameters.
PeerAnswer gaussian_process_discrepancy(const dynamics::Model& model, const dynamics::Measurements& train,
                                        const dynamics::Measurements& test, const Noise& sigma);

}  // namespace underbody::bench
