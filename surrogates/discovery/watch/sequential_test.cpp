#include "surrogates/discovery/watch/sequential_test.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "core/normal.h"

namespace underbody::discovery {

namespace {

constexpr double overshoot = 1.166;  ///< of the boundary by a sum of normal steps, both sides (Siegmund 1985)
constexpr double least_tail = 1e-15;

constexpr double first_steps = 8;
constexpr double largest = 5;  ///< far below every threshold of use: a single wild step is no change that lasts

double bounded(double u) { return std::clamp(u, -largest, largest); }

/// Standard normal number with the same tail as Student's t of so many degrees of freedom.
double normal_of_t(double t, double degrees) {
    if (degrees > 100) {
        return t * (1 - (1 + t * t) / (4 * degrees));
    }
    const boost::math::students_t student(degrees);
    const double tail = boost::math::cdf(boost::math::complement(student, std::abs(t)));
    const double size = tail > least_tail ? core::normal_quantile(tail) : largest;
    return std::copysign(size, t);
}

}  // namespace

double cusum_threshold(double reference, double mean_steps) {
    const auto steps = [&](double b) {
        const double x = 2 * reference * b;
        return (std::expm1(x) - x) / (2 * reference * reference);
    };
    double low = 0, high = 1;
    while (steps(high) < mean_steps) {
        high *= 2;
    }
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (steps(middle) < mean_steps ? low : high) = middle;
    }
    return std::max(0.0, high - overshoot);
}

double SelfStartingScore::normal(double score) {
    const double before = squares_, count = count_;
    // A wild score would widen the scale for ever.
    const double bound = count < first_steps ? INFINITY : largest * std::sqrt(before / count);
    squares_ += std::min(score * score, bound * bound);
    count_ += 1;
    return count < first_steps || !(before > 0) ? 0 : bounded(normal_of_t(score / std::sqrt(before / count), count));
}

double SelfStartingLevel::normal(double value) {
    const double before = count_, mean = mean_, sigma = before > 1 ? std::sqrt(squares_ / (before - 1)) : 0;
    // as above
    const double bound = before < first_steps ? INFINITY : largest * sigma;
    const double away = std::clamp(value - mean, -bound, bound);
    count_ += 1;
    mean_ += away / count_;
    squares_ += away * away * before / count_;
    if (before < first_steps || !(sigma > 0)) {
        return 0;
    }
    return bounded(normal_of_t((value - mean) / sigma * std::sqrt(before / (before + 1)), before - 1));
}

TwoSidedCusum::TwoSidedCusum(double mean_steps, bool upper_only, double allowance)
    : upper_only_(upper_only), allowance_(allowance) {
    for (std::size_t i = 0; i < references.size(); ++i) {
        thresholds_[i] = cusum_threshold(references[i], mean_steps);
    }
}

bool TwoSidedCusum::take(double u) {
    bool passed = false;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        const double signed_u = i % 2 == 0 ? u : -u;
        Side& side = sides_[i];
        side.sum = std::max(0.0, side.sum + signed_u - references[i / 2] - allowance_);
        side.since = side.sum > 0 ? side.since + 1 : 0;
        passed = passed || (side.sum > thresholds_[i / 2] && (i % 2 == 0 || !upper_only_));
    }
    return passed;
}

void TwoSidedCusum::reset() { sides_ = {}; }

std::size_t TwoSidedCusum::nearest() const {
    std::size_t best = 0;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        if ((i % 2 == 0 || !upper_only_) &&
            sides_[i].sum / thresholds_[i / 2] > sides_[best].sum / thresholds_[best / 2]) {
            best = i;
        }
    }
    return best;
}

double TwoSidedCusum::share() const { return sides_[nearest()].sum / thresholds_[nearest() / 2]; }
int TwoSidedCusum::side() const { return nearest() % 2 == 0 ? 1 : -1; }
std::size_t TwoSidedCusum::steps_since() const { return sides_[nearest()].since; }

}  // namespace underbody::discovery
