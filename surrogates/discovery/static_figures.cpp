#include "surrogates/discovery/static_figures.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"

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
        return {180 / 3.14159265358979323846, "deg"};
    }
    return {1, dynamics::channel_unit(channel)};
}

core::Figure residual_figure(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                             const std::vector<dynamics::EffectUse>& uses, std::size_t quantity, Channel channel) {
    const Shown unit = shown(channel);
    const std::string& name = experiment.quantities()[quantity];
    core::Figure figure;
    figure.title = "What the model leaves of " + name + " against " + dynamics::channel_name(channel);
    figure.x = {dynamics::channel_name(channel), unit.unit, 0, 0, false};
    figure.y = {"measured less model", "mN", 0, 0, false};
    core::FigurePoints before;
    before.name = "as declared";
    before.colour = {180, 180, 180, 255};
    before.size = 5;
    core::FigurePoints after;
    after.name = "with what was found";
    after.colour = core::palette(0);
    after.size = 5;
    double sigma = 0;
    for (const std::size_t i : chosen) {
        const Observation& one = experiment.observations()[i];
        if (one.quantity != quantity) {
            continue;
        }
        before.x.push_back(one.at[channel] * unit.factor);
        before.y.push_back(1000 * (one.value - experiment.predict(one, {})));
        if (!uses.empty()) {
            after.x.push_back(before.x.back());
            after.y.push_back(1000 * (one.value - experiment.predict(one, uses)));
        }
        sigma = 1000 * experiment.sigma(one);
    }
    figure.lines.push_back({false, 2 * sigma, "two standard deviations of the noise", {120, 120, 120, 255}, true});
    figure.lines.push_back({false, -2 * sigma, "", {120, 120, 120, 255}, true});
    figure.caption = "Every reading used for the fit. Readings between the dashed lines cannot be told from noise.";
    figure.points.push_back(std::move(before));
    if (!uses.empty()) {
        figure.points.push_back(std::move(after));
    }
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
        std::vector<std::string> names;
        for (const FoundEffect& effect : result.effects) {
            names.push_back(effect.name);
        }
        add(list_of(names), result.effects.front().probability);
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
    for (const bool after : {false, true}) {
        core::FigureBars bars;
        bars.name = after ? "with what was found" : "as declared";
        bars.colour = after ? core::palette(0) : core::Colour{180, 180, 180, 255};
        for (const ErrorChange& change : result.error) {
            const ErrorEstimate& estimate = after ? change.after : change.before;
            bars.labels.push_back(change.channel);
            bars.values.push_back(estimate.rmse / std::max(change.noise, 1e-300));
            bars.errors.push_back(0.25 * (estimate.high - estimate.low) / std::max(change.noise, 1e-300));
        }
        figure.bars.push_back(std::move(bars));
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
        if (channels.size() < 3 && std::find(channels.begin(), channels.end(), channel) == channels.end()) {
            channels.push_back(channel);
        }
    }
    for (std::size_t q = 0; q < experiment.quantities().size(); ++q) {
        for (const Channel channel : channels) {
            figures.push_back(residual_figure(experiment, chosen, uses, q, channel));
        }
    }
    figures.push_back(probability_figure(result));
    figures.push_back(error_figure(result));
    return figures;
}

}  // namespace underbody::discovery
