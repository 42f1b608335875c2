// From fitted hypotheses to a verdict with probabilities: the part that both kinds of data share.
#pragma once

#include <string>
#include <vector>

#include "surrogates/discovery/calibration.h"
#include "surrogates/discovery/hypothesis.h"

namespace underbody::discovery {

/// A smooth correction over some variables, without a law.
struct SmoothFit {
    std::vector<std::string> variables;
    double gain = 0;                  ///< fall of -2 log likelihood
    double degrees = 0;               ///< effective degrees of freedom
    double p = 1;                     ///< chance of such a gain from noise, from simulation where it was made
    std::vector<double> gain_of_row;  ///< of each reading; static sets alone
};

struct Attribution {
    std::string verdict;     ///< none, effect, unknown
    std::size_t chosen = 0;  ///< index into the hypotheses given (verdict "effect"; best named otherwise)
    struct Share {
        std::size_t hypothesis = 0;
        double probability = 0;
    };
    std::vector<Share> shares;  ///< one per distinct set of names, best first
    double unknown_probability = 0;
    double none_probability = 0;
};

/// `hypotheses` fitted to the same data; `gate_p` from simulating the model as declared; `rest` is the best smooth
/// correction on top of the best named hypothesis.
Attribution attribute(const std::vector<FittedHypothesis>& hypotheses, double gate_p, const SmoothFit& rest,
                      const Calibration& calibration);

/// Share of all structure that a smooth function still finds (`rest`) beside what explains `explained`.
constexpr double least_gain = 1e-12;  ///< in -2 log likelihood: nothing is explained
double structure_left(const SmoothFit& rest, double explained);

/// The hypothesis of least score among those with at most `effects` names.
std::size_t best_hypothesis(const std::vector<FittedHypothesis>& hypotheses, std::size_t effects);
/// The same of the hypotheses with these indices.
std::size_t best_hypothesis(const std::vector<FittedHypothesis>& hypotheses, std::size_t effects,
                            const std::vector<std::size_t>& among);

}  // namespace underbody::discovery
