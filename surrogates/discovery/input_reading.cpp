#include "surrogates/discovery/input_reading.h"

#include <algorithm>
#include <optional>

#include "core/text.h"

namespace underbody::discovery {

namespace {

// In -2 log likelihood; set on late inputs of heave (LateInput tests), the same for coupled motions.
constexpr double reading_gain = 40;  ///< by which another reading must be likelier than the inputs as logged
constexpr double said_as_gain = 60;  ///< by which it may be worse where a gain with a name says the same
constexpr double effect_gain = 10;   ///< by which an effect beside must be likelier than before the logs were mended

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

InputReading better_input(const InputSearch& search) {
    InputReading best;
    double least = search.as_logged - reading_gain;
    const auto attempt = [&](const InputReading& reading) {
        if (reading.early < 0 || reading.early > search.longest) {
            return;
        }
        const double own = search.cost(reading);
        if (own < least) {
            least = own;
            best = reading;
        }
    };
    for (const double seconds : {0.02, 0.04, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0}) {
        attempt({seconds});
    }
    // From the best of these half-way toward its neighbours and on: they lie up to twice as far apart.
    for (double step = std::max(0.02, best.early / 4); step > 0.002 && best.early > 0; step /= 2) {
        const double middle = best.early;
        attempt({middle - step});
        attempt({middle + step});
    }
    if (best.early == 0 && search.gain) {
        least += said_as_gain;  // the same said with a name; the slip is the likelier story
    }
    for (const std::string& column : search.columns) {
        for (const double times : {1e-3, 1e3, -1.0}) {
            attempt({0, times, column});
        }
    }
    return best;
}

std::string mended_text(const InputReading& reading, const std::vector<std::string>& columns) {
    return reading.clock() ? (columns.size() == 1 ? columns.front() : "the recorded inputs") + " " +
                                 core::format_number(reading.early, 2) + " s earlier"
                           : reading.column + " times " + core::format_number(reading.factor, 4);
}

std::string mended_warning(const InputReading& reading, const std::vector<std::string>& columns) {
    if (!reading.clock()) {
        return "the motion fits an " + reading.column + " " + core::format_number(reading.factor, 4) +
               " times the recorded one: " +
               (reading.factor < 0 ? reading.column == "input_force" ? "its sign is turned round (up is positive)"
                                                                     : "its sign is turned round"
                                   : "its unit is wrong by a thousand") +
               "; it was used so";
    }
    const bool one = columns.size() == 1;
    return "the recorded input comes about " + core::format_number(reading.early, 2) +
           " s after the motion that it makes: the clocks of " + (one ? columns.front() : "the inputs") + " and " +
           (one && columns.front() == "input_force" ? "gap" : "the readings") +
           " differ, or the vehicle has a law that leads as much; the input was moved forward by that much";
}

}  // namespace underbody::discovery
