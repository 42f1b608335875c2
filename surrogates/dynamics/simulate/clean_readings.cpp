#include "surrogates/dynamics/simulate/clean_readings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/counted.h"
#include "core/quantile.h"
#include "core/text.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::dynamics {

std::size_t drop_outliers(std::vector<double>& values, double sigma) {
    // readings on either side, and how far to look for them across missing ones; rows of other sensors between the
    // readings do not count
    constexpr std::size_t half = 3;
    const auto finite = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); }));
    const std::size_t reach = 15 * std::max<std::size_t>(1, values.size() / std::max<std::size_t>(1, finite));
    std::vector<std::size_t> bad;
    std::vector<double> window;
    for (std::size_t i = 0; i < values.size(); ++i) {
        window.clear();
        if (!std::isfinite(values[i])) {
            continue;
        }
        window.push_back(values[i]);
        for (const bool before : {true, false}) {
            std::size_t found = 0;
            for (std::size_t d = 1; d <= reach && found < half && (before ? d <= i : i + d < values.size()); ++d) {
                const double other = values[before ? i - d : i + d];
                if (std::isfinite(other)) {
                    window.push_back(other);
                    ++found;
                }
            }
        }
        if (window.size() >= 4) {
            const double spread = core::quantile(window, 0.8) - core::quantile(window, 0.2);
            if (std::abs(values[i] - core::median(window)) > 8 * sigma + 2 * spread) {
                bad.push_back(i);
            }
        }
    }
    for (const std::size_t i : bad) {
        values[i] = std::nan("");
    }
    return bad.size();
}

std::size_t drop_saturated(const std::vector<double>& time, std::vector<double>& values) {
    std::size_t dropped = 0;
    const double step = reading_step(values);
    for (const bool upper : {true, false}) {
        double end = upper ? -1e300 : 1e300;
        std::size_t same = 1;
        for (std::size_t i = 1; i < values.size(); ++i) {
            same = values[i] == values[i - 1] ? same + 1 : 1;
            if (same == 5) {
                end = upper ? std::max(end, values[i]) : std::min(end, values[i]);
            }
        }
        // a sensor without noise of its own repeats values by rounding; a saturated one repeats its end alone
        std::vector<double> inside = values;
        std::replace(inside.begin(), inside.end(), end, std::nan(""));
        const double noise = sensor_noise(time, inside);
        const auto at_end = static_cast<std::size_t>(std::count(values.begin(), values.end(), end));
        // one that rounds repeats every value: its end counts only when it has far more readings than the value beside
        // it
        const double beside = end + (upper ? -step : step);
        const auto at_next = static_cast<std::size_t>(
            step > 0 ? std::count_if(values.begin(), values.end(),
                                     [&](double v) { return std::abs(v - beside) < 0.1 * step; })
                     : 0);
        const auto beyond =
            std::count_if(values.begin(), values.end(), [&](double x) { return upper ? x > end : x < end; });
        if (at_end > std::max<std::size_t>(8, values.size() / 100) &&
            50 * static_cast<std::size_t>(beyond) < values.size() && noise > 0 && at_end > 10 * at_next) {
            // beside the end only the readings whose noise points inward are left: they would look like a force
            for (double& value : values) {
                if (upper ? value > end - 5 * noise : value < end + 5 * noise) {
                    value = std::nan("");
                    ++dropped;
                }
            }
        }
    }
    return dropped;
}

InsideTables longest_inside(std::span<const double> gap, const GapRange& tables, double noise) {
    constexpr double margin = 6;  // standard deviations of a reading: no noise takes it so far beyond a table
    const double beyond = std::isfinite(noise) ? margin * noise : 0;
    InsideTables found;
    std::size_t begin = 0, outside = 0;
    for (std::size_t k = 0; k <= gap.size(); ++k) {
        const bool out = k < gap.size() && (gap[k] < tables.lower - beyond || gap[k] > tables.upper + beyond);
        outside += out ? 1 : 0;
        if (out || k == gap.size()) {
            if (k - begin > found.last - found.first) {
                found.first = begin;
                found.last = k;
            }
            begin = k + 1;
        }
    }
    found.outside = gap.empty() ? 0 : static_cast<double>(outside) / static_cast<double>(gap.size());
    return found;
}

bool fill_missing(const std::vector<double>& time, std::vector<double>& values, bool linear) {
    const auto known = [&](std::size_t i) { return std::isfinite(values[i]); };
    std::size_t first = 0;
    while (first < values.size() && !known(first)) {
        ++first;
    }
    if (first == values.size()) {
        return false;
    }
    std::fill(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first), values[first]);
    for (std::size_t last = first, i = first + 1; i <= values.size(); ++i) {
        if (i < values.size() && !known(i)) {
            continue;
        }
        for (std::size_t k = last + 1; k < i; ++k) {
            const double share =
                linear && i < values.size() ? (time[k] - time[last]) / (time[i] - time[last]) : 0;  // else held
            values[k] = share > 0 ? values[last] + share * (values[i] - values[last]) : values[last];
        }
        last = i;
    }
    return true;
}

void unwrap(std::vector<double>& angle) {
    constexpr double turn_round = 2 * std::numbers::pi;
    double last = std::nan(""), added = 0;
    for (double& value : angle) {
        const double read = value;
        if (std::isfinite(read) && std::isfinite(last)) {
            added -= turn_round * std::round((read - last) / turn_round);
        }
        last = std::isfinite(read) ? read : last;
        value += added;
    }
}

std::string range_text(const GapRange& tables) {
    return "(" + core::format_number(tables.lower, 4) + " to " + core::format_number(tables.upper, 4) + " m)";
}

std::string outliers_text(const std::string& run, std::size_t count, const std::string& channel) {
    return std::to_string(count) + " " + channel + " readings of " + run + " lie far from their neighbours: not used";
}

std::string saturated_text(const std::string& run, std::size_t count) {
    return core::counted(count, "gap reading") + " of " + run + (count == 1 ? " stands" : " stand") +
           " exactly at the end of the sensor's range (saturated): not used";
}

std::string outside_text(const std::string& run, const InsideTables& inside, const GapRange& tables) {
    return run + " spends " + core::format_number(100 * inside.outside, 3) +
           " % of its time outside the tables of the declared model " + range_text(tables) +
           ", where nothing is known of the force";
}

std::string unused_text(const std::string& run, const InsideTables& inside, const GapRange& tables,
                        std::span<const double> time) {
    const std::string used = time.empty()
                                 ? "nothing of it is"
                                 : "only " + core::format_number(time.front(), 4) + " to " +
                                       core::format_number(time.back(), 4) + " s, the longest stretch inside, are";
    return outside_text(run, inside, tables) + ": " + used + " used";
}

}  // namespace underbody::dynamics
