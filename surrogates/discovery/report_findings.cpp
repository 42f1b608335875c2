#include "surrogates/discovery/report_findings.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

FoundEffect found_effect(const FittedHypothesis& fitted, double probability) {
    FoundEffect effect;
    effect.name = fitted.hypothesis.names.empty() ? "none" : fitted.hypothesis.names.front();
    effect.depends_on = fitted.hypothesis.depends_on;
    effect.probability = probability;
    effect.explained = fitted.explained;
    effect.uses = fitted.hypothesis.with(fitted.fit.parameters);
    for (std::size_t j = 0; j < fitted.hypothesis.parameters.size(); ++j) {
        const Hypothesis::Slot& slot = fitted.hypothesis.slots[j];
        const dynamics::EffectUse& use = fitted.hypothesis.uses[slot.use];
        const bool several = std::count_if(fitted.hypothesis.uses.begin(), fitted.hypothesis.uses.end(),
                                           [&](const auto& other) { return other.name == use.name; }) > 1;
        const double sigma = std::isfinite(fitted.fit.sigma[j]) ? fitted.fit.sigma[j] : 0;
        const bool helper = fitted.hypothesis.names.size() == 1 && use.name != effect.name;
        effect.parameters.push_back({several && !use.quantity.empty()
                                         ? use.quantity + "." + fitted.hypothesis.parameters[j].name
                                     : helper ? use.name + "." + fitted.hypothesis.parameters[j].name
                                              : fitted.hypothesis.parameters[j].name,
                                     fitted.fit.parameters[j], sigma, fitted.hypothesis.parameters[j].unit});
        effect.uses[slot.use].sigmas[slot.value] = sigma;
    }
    for (const Hypothesis::Copy& copy : fitted.hypothesis.copies) {
        const dynamics::EffectParameter& parameter =
            dynamics::effect(fitted.hypothesis.uses[copy.to.use].name).info().parameters[copy.to.value];
        const double sigma = std::isfinite(fitted.fit.sigma[copy.parameter]) ? fitted.fit.sigma[copy.parameter] : 0;
        effect.uses[copy.to.use].sigmas[copy.to.value] = sigma;
        effect.parameters.push_back({parameter.name, fitted.fit.parameters[copy.parameter], sigma, parameter.unit});
    }
    return effect;
}

