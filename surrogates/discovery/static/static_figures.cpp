#include "surrogates/discovery/static/static_figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/angle.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

struct Shown {
    double factor = 1;
    std::string unit;
};

/// The unit a person would read the channel in.
Shown shown(Channel channel) {
    if (channel == Channel::gap || channel == Channel::depth) {
        return {1000, "mm"};
    }
    if (channel == Channel::time) {
        return {1.0 / 3600, "h"};
    }
    if (channel == Channel::pitch) {
        return {1 / core::degree, "deg"};
    }
    return {1, dynamics::channel_unit(channel)};
}

/// Mean and its error in bins of equal numbers; a channel with few levels gets one bin a level.
core::FigurePoints binned(const std::vector<std::pair<double, double>>& sorted, const std::string& name,
                          core::Colour colour) {
    core::FigurePoints means;
    means.name = name;
    means.colour = colour;
    means.size = 8;
    std::set<double> levels;
    for (const auto& [x, y] : sorted) {
        levels.insert(x);
    }
    const bool by_level = levels.size() <= 16;
    // a tow tank's dozen of runs shows its curve reading by reading
    const std::size_t size = sorted.size() <= 48 ? 1 : std::max<std::size_t>(6, sorted.size() / 12);
    for (std::size_t begin = 0; begin < sorted.size();) {
        std::size_t end = begin;
        double x = 0, y = 0, square = 0;
        while (end < sorted.size() && (by_level ? sorted[end].first == sorted[begin].first : end - begin < size)) {
            x += sorted[end].first;
            y += sorted[end].second;
            square += sorted[end].second * sorted[end].second;
            ++end;
        }
        const double n = static_cast<double>(end - begin);
        means.x.push_back(x / n);
        means.y.push_back(y / n);
        means.y_error.push_back(std::sqrt(std::max(0.0, square / n - y * y / n / n) / std::max(n - 1, 1.0)));
        begin = end;
    }
    return means;
}

/// What declared model and found one leave of each reading, over what it hangs on.
struct LeftOver {
    std::vector<std::pair<double, double>> before, after;
    double sigma = 0;    ///< of a reading
    double largest = 0;  ///< of `before`
};

LeftOver left_over(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                   const std::vector<dynamics::EffectUse>& uses, std::size_t quantity, Channel channel, double factor) {
    LeftOver left;
    for (const std::size_t i : chosen) {
        const Observation& one = experiment.observations()[i];
        if (one.quantity != quantity) {
            continue;
        }
        const double x = one.at[channel] * factor;
        left.before.emplace_back(x, one.value - experiment.predict(one, {}));
        left.after.emplace_back(x, one.value - experiment.predict(one, uses));
        left.largest = std::max(left.largest, std::abs(left.before.back().second));
        left.sigma = experiment.sigma(one);
    }
    return left;
}

core::Figure residual_figure(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                             const std::vector<dynamics::EffectUse>& uses, std::size_t quantity, Channel channel) {
    const Shown unit = shown(channel);
    const std::string& name = experiment.quantities()[quantity];
    LeftOver left = left_over(experiment, chosen, uses, quantity, channel, unit.factor);
    if (left.before.empty()) {
        return {};
    }
    const double scale = left.largest < 1 ? 1000 : 1;
    for (auto* list : {&left.before, &left.after}) {
        for (auto& [x, y] : *list) {
            y *= scale;
        }
    }
    core::FigurePoints cloud;
    cloud.name = "readings less declared model";
    cloud.colour = {190, 190, 190, 255};
    cloud.size = 4;
    for (const auto& [x, y] : left.before) {
        cloud.x.push_back(x);
        cloud.y.push_back(y);
    }
    std::sort(left.before.begin(), left.before.end());
    std::sort(left.after.begin(), left.after.end());
    core::Figure figure;
    figure.title = "What the model leaves of " + name + " over " + dynamics::channel_name(channel);
    figure.x = {dynamics::channel_name(channel), unit.unit, 0, 0,
                tables::spans_decades(left.before.front().first, left.before.back().first)};
    figure.y = {"measured less model", (scale > 1 ? "m" : "") + core::find_quantity(name)->unit, 0, 0, false};
    figure.lines.push_back({false, 0, "", {60, 60, 60, 255}, false});
    figure.lines.push_back(
        {false, 2 * left.sigma * scale, "two standard deviations of a reading", {120, 120, 120, 255}, true});
    figure.lines.push_back({false, -2 * left.sigma * scale, "", {120, 120, 120, 255}, true});
    figure.points.push_back(std::move(cloud));
    figure.points.push_back(binned(left.before, "means, as declared", core::palette(1)));
    if (!uses.empty()) {
        figure.points.push_back(binned(left.after, "means, with what was found", core::palette(0)));
    }
    figure.caption =
        uses.empty() ? "Grey: every reading that was used; means with their errors. Nothing stands out of the noise."
                     : "Grey: every reading that was used for the fit. The means should lie on zero: with what was "
                       "found they do, as declared they do not.";
    return figure;
}

}  // namespace

