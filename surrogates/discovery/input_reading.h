// A recorded input that comes late, or that is turned round or a thousand times off: a matter of the record, no effect.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "surrogates/discovery/hypothesis.h"
#include "surrogates/dynamics/simulate/input_as_logged.h"

namespace underbody::discovery {

using InputReading = dynamics::InputAsLogged;
using dynamics::better_input;
using dynamics::InputSearch;
using dynamics::mended_text;

/// The effects that explain most alone, of the first `singles`, and that no other reading of the input could make up
/// for: beside one of them a wrong clock or sign of the input hides, since the effect explains more than it does.
std::vector<std::size_t> beside_the_input(const std::vector<FittedHypothesis>& fitted, std::size_t singles,
                                          const dynamics::Model& model);

/// What a loop makes of the logs as they are read at the moment, in -2 log likelihood.
struct CostsAsRead {
    std::function<double()> declared;           ///< the model as declared, with the noise that serves it
    std::function<double(std::size_t)> beside;  ///< an effect with the numbers that it had, and their price
    std::function<double(std::size_t)> before;  ///< the same with the inputs as logged
    std::function<double(std::size_t)> again;   ///< its score, fitted again
};
/// The likeliest explanation, alone or with one of `beside`.
double least_cost(const std::vector<std::size_t>& beside, const CostsAsRead& costs);

/// What is said of inputs that are read anew: why, and what was done.
std::string mended_warning(const InputReading& reading, const std::vector<std::string>& columns);

}  // namespace underbody::discovery
