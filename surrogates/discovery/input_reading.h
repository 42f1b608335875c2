// A recorded input that comes late, or that is turned round or a thousand times off: a matter of the record, no effect.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "surrogates/discovery/hypothesis.h"

namespace underbody::discovery {

/// How recorded inputs are read: all of them so much earlier, or one of them times a factor.
struct InputReading {
    double early = 0;  ///< s
    double factor = 1;
    std::string column{};  ///< that the factor is of
    [[nodiscard]] bool as_logged() const { return early == 0 && factor == 1; }
    [[nodiscard]] bool clock() const { return factor == 1; }
};

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

/// What is asked of the recorded inputs.
struct InputSearch {
    std::vector<std::string> columns;
    double as_logged = 0;       ///< cost of the likeliest effect alone, of the same readings as `cost`
    bool gain = false;          ///< it is a gain of an input: the scale of one of `columns` is likelier than that name
    double longest = INFINITY;  ///< s: inputs that are later are not looked for
    std::function<double(const InputReading&)> cost;
};
/// The likeliest reading where it is likelier than the inputs as logged beyond chance; else as logged.
InputReading better_input(const InputSearch& search);

/// "input_force 0.2 s earlier", "input_moment times -1"; `columns`: all that there are.
std::string mended_text(const InputReading& reading, const std::vector<std::string>& columns);
/// The warning that goes with it.
std::string mended_warning(const InputReading& reading, const std::vector<std::string>& columns);

}  // namespace underbody::discovery
