#include "surrogates/dynamics/simulate/sensor_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/quantile.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"

namespace underbody::dynamics {

double reading_step(std::span<const double> values) {
    double step = std::numeric_limits<double>::infinity();
    std::size_t pairs = 0;
    std::size_t equal = 0;
    const auto each_difference = [&values](const auto& use) {
        for (std::size_t i = 1; i < values.size(); ++i) {
            const double difference = std::abs(values[i] - values[i - 1]);
            if (std::isfinite(difference)) {
                use(difference);
            }
        }
    };
    // files have nine digits or so: what is closer than that is the same reading
    double largest = 0;
    each_difference([&largest](double difference) { largest = std::max(largest, difference); });
    const double tiny = 1e-6 * largest;
    each_difference([&](double difference) {
        ++pairs;
        equal += difference <= tiny ? 1 : 0;
        step = difference > tiny ? std::min(step, difference) : step;
    });
    if (5 * equal < pairs || !std::isfinite(step)) {
        return 0;
    }
    constexpr double off_grid = 0.02;  // of the step
    std::size_t on_grid = 0;
    each_difference([&](double difference) {
        on_grid += std::abs(difference / step - std::round(difference / step)) < off_grid ? 1 : 0;
    });
    return 100 * on_grid >= 98 * pairs ? step : 0;
}

namespace {

/// White noise out of differences of an order; NaN with fewer than six.
double noise_by_differences(std::span<const double> time, std::span<const double> values, std::size_t order) {
    constexpr double uneven = 0.2;  // of a step in time
    std::vector<double> differences;
    for (std::size_t i = order; i < values.size(); ++i) {
        bool even = true;
        for (std::size_t k = 0; k + 1 < order && !time.empty(); ++k) {
            const double last = time[i] - time[i - 1], before = time[i - k - 1] - time[i - k - 2];
            even = even && std::abs(before - last) < uneven * last;
        }
        const double difference = order == 2 ? values[i] - 2 * values[i - 1] + values[i - 2]
                                             : values[i] - 3 * values[i - 1] + 3 * values[i - 2] - values[i - 3];
        if (even && std::isfinite(difference)) {
            differences.push_back(difference);
        }
    }
    // Of white noise they have 1 + 4 + 1 and 1 + 9 + 9 + 1 times its variance.
    return differences.size() < 6 ? std::numeric_limits<double>::quiet_NaN()
                                  : core::robust_deviation(std::move(differences)) / std::sqrt(order == 2 ? 6.0 : 20.0);
}

}  // namespace

double sensor_noise(std::span<const double> time, std::span<const double> values) {
    const double second = noise_by_differences(time, values, 2), third = noise_by_differences(time, values, 3);
    const auto finite = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); }));
    if (std::isnan(second) && finite >= 6 && finite < values.size()) {
        // rows of another sensor stand between the readings: among themselves they are neighbours
        std::vector<double> own_time, own;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (std::isfinite(values[i])) {
                own.push_back(values[i]);
                if (!time.empty()) {
                    own_time.push_back(time[i]);
                }
            }
        }
        return sensor_noise(own_time, own);
    }
    if (std::isnan(second) && !time.empty()) {
        return sensor_noise({}, values);  // no two steps alike: better all of them than none
    }
    // The second is the surer of the two unless a curved motion shows in it.
    const double scatter = third < 0.9 * second ? third : second;
    // A coarse sensor repeats its reading more often than not: half of its differences, and with them the middle, are
    // naught.
    return std::isnan(scatter) ? scatter : std::max(scatter, reading_step(values) / std::sqrt(12.0));
}

namespace {

constexpr double lower = 0.88, upper = 1.14;  // of the declared figure: what it allows

}  // namespace

double unit_of_errors(std::optional<double> declared, double found) {
    return declared && !(found >= upper * *declared) ? *declared : found;
}

JudgedNoise judged_noise(const std::string& channel, std::optional<double> declared, double estimated) {
    constexpr double least = 1e-6;  // m or m/s
    if (!declared || !(estimated > 0)) {
        return {declared.value_or(estimated > 0 ? estimated : least), declared ? "declared" : "estimated", ""};
    }
    const double ratio = estimated / *declared;
    if (ratio > lower && ratio < upper) {
        return {*declared, "declared", ""};
    }
    const core::QuantityName* quantity = core::find_quantity(channel);
    const std::string_view unit = quantity != nullptr ? std::string_view(quantity->unit) : "";
    return {estimated,
            "estimated: the scatter from reading to reading is " + core::format_number(ratio, 3) +
                " times the declared figure",
            "the declared noise of " + channel + " (" + core::told(*declared, unit, 3) +
                ") disagrees with the scatter from reading to reading (" + core::told(estimated, unit, 3) +
                "): the figure is " +
                (ratio < 1 ? "too large or the noise is coloured; the scatter is used where readings are weighed, and "
                             "errors are told "
                             "in the declared figure"
                           : "wrong; the scatter is used")};
}

}  // namespace underbody::dynamics
