#include "surrogates/discovery/statistics.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "core/normal.h"
#include "core/random.h"

namespace underbody::discovery {

namespace {

constexpr double beyond = 0.025;      ///< chance beyond each end of an interval of 95 %
constexpr double most_decades = 300;  ///< of a chance that is a number still
constexpr double settled_odds = 20;
constexpr double no_separation = 1e-9;

}  // namespace

double mean(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) {
        sum += value;
    }
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double root_mean_square(std::span<const double> values) {
    return values.empty() ? 0 : std::sqrt(sum_of_squares(values) / static_cast<double>(values.size()));
}

double chi_squared_tail(double x, double dof) {
    if (!(x > 0) || dof <= 0) {
        return 1;
    }
    return boost::math::cdf(boost::math::complement(boost::math::chi_squared(dof), x));
}

double f_tail(double x, double dof_above, double dof_below) {
    if (!(x > 0) || dof_above <= 0 || dof_below <= 0) {
        return 1;
    }
    return boost::math::cdf(boost::math::complement(boost::math::fisher_f(dof_above, dof_below), x));
}

double surprise(double gain, double count) {
    if (count <= 0) {
        return 0;
    }
    const double tail = chi_squared_tail(gain, count);
    return tail > std::pow(10.0, -most_decades) ? -std::log10(tail) : most_decades + gain / 10;
}

double chance_to_settle(double separation) {
    return separation > no_separation
               ? 0.5 * std::erfc(-(0.5 * separation - std::log(settled_odds) / separation) / std::sqrt(2.0))
               : 0;
}

double sum_of_squares(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) {
        sum += value * value;
    }
    return sum;
}

double autocorrelation(std::span<const double> values, std::size_t lag) {
    const double centre = mean(values);
    double above = 0;
    double below = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        below += (values[i] - centre) * (values[i] - centre);
        if (i >= lag) {
            above += (values[i] - centre) * (values[i - lag] - centre);
        }
    }
    return below > 0 ? above / below : 0;
}

ErrorEstimate error_by_groups(const std::vector<double>& sum_of_squares, const std::vector<double>& counts,
                              std::uint64_t seed) {
    ErrorEstimate estimate;
    const std::size_t groups = counts.size();
    double total = 0;
    double number = 0;
    for (std::size_t g = 0; g < groups; ++g) {
        total += sum_of_squares[g];
        number += counts[g];
    }
    if (number <= 0) {
        return estimate;
    }
    estimate.count = static_cast<std::size_t>(number);
    estimate.rmse = std::sqrt(total / number);
    estimate.low = estimate.high = estimate.rmse;
    if (groups < 2) {
        return estimate;
    }
    core::Random random(seed);
    std::vector<double> logs;
    for (int draw = 0; draw < 1000; ++draw) {
        double drawn_total = 0;
        double drawn_number = 0;
        for (std::size_t g = 0; g < groups; ++g) {
            const std::size_t chosen = random.below(groups);
            drawn_total += sum_of_squares[chosen];
            drawn_number += counts[chosen];
        }
        if (drawn_number > 0 && drawn_total > 0) {
            logs.push_back(0.5 * std::log(drawn_total / drawn_number));
        }
    }
    if (logs.empty()) {
        return estimate;
    }
    // few groups: the percentile interval is known to be short by sqrt((n-1)/n) and by t over z
    const double n = static_cast<double>(groups);
    const double t = boost::math::quantile(boost::math::complement(boost::math::students_t(n - 1), beyond));
    const double widen = std::sqrt(n / (n - 1)) * t / core::sigmas_of_95;
    const double centre = std::log(estimate.rmse);
    estimate.low = std::exp(centre + widen * (quantile(logs, beyond) - centre));
    estimate.high = std::exp(centre + widen * (quantile(logs, 1 - beyond) - centre));
    estimate.low = std::min(estimate.low, estimate.rmse);
    estimate.high = std::max(estimate.high, estimate.rmse);
    return estimate;
}

}  // namespace underbody::discovery
