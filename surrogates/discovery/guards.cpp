#include "surrogates/discovery/guards.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

#include "surrogates/dynamics/model/effect.h"

namespace underbody::discovery {

double BlockSquares::rmse() const {
    const double readings = std::accumulate(count.begin(), count.end(), 0.0);
    return readings > 0 ? std::sqrt(std::accumulate(square.begin(), square.end(), 0.0) / readings) : 0;
}

PairedFall paired_fall(const BlockSquares& before, const BlockSquares& after, double tail) {
    PairedFall result;
    std::vector<double> fall;
    for (std::size_t b = 0; b < before.count.size(); ++b) {
        if (before.count[b] > 0) {
            fall.push_back(std::sqrt(before.square[b] / before.count[b]) -
                           std::sqrt(after.square[b] / before.count[b]));
        }
    }
    result.blocks = fall.size();
    if (fall.empty()) {
        return result;
    }
    const double n = static_cast<double>(fall.size());
    const double middle = std::accumulate(fall.begin(), fall.end(), 0.0) / n;
    result.mean = middle;
    if (fall.size() < 3) {
        result.low = -1e300;
        result.high = 1e300;
        return result;
    }
    double square = 0;
    for (const double one : fall) {
        square += (one - middle) * (one - middle);
    }
    const double t = boost::math::quantile(boost::math::complement(boost::math::students_t(n - 1), tail));
    const double half = t * std::sqrt(square / (n * (n - 1)));
    result.low = middle - half;
    result.high = middle + half;
    if (after.rmse() > before.rmse()) {
        result.low = std::min(result.low, 0.0);  // what most blocks win a few lose again
    }
    return result;
}

bool differs_from_neutral(const FittedHypothesis& fitted, double sigmas) {
    const Hypothesis& h = fitted.hypothesis;
    return std::all_of(h.names.begin(), h.names.end(), [&](const std::string& name) {
        std::string unit;
        for (std::size_t j = 0; j < h.slots.size(); ++j) {
            const dynamics::EffectUse& use = h.uses[h.slots[j].use];
            const dynamics::EffectParameter& info = dynamics::effect(use.name).info().parameters[h.slots[j].value];
            if (use.name != name || info.shape || (!unit.empty() && unit != info.unit)) {
                continue;
            }
            unit = info.unit;  // the first number of an effect is its strength, and so are others of its unit
            const double away = std::abs(fitted.fit.parameters[j] - use.values[h.slots[j].value]);
            if (away > sigmas * fitted.fit.sigma[j]) {
                return true;
            }
        }
        return unit.empty();
    });
}

void cap_probabilities(Attribution& attribution, double most) {
    double largest = attribution.unknown_probability;
    for (const Attribution::Share& share : attribution.shares) {
        largest = std::max(largest, share.probability);
    }
    if (largest > most) {
        const double factor = most / largest;
        double sum = attribution.unknown_probability *= factor;
        for (Attribution::Share& share : attribution.shares) {
            sum += share.probability *= factor;
        }
        attribution.none_probability = std::max(0.0, 1 - sum);
    }
}

}  // namespace underbody::discovery