core::Figure probability_figure(const Discovery& result) {
    core::Figure figure;
    figure.title = "How sure";
    figure.y = {"probability", "", 0, 1, false};
    figure.legend = false;
    figure.caption = "What is missing, by probability.";
    core::FigureBars bars;
    const auto add = [&](const std::string& label, double value) {
        bars.labels.push_back(label);
        bars.values.push_back(value);
    };
    if (!result.effects.empty()) {
        std::string names;  // one a line: side by side several are wider than their bar, and no label would be drawn
        for (const FoundEffect& effect : result.effects) {
            names += (names.empty() ? "" : "\n+ ") + effect.name;
        }
        add(names, result.effects.front().probability);
    }
    for (const FoundEffect& rival : result.alternatives) {
        if (bars.labels.size() < 6) {
            add(rival.name, rival.probability);
        }
    }
    add("none", result.none_probability);
    figure.bars.push_back(std::move(bars));
    return figure;
}

core::Figure error_figure(const Discovery& result) {
    core::Figure figure;
    figure.title = "Error on held-out data";
    figure.y = {"RMSE over noise", "", 0, 0, false};
    figure.caption = "From " + result.held_out + ". One is the noise of a reading.";
    double smallest = 1;
    double largest = 1;
    for (const bool after : {false, true}) {
        core::FigureBars bars;
        bars.name = after ? "with what was found" : "as declared";
        bars.colour = after ? core::palette(0) : core::Colour{180, 180, 180, 255};
        for (const ErrorChange& change : result.error) {
            const ErrorEstimate& estimate = after ? change.after : change.before;
            const std::string horizon = change.horizon <= 0 ? ""
                                        : std::isinf(change.horizon)
                                            ? ", free run"
                                            : ", " + core::format_number(change.horizon, 3) + " s";
            bars.labels.push_back(change.channel + horizon);
            bars.values.push_back(estimate.rmse / core::never_zero(change.noise));
            bars.errors.push_back(std::min((estimate.high - estimate.low) / 4, estimate.rmse) /
                                  core::never_zero(change.noise));
            smallest = std::min(smallest, bars.values.back());
            largest = std::max(largest, bars.values.back() + bars.errors.back());
        }
        figure.bars.push_back(std::move(bars));
    }
    // a free run may err a thousand times more than the next two seconds: all of them are to be seen
    if (std::isfinite(largest) && tables::spans_decades(smallest, largest)) {
        constexpr double room_above = 1.5;
        figure.y.logarithmic = true;
        figure.y.lower = 0.5 * smallest;
        figure.y.upper = room_above * largest;
    }
    return figure;
}

std::vector<core::Figure> static_figures(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                                         const std::vector<dynamics::EffectUse>& uses, const Discovery& result) {
    std::vector<core::Figure> figures;
    std::vector<Channel> channels;
    for (const std::string& name : result.depends_on) {
        Channel channel{};
        if (dynamics::find_channel(name, channel)) {
            channels.push_back(channel);
        }
    }
    for (const Channel channel : experiment.varying()) {
        if (channels.size() < 2 && std::find(channels.begin(), channels.end(), channel) == channels.end()) {
            channels.push_back(channel);
        }
    }
    // the quantity that moves most gets a picture over each of two channels, the others one over the first
    std::vector<std::size_t> order(experiment.quantities().size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto rank = [&](std::size_t q) {
        const auto found = std::find_if(result.error.begin(), result.error.end(), [&](const ErrorChange& change) {
            return change.channel == experiment.quantities()[q];
        });
        return found - result.error.begin();
    };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    for (std::size_t k = 0; k < order.size() && !channels.empty(); ++k) {
        for (std::size_t c = 0; c < (k == 0 ? std::min<std::size_t>(channels.size(), 2) : 1); ++c) {
            figures.push_back(residual_figure(experiment, chosen, uses, order[k], channels[c]));
        }
    }
    figures.push_back(probability_figure(result));
    figures.push_back(error_figure(result));
    return figures;
}

}  // namespace underbody::discovery
