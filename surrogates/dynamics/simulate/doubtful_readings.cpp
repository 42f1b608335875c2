#include "surrogates/dynamics/simulate/doubtful_readings.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/no_limit.h"
#include "core/normal.h"
#include "core/quantile.h"
#include "core/text.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::dynamics {

bool stands_still(const std::vector<double>& values) {
    std::size_t same = 0;
    std::size_t longest = 0;
    std::size_t readings = 0;
    double last = std::nan("");
    for (const double value : values) {
        if (std::isfinite(value)) {  // rows of other sensors stand between the readings
            same = value == last ? same + 1 : 0;
            longest = std::max(longest, same);
            last = value;
            ++readings;
        }
    }
    return readings > 20 && longest > readings / 5;
}

std::string still_text(const std::string& run) {
    return "the gap of " + run + " stands still for a fifth of the run: a stuck sensor?";
}

namespace {

double share_outside(const std::vector<double>& gaps, double factor, const GapRange& tables) {
    const auto out = std::count_if(gaps.begin(), gaps.end(),
                                   [&](double x) { return factor * x < tables.lower || factor * x > tables.upper; });
    return static_cast<double>(out) / static_cast<double>(gaps.size());
}

/// What gaps that lie outside the tables would be inside as: only what fits as it stands, and far from fitting as it
/// was read: a gap of 1.69 m beside tables to 1.6 m is none in mm, and one below the ground none in m.
BesideTables misread(const std::vector<double>& gaps, const GapRange& tables) {
    constexpr double most = 0.1, far = 3;
    const double middle = core::median(gaps);
    const auto fits = [&](double factor) { return share_outside(gaps, factor, tables) < most; };
    if (middle > far * tables.upper && fits(1e-3)) {
        return {": a thousandth would fit", "is the column's unit mm, and was it read in m?"};
    }
    if (middle > 0 && far * middle < tables.lower && fits(1e3)) {
        return {": a thousandfold would fit", "is the column's unit m, and was it read in mm?"};
    }
    if (middle < 0 && fits(-1)) {
        return {": with the other sign it would fit",
                "gap counts upward from the ground; a depth or a z down is turned by sign = -1 in [log.channel.gap]"};
    }
    return {};
}

}  // namespace

std::optional<BesideTables> beside_tables(const std::vector<double>& gap, const GapRange& tables) {
    if (!core::is_limit(tables.lower) || !core::is_limit(tables.upper)) {
        return {};
    }
    std::vector<double> finite;
    std::copy_if(gap.begin(), gap.end(), std::back_inserter(finite), [](double x) { return std::isfinite(x); });
    const double middle = core::median(finite), margin = 0.05 * (tables.upper - tables.lower);
    const double outside = share_outside(finite, 1, tables);
    const bool beyond = !(middle > tables.lower - margin && middle < tables.upper + margin);
    if (!beyond && !(outside > 0.5)) {
        return {};
    }
    BesideTables found = misread(finite, tables);
    found.text = (beyond ? "its gap, " + core::format_number(middle, 4) + " m in the middle, lies"
                         : "it spends " + core::format_number(100 * outside, 3) + " % of its time") +
                 " outside the tables of the declared model " + range_text(tables) + found.text;
    return found;
}

bool look_exchanged(double gap_noise, double input_noise, std::optional<double> declared) {
    return declared && gap_noise < 0.05 * *declared && input_noise > 0.5 * *declared && input_noise < 2 * *declared;
}

VelocityScale velocity_scale(const std::vector<double>& time, const std::vector<double>& gap,
                             const std::vector<double>& velocity, double gap_noise) {
    double cross = 0;
    double by_velocity = 0;
    double by_gap = 0;
    constexpr double window = 1;  // s: short beside a run, long enough that the noise of the gap hardly counts
    for (std::size_t begin = 0, end = 1; end < time.size(); ++end) {
        const double lasted = time[end] - time[begin];
        if (lasted < window) {
            continue;
        }
        double sum = 0;
        double weights = 0;
        for (std::size_t i = begin; i <= end; ++i) {
            if (std::isfinite(velocity[i])) {
                const double weight = i == begin || i == end ? 0.5 : 1;
                sum += weight * velocity[i];
                weights += weight;
            }
        }
        const double change = gap[end] - gap[begin];
        if (std::isfinite(change) && weights > 0.5 * static_cast<double>(end - begin)) {
            const double path = lasted * sum / weights;
            cross += change * path;
            by_velocity += path * path;
            by_gap += change * change - 2 * gap_noise * gap_noise;
        }
        begin = end;
    }
    return by_gap > 0 ? VelocityScale{cross / by_gap, std::sqrt(by_velocity / by_gap)}
                      : VelocityScale{std::nan(""), std::nan("")};
}

