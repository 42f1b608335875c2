#include "surrogates/discovery/guards.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

#include "core/no_limit.h"
#include "core/normal.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/model/effect.h"

namespace underbody::discovery {

double BlockSquares::rmse() const {
    const double readings = std::accumulate(count.begin(), count.end(), 0.0);
    return readings > 0 ? std::sqrt(std::accumulate(square.begin(), square.end(), 0.0) / readings) : 0;
}

namespace {

constexpr std::size_t few_blocks = 6;  ///< below, the readings decide as well: t of three is 4.3

/// Lower end of the fall of the root mean square over all readings, their errors taken for one: no two of them are
/// independent.
double least_fall_of_readings(const BlockSquares& before, const BlockSquares& after, double tail) {
    double fall = 0, chance = 0, first = 0, left = 0;
    for (std::size_t i = 0; i < before.errors.size(); ++i) {
        const double e = after.errors[i];
        const double d = before.errors[i] - e;
        fall += d * (d + 2 * e);
        chance += std::abs(2 * d * e);
        first += before.errors[i] * before.errors[i];
        left += e * e;
    }
    const double times = core::normal_quantile(tail);
    // of squares to roots
    const double scale = std::sqrt(static_cast<double>(before.errors.size())) * (std::sqrt(first) + std::sqrt(left));
    return scale > 0 ? (fall - times * chance) / scale : 0;
}

/// What the readings say goes into the interval of few blocks.
PairedFall with_readings(PairedFall blocks, const BlockSquares& before, const BlockSquares& after, double tail) {
    if (blocks.blocks < few_blocks && before.errors.size() > 1 && before.errors.size() == after.errors.size()) {
        blocks.low = std::max(blocks.low, least_fall_of_readings(before, after, tail));
        blocks.high = std::min(blocks.high, -least_fall_of_readings(after, before, tail));
    }
    return blocks;
}

}  // namespace

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
        result.low = -core::no_limit;
        result.high = core::no_limit;
        return with_readings(result, before, after, tail);
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
    return with_readings(result, before, after, tail);
}

BlockErrors errors_of(const BlockSquares& squares, double in) {
    BlockErrors errors;
    std::size_t next = 0;
    for (const double count : squares.count) {
        const std::size_t end = std::min(squares.errors.size(), next + static_cast<std::size_t>(std::lround(count)));
        std::vector<double>& block = errors.blocks.emplace_back();
        for (; next < end; ++next) {
            block.push_back(squares.errors[next] / in);
        }
    }
    return errors;
}

std::size_t BlockErrors::count() const {
    std::size_t sum = 0;
    for (const std::vector<double>& block : blocks) {
        sum += block.size();
    }
    return sum;
}

double BlockErrors::sum_of_squares() const {
    double sum = 0;
    for (const std::vector<double>& block : blocks) {
        sum += discovery::sum_of_squares(block);
    }
    return sum;
}

double BlockErrors::rmse() const {
    return count() > 0 ? std::sqrt(sum_of_squares() / static_cast<double>(count())) : 0;
}

PairedFall paired_fall(const BlockErrors& before, const BlockErrors& after, double tail) {
    PairedFall result;
    double fall = 0, by_blocks = 0, by_readings = 0;
    for (std::size_t b = 0; b < before.blocks.size(); ++b) {
        double chance = 0;
        for (std::size_t i = 0; i < before.blocks[b].size(); ++i) {
            const double left = after.blocks[b][i];
            const double difference = before.blocks[b][i] - left;
            fall += difference * (difference + 2 * left);
            chance += 2 * difference * left;
            by_readings += std::pow(2 * difference * left, 2);
        }
        by_blocks += chance * chance;
        result.blocks += before.blocks[b].empty() ? 0 : 1;
    }
    const bool few = result.blocks < 3;
    const std::size_t independent = std::max<std::size_t>(few ? before.count() : result.blocks, 2);
    const boost::math::students_t student(static_cast<double>(independent) - 1);
    const double half =
        boost::math::quantile(boost::math::complement(student, tail)) * std::sqrt(few ? by_readings : by_blocks);
    result.mean = result.blocks > 0 ? fall / static_cast<double>(result.blocks) : 0;
    result.low = fall - half;
    result.high = fall + half;
    return result;
}

