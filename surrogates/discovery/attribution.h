// From fitted hypotheses to a verdict with probabilities: the part that both kinds of data share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

/// Constants that the bench sets (tests/bench/discovery); they are the same for every data set of a kind.
struct Calibration {
    double gate = 0.01;        ///< the gate opens below this chance
    double form_share = 0.01;  ///< share of what is explained that a law of another form may miss: widens probabilities
    double unknown_share =
        0.15;                  ///< share of the structure that the best named effect may leave before it is "unknown"
    double unknown_p = 0.002;  ///< and the chance below which what is left is real
    double pair_share = 0.05;  ///< least share of the explained part that a second effect must add
    double pair_gain = 25;     ///< and its least gain in -2 log likelihood
    std::string origin;        ///< where the constants came from
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
double structure_left(const SmoothFit& rest, double explained);

/// The hypothesis of least score among those with at most `effects` names.
std::size_t best_hypothesis(const std::vector<FittedHypothesis>& hypotheses, std::size_t effects);

}  // namespace underbody::discovery
