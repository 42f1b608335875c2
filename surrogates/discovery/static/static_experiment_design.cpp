#include "surrogates/discovery/static/static_experiment_design.h"

#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

constexpr double same_everywhere =
    0.02;  ///< standard deviations a reading: two laws that lie no further apart say the same
constexpr double worth_measuring = 0.3;  ///< of the largest separation: set points that are proposed with it
constexpr double most_repeats = 1e6;     ///< that are told

struct Candidate {
    dynamics::Conditions at;
    double separation = 0;  ///< of the two explanations, in standard deviations, all measured quantities together
};

std::vector<double> levels(const StaticExperiment& experiment, Channel channel) {
    double low = core::no_limit;
    double high = -core::no_limit;
    for (const Observation& one : experiment.observations()) {
        low = std::min(low, one.at[channel]);
        high = std::max(high, one.at[channel]);
    }
    const bool fine = channel == Channel::gap;
    const int count = fine ? 9 : channel == Channel::approach_direction ? 2 : 3;
    std::vector<double> values;
    for (int k = 0; k < count; ++k) {
        const double share = static_cast<double>(k) / (count - 1);
        values.push_back(fine && low > 0 ? low * std::pow(high / low, share) : low + (high - low) * share);
    }
    return values;
}

/// Every combination of a few levels of every varying channel; no more than some thousands.
std::vector<Candidate> candidates(const StaticExperiment& experiment) {
    std::vector<Candidate> list(1);
    list.front().at = experiment.observations().front().at;
    for (const Channel channel : experiment.varying()) {
        const std::vector<double> values = levels(experiment, channel);
        if (list.size() * values.size() > 4000) {
            continue;
        }
        std::vector<Candidate> longer;
        for (const Candidate& begun : list) {
            for (const double value : values) {
                longer.push_back(begun);
                longer.back().at[channel] = value;
            }
        }
        list = std::move(longer);
    }
    return list;
}

std::vector<Candidate> separated(const StaticExperiment& experiment, const std::vector<dynamics::EffectUse>& a,
                                 const std::vector<dynamics::EffectUse>& b) {
    std::vector<Candidate> list = candidates(experiment);
    for (Candidate& candidate : list) {
        for (std::size_t q = 0; q < experiment.quantities().size(); ++q) {
            Observation one = experiment.observations().front();
            one.quantity = q;
            one.at = candidate.at;
            one.sigma = 0;
            const double sigma = experiment.noise().at(experiment.quantities()[q]).value;
            const double difference = (experiment.predict(one, a) - experiment.predict(one, b)) / sigma;
            candidate.separation += difference * difference;
        }
        candidate.separation = std::sqrt(candidate.separation);
    }
    std::sort(list.begin(), list.end(),
              [](const Candidate& x, const Candidate& y) { return x.separation > y.separation; });
    return list;
}

std::string where(const StaticExperiment& experiment, const Candidate& candidate) {
    std::string text;
    for (const Channel channel : experiment.varying()) {
        if (channel != Channel::time && channel != Channel::temperature) {
            text += (text.empty() ? "" : ", ") + std::string(dynamics::channel_name(channel)) + " " +
                    value_text({"", candidate.at[channel], 0, dynamics::channel_unit(channel)});
        }
    }
    return text;
}

/// As the rig is to run them, each so many times.
void add_set_points(const StaticExperiment& experiment, const std::vector<Candidate>& taken, int repeats,
                    Discovery& result) {
    std::vector<Candidate> order;
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (std::size_t k = 0; k < taken.size(); ++k) {
            // up one time and down the next, so that time does not run with any channel
            order.push_back(taken[repeat % 2 == 0 ? k : taken.size() - 1 - k]);
        }
    }
    for (const Channel channel : experiment.varying()) {
        if (channel == Channel::time || channel == Channel::temperature) {
            continue;
        }
        std::vector<double> values;
        for (const Candidate& candidate : order) {
            values.push_back(candidate.at[channel]);
        }
        result.next_set_points.add_numbers(dynamics::channel_name(channel), dynamics::channel_unit(channel),
                                           std::move(values));
    }
}

}  // namespace