namespace {

/// Each number of an effect of static sets acts without the others. Where they can stand in for each other (dead zone
/// and exponent of a pump curve) none is sure alone and all are sure together: so their common error decides.
bool differ_together(const FittedHypothesis& fitted, const std::string& name, double sigmas) {
    const Hypothesis& h = fitted.hypothesis;
    const std::size_t count = fitted.fit.parameters.size();
    if (dynamics::effect(name).info().seen_in != dynamics::SeenIn::static_set ||
        fitted.fit.covariance.size() != count * count) {
        return false;
    }
    std::vector<std::size_t> own;
    for (std::size_t j = 0; j < h.slots.size(); ++j) {
        if (h.uses[h.slots[j].use].name == name && std::isfinite(fitted.fit.sigma[j]) && fitted.fit.sigma[j] > 0) {
            own.push_back(j);
        }
    }
    if (own.size() < 2) {
        return false;
    }
    const auto n = static_cast<Eigen::Index>(own.size());
    Eigen::MatrixXd together(n, n);  // in their own errors
    Eigen::VectorXd away(n);
    for (Eigen::Index a = 0; a < n; ++a) {
        const std::size_t i = own[static_cast<std::size_t>(a)];
        away(a) = (fitted.fit.parameters[i] - h.uses[h.slots[i].use].values[h.slots[i].value]) / fitted.fit.sigma[i];
        for (Eigen::Index b = 0; b < n; ++b) {
            const std::size_t j = own[static_cast<std::size_t>(b)];
            together(a, b) = fitted.fit.covariance[i * count + j] / (fitted.fit.sigma[i] * fitted.fit.sigma[j]);
        }
    }
    const double square = away.dot(together.ldlt().solve(away));
    return chi_squared_tail(std::max(square, 0.0), static_cast<double>(n)) < std::erfc(sigmas / std::sqrt(2.0));
}

}  // namespace

double sigmas_after_scan(double sigmas) {
    return std::sqrt(2 * std::log(frequencies_tried / std::erfc(sigmas / std::sqrt(2.0))));
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
            const bool scanned = dynamics::effect(use.name).info().search.scanned;
            if (away > (scanned ? sigmas_after_scan(sigmas) : sigmas) * fitted.fit.sigma[j]) {
                return true;
            }
        }
        return unit.empty() || differ_together(fitted, name, sigmas);
    });
}

std::size_t best_finding(const std::vector<FittedHypothesis>& found, std::size_t names, double sigmas) {
    std::size_t best = found.size();
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (differs_from_neutral(found[k], sigmas) && found[k].hypothesis.names.size() == names &&
            (best == found.size() || found[k].score() < found[best].score())) {
            best = k;
        }
    }
    return best;
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

void hold_names_down(Attribution& attribution, double most) {
    double largest = 0;
    for (const Attribution::Share& share : attribution.shares) {
        largest = std::max(largest, share.probability);
    }
    const double factor = largest > most ? most / largest : 1;
    for (Attribution::Share& share : attribution.shares) {
        attribution.unknown_probability += (1 - factor) * share.probability;
        share.probability *= factor;
    }
    const double beyond = std::max(0.0, attribution.unknown_probability - most);
    attribution.unknown_probability -= beyond;
    attribution.none_probability += beyond;
}

void give_to_unknown(Attribution& attribution, double part) {
    for (Attribution::Share& share : attribution.shares) {
        attribution.unknown_probability += part * share.probability;
        share.probability *= 1 - part;
    }
}

void rule_out_none(Attribution& attribution, double unknown) {
    attribution.unknown_probability = std::max(attribution.unknown_probability, unknown);
    attribution.none_probability = 0;
    double names = 0;
    for (const Attribution::Share& share : attribution.shares) {
        names += share.probability;
    }
    for (Attribution::Share& share : attribution.shares) {
        share.probability *= names > 0 ? std::min(1.0, (1 - attribution.unknown_probability) / names) : 1;
    }
}

void give_to_none(Attribution& attribution, double none) {
    double sum = attribution.unknown_probability;
    for (const Attribution::Share& share : attribution.shares) {
        sum += share.probability;
    }
    const double factor = sum > 0 ? (1 - none) / sum : 0;
    attribution.unknown_probability *= factor;
    for (Attribution::Share& share : attribution.shares) {
        share.probability *= factor;
    }
    attribution.none_probability = none;
}

}  // namespace underbody::discovery
