#include "surrogates/discovery/input_reading.h"

#include <algorithm>
#include <optional>

namespace underbody::discovery {

namespace {

/// In -2 log likelihood, by which an effect beside must be likelier than before the logs were mended. Set on late
/// inputs of heave (LateInput tests), the same for coupled motions.
constexpr double effect_gain = 10;

}  // namespace

std::vector<std::size_t> beside_the_input(const std::vector<FittedHypothesis>& fitted, std::size_t singles,
                                          const dynamics::Model& model) {
    constexpr std::size_t most = 3;
    std::vector<std::size_t> list;
    for (std::size_t i = 0; i < singles; ++i) {
        const Touch touch = touch_of(fitted[i].hypothesis, model);
        if (!touch.time && !touch.gain) {
            list.push_back(i);
        }
    }
    std::sort(list.begin(), list.end(),
              [&](std::size_t a, std::size_t b) { return fitted[a].score() < fitted[b].score(); });
    list.resize(std::min(most, list.size()));
    return list;
}

double least_cost(const std::vector<std::size_t>& beside, const CostsAsRead& costs) {
    const double cost = costs.declared();
    std::optional<std::size_t> with;
    double least_with = 1e300;
    for (const std::size_t i : beside) {
        // with the numbers of the input as it was recorded: a fit comes once the clock is nearly right
        const double own = costs.beside(i);
        if (own < least_with) {
            least_with = own;
            with = i;
        }
    }
    if (with && least_with < cost && least_with < costs.before(*with) - effect_gain) {
        return std::min(cost, costs.again(*with));
    }
    return cost;
}

std::string mended_warning(const InputReading& reading, const std::vector<std::string>& columns) {
    return dynamics::doubt_text(reading, columns) +
           (reading.clock() ? "; the input was moved forward by that much" : "; it was used so");
}

}  // namespace underbody::discovery