std::string static_told_apart(const StaticExperiment& experiment, const FittedHypothesis& chosen,
                              const FittedHypothesis& rival) {
    const std::vector<Candidate> list = separated(experiment, chosen.hypothesis.with(chosen.fit.parameters),
                                                  rival.hypothesis.with(rival.fit.parameters));
    if (list.front().separation < same_everywhere) {
        return "nothing in the measured range: both say the same at every set point; look at the rig (is there such a "
               "part?)";
    }
    const double repeats = std::ceil(36 / (list.front().separation * list.front().separation));
    return "they differ most at " + where(experiment, list.front()) + ": by " +
           core::format_number(list.front().separation, 3) + " standard deviations a reading, so " +
           (repeats <= 1 ? "one reading there decides"
                         : core::format_number(std::min(repeats, most_repeats), 4) + " readings there decide");
}

namespace {

/// Two explanations that the next set points are to tell apart, and what for.
struct Question {
    std::vector<dynamics::EffectUse> a, b;
    std::string purpose;
};

Question question(const StaticExperiment& experiment, const std::vector<FittedHypothesis>& fitted,
                  const Attribution& attribution, const Discovery& result) {
    const FittedHypothesis& best = fitted[attribution.shares.front().hypothesis];
    Question ask{best.hypothesis.with(best.fit.parameters), {}, "to confirm " + best.hypothesis.label()};
    if (result.verdict == "effect" && attribution.shares.size() > 1) {
        // the likeliest rival that set points can tell from it at all
        const FittedHypothesis* rival = nullptr;
        for (std::size_t k = 1; k < attribution.shares.size(); ++k) {
            rival = &fitted[attribution.shares[k].hypothesis];
            ask.b = rival->hypothesis.with(rival->fit.parameters);
            if (separated(experiment, ask.a, ask.b).front().separation > same_everywhere) {
                break;
            }
        }
        ask.purpose = "to tell " + best.hypothesis.label() + " from " + rival->hypothesis.label();
    } else if (result.verdict == "none") {
        // the effect that came nearest, at its limit
        std::vector<double> p = best.fit.parameters;
        p.front() += 3 * best.fit.sigma.front();
        ask.a = best.hypothesis.with(p);
        ask.purpose = "to see " + best.hypothesis.label() + " below today's limit";
    } else if (result.verdict == "unknown" && !result.effects.empty()) {
        // where the correction is largest; levels between the measured ones show its shape
        ask.a = result.effects.front().uses;
        ask.purpose = "to see the law behind what depends on " + list_of(result.depends_on);
    }
    return ask;
}

}  // namespace

void next_static_experiment(const StaticExperiment& experiment, const std::vector<FittedHypothesis>& fitted,
                            const Attribution& attribution, std::uint64_t /*seed*/, Discovery& result) {
    if (attribution.shares.empty()) {
        result.next_experiment =
            "set points other than those measured; the catalogue has no effect that these could show";
        return;
    }
    const Question ask = question(experiment, fitted, attribution, result);
    const std::vector<Candidate> list = separated(experiment, ask.a, ask.b);
    std::vector<Candidate> taken;
    for (const Candidate& candidate : list) {
        if (taken.size() < 8 && candidate.separation > worth_measuring * list.front().separation) {
            taken.push_back(candidate);
        }
    }
    constexpr double repeats = 4;
    double square = 0;
    for (const Candidate& candidate : taken) {
        square += repeats * candidate.separation * candidate.separation;
    }
    result.next_power = chance_to_settle(std::sqrt(square));
    result.next_experiment =
        experiment_text(ask.purpose,
                        std::to_string(taken.size()) + " set points, " + core::format_number(repeats, 2) +
                            " readings each in mixed order, first at " + where(experiment, list.front()),
                        result.next_power) +
        " (next-experiment.csv)";
    add_set_points(experiment, taken, static_cast<int>(repeats), result);
}

}  // namespace underbody::discovery
