#include "surrogates/discovery/static/static_consequence.h"

#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "core/text.h"
#include "surrogates/discovery/consequence.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"
#include "surrogates/dynamics/model/effect.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

/// The middle of each channel over the measurements; direction and time have none.
dynamics::Conditions middle_of(const StaticExperiment& experiment) {
    dynamics::Conditions middle = experiment.observations().front().at;
    for (const Channel channel : experiment.varying()) {
        std::vector<double> values;
        for (const Observation& one : experiment.observations()) {
            values.push_back(one.at[channel]);
        }
        middle[channel] = median(values);
    }
    middle[Channel::approach_direction] = 0;
    return middle;
}

/// Zeros of lift less net weight over the measured gaps.
std::vector<Balance> balances(const dynamics::Model& model, const dynamics::Conditions& held, double low, double high) {
    const dynamics::StaticModel lift(model, "lift_force");
    const auto excess = [&](double gap) {
        dynamics::Conditions at = held;
        at[Channel::gap] = gap;
        return lift(at) - model.vehicle.net_weight;
    };
    std::vector<Balance> list;
    constexpr int steps = 400;
    const auto gap_of = [&](int k) {
        return low > 0 ? low * std::pow(high / low, static_cast<double>(k) / steps) : low + (high - low) * k / steps;
    };
    double left = excess(gap_of(0));
    for (int k = 1; k <= steps; ++k) {
        const double right = excess(gap_of(k));
        if (left * right < 0) {
            double a = gap_of(k - 1), b = gap_of(k);
            for (int halving = 0; halving < 50; ++halving) {
                const double c = 0.5 * (a + b);
                (excess(c) * left > 0 ? a : b) = c;
            }
            list.push_back({left > 0 ? "rest" : "watershed", left > 0, 0.5 * (a + b)});
        }
        left = right;
    }
    return list;
}

/// Effects by where they belong, each once, as a sentence names them.
struct Sides {
    std::vector<std::string> rig, body;
};

Sides sides_of(const std::vector<dynamics::EffectUse>& uses) {
    Sides sides;
    for (const dynamics::EffectUse& use : uses) {
        std::vector<std::string>& side = dynamics::effect(use.name).info().belongs_to_the_rig ? sides.rig : sides.body;
        const std::string name = use.name == "unknown" ? "the smooth correction" : use.name;
        if (std::find(side.begin(), side.end(), name) == side.end()) {
            side.push_back(name);
        }
    }
    return sides;
}

std::string text_of(const Sides& sides) {
    std::string text;
    if (const auto& rig = sides.rig; !rig.empty()) {
        text += list_of(rig) + (rig.size() == 1 ? " belongs" : " belong") +
                " to the rig, not to the vehicle: its motion does not change. A force table made from these "
                "readings must have " +
                (rig.size() == 1 ? "it" : "them") +
                " taken out; where the vehicle would seem to rest otherwise stands under 'after'. ";
    }
    if (const auto& body = sides.body; !body.empty()) {
        text += list_of(body) + (body.size() == 1 ? " goes" : " go") +
                " with the vehicle: every map and equilibrium made from the new model has " +
                (body.size() == 1 ? "it" : "them") + ". ";
    }
    return text;
}

/// "speed 0.5 m/s, pitch 0 rad"
std::string text_of(const dynamics::Conditions& held) {
    std::string at;
    for (const Channel channel : {Channel::speed, Channel::jet_voltage, Channel::pitch}) {
        if (held.has(channel)) {
            at += (at.empty() ? "" : ", ") + std::string(dynamics::channel_name(channel)) + " " +
                  core::format_number(held[channel], 3) + " " + dynamics::channel_unit(channel);
        }
    }
    return at;
}

}  // namespace

Consequence static_consequence(const dynamics::Model& before, const std::vector<dynamics::EffectUse>& uses,
                               const StaticExperiment& experiment, core::Progress& progress) {
    Consequence result;
    dynamics::Model after = before;
    for (const dynamics::EffectUse& use : uses) {
        after = after.with_effect(use);
    }
    const Sides sides = sides_of(uses);
    result.text = text_of(sides);
    const std::vector<std::string>& quantities = experiment.quantities();
    const std::vector<Channel>& varying = experiment.varying();
    if (std::find(quantities.begin(), quantities.end(), "lift_force") == quantities.end() ||
        std::find(varying.begin(), varying.end(), Channel::gap) == varying.end()) {
        result.text += "No lift over a gap was measured: there is no equilibrium to compare.";
        return result;
    }
    double low = core::no_limit, high = -core::no_limit;
    for (const Observation& one : experiment.observations()) {
        low = std::min(low, one.at[Channel::gap]);
        high = std::max(high, one.at[Channel::gap]);
    }
    const dynamics::Conditions held = middle_of(experiment);
    const std::vector<Balance> old_list = balances(before, held, low, high);
    result.equilibria = paired(old_list, uses.empty() ? old_list : balances(after, held, low, high));
    const std::string at = text_of(held);
    result.text += "Equilibria of lift and a net weight of " + core::format_number(before.vehicle.net_weight, 3) +
                   " N between the measured gaps" + (at.empty() ? "" : " at " + at) +
                   (result.equilibria.empty() ? ": there are none." : ".");
    if (sides.body.empty() && !uses.empty()) {
        return result;
    }
    map_if_possible(result, [&] {
        compare_regions(before, after, low, high, held, 30, progress, result);
        result.text += " Shares of starts with those gaps and velocities of -0.1 to 0.1 m/s, without input.";
    });
    return result;
}

}  // namespace underbody::discovery
