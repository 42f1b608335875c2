// Rules that hold whatever was fitted: what a verdict may say is decided on data that no number was fitted to.
#pragma once

#include <cstddef>
#include <vector>

#include "surrogates/discovery/attribution.h"

namespace underbody::discovery {

/// Squared errors of one model, block by block of neighbouring held-out readings.
struct BlockSquares {
    std::vector<double> square;    ///< sum of squares of each block
    std::vector<double> count;     ///< readings of each block
    std::vector<double> errors{};  ///< reading by reading, in order; empty: not kept
    [[nodiscard]] double rmse() const;
};

/// Fall of the error from one model to another on the same blocks.
struct PairedFall {
    double mean = 0;
    double low = 0;  ///< of the interval by Student's t over the blocks' differences
    double high = 0;
    std::size_t blocks = 0;
    [[nodiscard]] bool falls() const { return low > 0; }
    [[nodiscard]] bool rises() const { return high < 0; }
};

/// Fall of the root mean square of a block: roots, since a few blocks in which both are far off would hide the rest.
/// `tail` is the chance beyond each end of the interval. Few blocks (short runs) have next to no interval of Student:
/// there the readings decide as well, as if all their errors were one. With d the difference of the two models and e
/// what the second leaves, the square error falls by the sum of d^2 + 2 d e; d^2 is no chance, and 2 d e is all taken
/// to go one way. Errors that fall to about a third do so beyond that interval, lesser falls do not. Without errors
/// fewer than three blocks have no interval, and nothing falls.
PairedFall paired_fall(const BlockSquares& before, const BlockSquares& after, double tail);

/// Errors of one model, reading by reading, in blocks of readings whose errors may hang together.
struct BlockErrors {
    std::vector<std::vector<double>> blocks;
    [[nodiscard]] double sum_of_squares() const;
    [[nodiscard]] std::size_t count() const;
    [[nodiscard]] double rmse() const;
};
/// The same of blocks that kept their errors; `in`: the unit that they shall be in. Empty where none were kept.
BlockErrors errors_of(const BlockSquares& squares, double in);

/// Fall of the summed square error. With d the difference of the two models and e what the second leaves it is the sum
/// of d^2 + 2 d e: d^2 is no chance, so that an effect which few blocks show counts in full, and the sums of 2 d e over
/// the blocks are. Their interval is Student's t; of fewer than three blocks the readings' errors count as independent.
PairedFall paired_fall(const BlockErrors& before, const BlockErrors& after, double tail);

/// As many of its own errors as the largest amplitude of noise at the frequencies of a scan exceeds as seldom as one
/// number of no scan exceeds `sigmas`: an amplitude of noise at one frequency is beyond z with the chance exp(-z^2/2)
/// (Rayleigh 1880).
double sigmas_after_scan(double sigmas);

/// True where each name of the hypothesis has a strength that lies more than `sigmas` (after a scan
/// sigmas_after_scan()) of its own errors from where it does nothing, or (static sets) numbers that lie as unlikely far
/// from there together.
bool differs_from_neutral(const FittedHypothesis& fitted, double sigmas);

/// Index of the least score among the hypotheses of so many names that differ from neutral; their number where none
/// does.
std::size_t best_finding(const std::vector<FittedHypothesis>& found, std::size_t names, double sigmas);

/// Lowers all probabilities of names (and of `unknown`) so that none is above `most`; what they lose goes to "none".
void cap_probabilities(Attribution& attribution, double most);

/// Lowers the probabilities of names so that none is above `most`; what they lose goes to `unknown` as far as `most`,
/// the rest to "none". Of readings that hold more than noise would, a name that nothing confirms is no sign that
/// nothing is missing.
void hold_names_down(Attribution& attribution, double most);

/// Gives `part` of what the names have to `unknown`.
void give_to_unknown(Attribution& attribution, double part);

/// Something is missing for certain: nothing is left to "none", `unknown` gets at least that much, names the rest.
void rule_out_none(Attribution& attribution, double unknown);

/// "None" gets `none`; names and `unknown` share the rest as before.
void give_to_none(Attribution& attribution, double none);

}  // namespace underbody::discovery
