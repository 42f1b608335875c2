// Rules that hold whatever was fitted: what a verdict may say is decided on data that no number was fitted to.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "surrogates/discovery/attribution.h"

namespace underbody::discovery {

/// Squared errors of one model, block by block of neighbouring held-out readings.
struct BlockSquares {
    std::vector<double> square;  ///< sum of squares of each block
    std::vector<double> count;   ///< readings of each block
    [[nodiscard]] double rmse() const;
};

/// Fall of the error (root mean square of a block) from one model to another on the same blocks: roots, since a few
/// blocks in which both are far off would hide the rest.
struct PairedFall {
    double mean = 0;
    double low = 0;  ///< of the interval by Student's t over the blocks' differences
    double high = 0;
    std::size_t blocks = 0;
    [[nodiscard]] bool falls() const { return low > 0; }
    [[nodiscard]] bool rises() const { return high < 0; }
};

/// `tail` is the chance beyond each end of the interval. Fewer than three blocks: no interval, nothing falls.
PairedFall paired_fall(const BlockSquares& before, const BlockSquares& after, double tail);

/// True where each name of the hypothesis has a strength that lies more than `sigmas` of its own errors from where it
/// does nothing.
bool differs_from_neutral(const FittedHypothesis& fitted, double sigmas);

/// Lowers all probabilities of names (and of `unknown`) so that none is above `most`; what they lose goes to "none".
void cap_probabilities(Attribution& attribution, double most);

}  // namespace underbody::discovery