std::optional<DoubtfulVelocity> doubtful_velocity(const std::vector<VelocityScale>& scales) {
    std::vector<double> slopes;
    std::vector<double> ratios;
    for (const VelocityScale& scale : scales) {
        if (std::isfinite(scale.slope)) {
            slopes.push_back(scale.slope);
            ratios.push_back(scale.ratio);
        }
    }
    if (slopes.empty()) {
        return {};
    }
    const double slope = core::median(slopes);
    const double ratio = core::median(ratios);
    std::vector<double> apart;
    for (const double one : ratios) {
        apart.push_back(std::abs(one - ratio));
    }
    // five standard errors of the runs' median, and never for a few hundredths; one or two runs show no scatter
    const double tolerance = ratios.size() < 3
                                 ? 0.25
                                 : std::max(0.05, 5 * 1.25 * core::sigma_of_median_distance * core::median(apart) /
                                                      std::sqrt(static_cast<double>(ratios.size())));
    if (slope < -0.5 && slope > -2) {
        return DoubtfulVelocity{"heave_velocity has the opposite sign of the gap's changes (positive is up", true};
    }
    if (std::abs(slope) < 0.5 || std::abs(slope) > 2) {
        const bool thousand = (slope > 500 && slope < 2000) || (slope > 5e-4 && slope < 2e-3);
        return DoubtfulVelocity{
            "heave_velocity is " + core::format_number(slope, 3) + " times what the gap's changes say" +
            (thousand ? ": a unit wrong by a thousand?" : ": another channel, another run, or swapped columns?")};
    }
    if (std::abs(ratio - 1) > tolerance) {
        return DoubtfulVelocity{"heave_velocity is " + core::format_number(ratio, 3) +
                                " times what the gap's changes say: is the scale of one of the two wrong?"};
    }
    return {};
}

core::Problems doubtful_readings(const Model& model, const Measurements& data) {
    core::Problems said;
    std::vector<VelocityScale> scales;
    const auto say = [&](const std::string& text, const std::string& file) {
        said.push_back({core::Problem::Severity::warning, text, {file, {}, {}, {}}});
    };
    const std::optional<double> declared = data.declared_noise("gap");
    for (const MeasuredRun& run : data.runs) {
        if (!empty_text(run, "gap").empty()) {
            continue;
        }
        const std::vector<double>& time = run.table.numbers("time");
        std::vector<double> gap = run.values("gap");
        const std::size_t saturated = drop_saturated(time, gap);
        const double noise = sensor_noise(time, gap);
        const std::vector<double> pushed = run.values("input_force");
        if (stands_still(gap) || 2 * saturated > gap.size()) {
            say(still_text(run.name), run.table.source);
            continue;
        }
        if (const auto beside = beside_tables(gap, lift_gap_range(model)); beside && !beside->hint.empty()) {
            say(run.name + ": " + beside->text + ": " + beside->hint, run.table.source);
        }
        if (look_exchanged(noise, pushed.size() == gap.size() ? sensor_noise(time, pushed) : 0, declared)) {
            say("the gap of " + run.name +
                    " has no noise and input_force that of the gap sensor; the two columns look swapped",
                run.table.source);
        }
        const std::vector<double> velocity = as_read(run, "heave_velocity", model.records);
        if (velocity.size() == gap.size() && std::isfinite(noise)) {
            scales.push_back(velocity_scale(time, gap, velocity, noise));
        }
    }
    if (const auto velocity = doubtful_velocity(scales)) {
        say(velocity->text + (velocity->turned ? ")" : ""), data.folder.string());
    }
    return said;
}

}  // namespace underbody::dynamics