std::vector<FoundEffect> split_by_name(const FoundEffect& whole, const FittedHypothesis& fitted) {
    std::vector<FoundEffect> parts;
    for (const std::string& name : fitted.hypothesis.names) {
        FoundEffect part = whole;
        part.name = name;
        if (fitted.hypothesis.names.size() > 1) {
            part.parameters.clear();
            part.uses.clear();
            for (std::size_t j = 0; j < fitted.hypothesis.slots.size(); ++j) {
                if (fitted.hypothesis.uses[fitted.hypothesis.slots[j].use].name == name) {
                    part.parameters.push_back(whole.parameters[j]);
                }
            }
            for (std::size_t c = 0; c < fitted.hypothesis.copies.size(); ++c) {
                if (fitted.hypothesis.uses[fitted.hypothesis.copies[c].to.use].name == name) {
                    part.parameters.push_back(whole.parameters[fitted.hypothesis.slots.size() + c]);
                }
            }
            for (const dynamics::EffectUse& use : whole.uses) {
                if (use.name == name) {
                    part.uses.push_back(use);
                }
            }
            const std::vector<std::string>& catalogue = dynamics::effect(name).info().depends_on;
            const auto knows = [&](const std::string& variable) {
                return std::find(catalogue.begin(), catalogue.end(), variable) != catalogue.end();
            };
            // what the catalogue says of lift holds of whatever was measured
            std::erase_if(part.depends_on, [&](const std::string& variable) {
                const bool reading = variable.ends_with("_force") || variable.ends_with("_moment");
                return !knows(variable) && !(reading && knows("lift_force"));
            });
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

std::string evidence_of_runs(const FittedHypothesis& one) {
    const auto helped =
        std::count_if(one.explained_by_group.begin(), one.explained_by_group.end(), [](double x) { return x > 0; });
    return "-2 log likelihood falls by " + core::format_number(one.explained, 4) + " for " +
           core::counted(one.hypothesis.parameters.size(), "free number") + ", in " + std::to_string(helped) + " of " +
           core::counted(one.explained_by_group.size(), "run") +
           (one.hypothesis.form.empty() ? "" : "; " + one.hypothesis.form);
}

namespace {

FoundEffect unknown_effect(double probability, const std::vector<std::string>& depends_on) {
    FoundEffect unknown;
    unknown.name = "unknown";
    unknown.probability = probability;
    unknown.depends_on = depends_on;
    return unknown;
}

void tell_verdict(const Judgement& j, Discovery& result) {
    const auto named = [&]() -> const FittedHypothesis& { return j.fitted[j.attribution.chosen]; };
    if (result.verdict == "effect") {
        FoundEffect whole = found_effect(named(), j.attribution.shares.front().probability);
        whole.evidence = j.evidence(named());
        for (FoundEffect& effect : split_by_name(whole, named())) {
            result.effects.push_back(std::move(effect));
        }
    } else if (result.verdict == "unknown") {
        FoundEffect unknown = unknown_effect(j.attribution.unknown_probability, j.whole.variables);
        unknown.uses = j.uses;
        unknown.explained = j.whole.gain;
        const std::string left = j.attribution.chosen < j.fitted.size()
                                     ? "the best named effect (" + named().hypothesis.label() + ") leaves " +
                                           core::format_number(100 * j.left, 3) + " % of the structure; "
                                     : std::string();
        unknown.evidence =
            result.by_run
                ? "runs differ as much by noise alone with a chance of " + core::format_number(result.by_run->chance, 2)
            : j.uses.empty() ? left + "no correction is in the model"
                             : left + j.correction + " over " + list_of(j.whole.variables) + " takes its place";
        result.effects.push_back(std::move(unknown));
    }
}

void tell_rivals(const Judgement& j, Discovery& result) {
    for (const Attribution::Share& share : j.attribution.shares) {
        const FittedHypothesis& one = j.fitted[share.hypothesis];
        const bool is_verdict = result.verdict == "effect" && share.hypothesis == j.attribution.chosen;
        if (!is_verdict && result.alternatives.size() < 6 &&
            (share.probability > 1e-3 || result.alternatives.size() < 3)) {
            FoundEffect rival = found_effect(one, share.probability);
            rival.evidence = j.evidence(one);
            rival.name = one.hypothesis.label();
            if (result.verdict == "effect") {
                rival.told_apart_by = j.told_apart(j.fitted[j.attribution.chosen], one);
            }
            result.alternatives.push_back(std::move(rival));
        }
    }
    if (result.verdict != "unknown" && !result.alternatives.empty() && j.attribution.unknown_probability > 1e-3) {
        result.alternatives.push_back(unknown_effect(j.attribution.unknown_probability, j.rest.variables));
    }
}

void tell_limits(const Judgement& j, Discovery& result) {
    for (const Attribution::Share& share : j.attribution.shares) {
        const FittedHypothesis& one = j.fitted[share.hypothesis];
        if (one.hypothesis.names.size() == 1 && !one.hypothesis.parameters.empty()) {
            const std::string& declared = one.hypothesis.uses.front().parameter;  // the number that "value" is of
            const FitParameter& number = one.hypothesis.parameters.front();
            // five standard deviations: seen 9 times in 10 by a gate of about 3.7
            result.limits.push_back({one.hypothesis.names.front(), declared.empty() ? number.name : declared,
                                     5 * one.fit.sigma.front(), number.unit});
        }
    }
}

}  // namespace

void tell(const Judgement& judgement, Discovery& result) {
    tell_verdict(judgement, result);
    tell_rivals(judgement, result);
    tell_limits(judgement, result);
}

double share_of_draws(std::size_t groups, std::uint64_t seed,
                      const std::function<bool(const std::vector<double>& weight)>& same) {
    core::Random random(seed);
    constexpr int draws = 200;
    int count = 0;
    for (int d = 0; d < draws; ++d) {
        std::vector<double> weight(groups, 0);
        for (std::size_t g = 0; g < groups; ++g) {
            weight[random.below(groups)] += 1;
        }
        count += same(weight) ? 1 : 0;
    }
    return static_cast<double>(count) / draws;
}

std::size_t best_in_draw(const Attribution& attribution, const std::vector<FittedHypothesis>& fitted,
                         const std::vector<double>& weight) {
    double best = 1e300;
    std::size_t chosen = fitted.size();
    for (const Attribution::Share& share : attribution.shares) {
        const FittedHypothesis& one = fitted[share.hypothesis];
        double score = one.occam - 2 * std::log(one.hypothesis.prior);
        for (std::size_t g = 0; g < weight.size(); ++g) {
            score -= weight[g] * one.explained_by_group[g];
        }
        if (score < best) {
            best = score;
            chosen = share.hypothesis;
        }
    }
    return chosen;
}

}  // namespace underbody::discovery
