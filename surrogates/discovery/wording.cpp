#include "surrogates/discovery/wording.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "core/text.h"
#include "surrogates/discovery/hypothesis.h"
#include "surrogates/discovery/run_split.h"

namespace underbody::discovery {

std::string list_of(const std::vector<std::string>& names) {
    if (names.empty()) {
        return "nothing that was measured";
    }
    std::string text = names.front();
    for (std::size_t i = 1; i < names.size(); ++i) {
        text += (i + 1 == names.size() ? " and " : ", ") + names[i];
    }
    return text;
}

namespace {

/// A unit that people read a number of this size in, and what the number is multiplied by.
struct ReadIn {
    double scale = 1;
    std::string unit;
};

/// Thousandths and millionths of SI units.
ReadIn read_in(const std::string& unit, double size) {
    const bool prefixed = unit == "m" || unit == "N" || unit == "N m" || unit == "s" || unit == "N/m" ||
                          unit == "m/s" || unit == "N/s" || unit == "N m/s";
    if (!prefixed || !(size > 0 && size < 0.1)) {
        return {1, unit == "1" ? "" : unit};
    }
    const bool micro = size < 1e-4;
    return {micro ? 1e6 : 1e3, (micro ? "u" : "m") + unit};
}

/// "2.44 to 0.217 mm (noise 0.2 mm)"
std::string error_text(const ErrorChange& error) {
    const ReadIn shown = read_in(error.unit, std::max(error.before.rmse, error.after.rmse));
    const auto number = [&](double value) { return core::format_number(shown.scale * value, 3); };
    const std::string unit = shown.unit.empty() ? "" : " " + shown.unit;
    return number(error.before.rmse) + " to " + number(error.after.rmse) + unit + " (noise " + number(error.noise) +
           unit + ")";
}

}  // namespace

std::string value_text(const FoundParameter& parameter) {
    const auto [scale, unit] = read_in(parameter.unit, std::max(std::abs(parameter.value), 3 * parameter.sigma));
    // As many digits as the error lets stand: 1.0006 +- 0.0004, not 1 +- 0.0004.
    int digits = 3;
    if (parameter.sigma > 0 && std::isfinite(parameter.sigma) && std::abs(parameter.value) > parameter.sigma) {
        digits = std::clamp(static_cast<int>(std::floor(std::log10(std::abs(parameter.value))) -
                                             std::floor(std::log10(parameter.sigma))) +
                                1,
                            3, 9);
    }
    const std::string text = core::format_number(scale * parameter.value, digits);
    return (parameter.sigma > 0 ? text + " \u00b1 " + core::format_number(scale * parameter.sigma, 2) : text) +
           (unit.empty() ? "" : " " + unit);
}

std::string number_name(const FoundEffect& effect, const FoundParameter& parameter) {
    const bool declared = effect.uses.size() == 1 && !effect.uses.front().parameter.empty();
    return declared && effect.parameters.size() == 1 ? effect.uses.front().parameter : parameter.name;
}

std::string probability_text(double probability) {
    return probability > 0.995   ? "above 0.99"
           : probability < 0.005 ? "below 0.01"
                                 : core::format_number(probability, 2);
}

namespace {

constexpr double allowed_rise = 1.05;  ///< of an error that falls elsewhere: above, it is said
constexpr double tied = 0.2;           ///< a rival of that probability is worth a name in the verdict
constexpr double tied_kin = 0.05;      ///< and one whose law can stand in for the other's of that

bool is_tied(const Discovery& discovery, const FoundEffect& rival) {
    const bool kin = discovery.effects.size() == 1 && dynamics::find_effect(rival.name) != nullptr &&
                     one_kin({discovery.effects.front().name, rival.name});
    return rival.probability > (kin ? tied_kin : tied);
}

}  // namespace

std::string verdict_names(const Discovery& discovery) {
    if (discovery.verdict == "none") {
        return "none";
    }
    if (discovery.verdict == "unknown") {
        return "unknown, over " + list_of(discovery.depends_on);
    }
    std::vector<std::string> names;
    for (const FoundEffect& effect : discovery.effects) {
        names.push_back(effect.name);
    }
    std::string text = list_of(names);
    for (const FoundEffect& rival : discovery.alternatives) {
        text += is_tied(discovery, rival) ? ", or " + rival.name : "";
    }
    return text;
}

namespace {

/// Of a verdict "none" whose probability is stated.
bool is_unsure(const Discovery& discovery) {
    return discovery.mended.empty() && discovery.none_probability > 0 && discovery.none_probability < 0.5;
}

}  // namespace

std::string headline(const Discovery& discovery) {
    if (discovery.verdict == "none") {
        return discovery.structure || discovery.rest.or_noise_figure || is_unsure(discovery)
                   ? "No effect is named"
                   : "Nothing is missing from the model";
    }
    if (discovery.verdict == "unknown") {
        return "Something is missing that the catalogue does not know: it depends on " + list_of(discovery.depends_on);
    }
    std::string text = verdict_names(discovery);
    std::replace(text.begin(), text.end(), '_', ' ');
    return "The model lacks: " + text;
}

std::string horizon_text(double horizon) {
    return horizon <= 0 ? "" : std::isinf(horizon) ? " in free run" : " over " + core::format_number(horizon, 3) + " s";
}

std::string axis_text(const AxisResidual& axis) {
    return "The model lacks of " + axis.quantity + ": " + core::format_number(axis.rms_before, 3) + " " + axis.unit +
           " (rms, mean " + core::format_number(axis.mean_before, 3) + "), with what was found " +
           core::format_number(axis.rms_after, 3) + " " + axis.unit + "; noise in it " +
           core::format_number(axis.sigma, 2) + " " + axis.unit;
}

LimitsText limits_text(const std::vector<DetectionLimit>& limits) {
    constexpr std::size_t most = 6;
    LimitsText text;
    for (const DetectionLimit& limit : limits) {
        if (std::isfinite(limit.value) && text.lines.size() < most) {
            text.lines.push_back(limit.name + ": " + limit.parameter + " " +
                                 value_text({limit.parameter, limit.value, 0, limit.unit}));
        }
    }
    if (!text.lines.empty()) {
        text.heading =
            "Smallest effects that would stand out of the noise of the fitted data, nine times in ten (all of them in "
            "the report; to be named an effect must lower the error of held-out data, too):";
    }
    return text;
}

namespace {

std::string settling_text(double chance) {
    const std::string percent = chance > 0.995   ? "above 99 %"
                                : chance < 0.005 ? "below 1 %"
                                                 : core::format_number(100 * chance, 2) + " %";
    return chance < 0.5 ? "even this would settle it (odds of 20 to 1) with a chance of only " + percent
                        : "this settles it (odds of 20 to 1) with a chance of " + percent;
}

}  // namespace

std::string experiment_text(const std::string& purpose, const std::string& runs, double chance) {
    constexpr double hopeless = 0.05;
    return purpose + ": " +
           (chance < hopeless ? "no experiment of this kind on this rig settles it; the best that was found, " : "") +
           runs + "; " + settling_text(chance);
}

namespace {

/// A declared value that is off is called by its own name: "another value of the declared vehicle.mass: 2.31 +- 0.02
/// kg".
std::string named(const FoundEffect& effect) {
    if (effect.uses.size() == 1 && !effect.uses.front().parameter.empty() && effect.parameters.size() == 1) {
        const FoundParameter& value = effect.parameters.front();
        return "another value of the declared " + number_name(effect, value) + ": " + value_text(value);
    }
    std::string text = effect.name;
    for (std::size_t k = 0; k < effect.parameters.size(); ++k) {
        text += (k == 0 ? " (" : ", ") + effect.parameters[k].name + " " + value_text(effect.parameters[k]) +
                (k + 1 == effect.parameters.size() ? ")" : "");
    }
    return text;
}

}  // namespace

std::string rest_sentence(const Discovery& discovery) {
    const UnexplainedRest& rest = discovery.rest;
    if (rest.is_noise || discovery.error.empty()) {
        return "";
    }
    const ErrorChange& chief = discovery.error.front();
    const bool random = rest.depends_on.empty() || rest.depends_on == std::vector<std::string>{"time"};
    return " A rest of " +
           core::counted_text(core::format_number(rest.unexplained / std::max(chief.noise, 1e-300), 3), "noise") +
           " is unexplained" +
           (random ? std::string(" and follows no variable that was measured, as a random disturbance would")
                   : ", over " + list_of(rest.depends_on)) +
           ".";
}

namespace {

/// "the bias of gap_sensor_bias differs from run to run: from -1.4 +- 0.2 mm in run-06 to 0.99 +- 0.2 mm in run-01"
std::string by_run_text(const DiffersByRun& one) {
    const auto [low, high] = std::minmax_element(one.value.begin(), one.value.end());
    const auto at = [&](std::vector<double>::const_iterator where) {
        const auto g = static_cast<std::size_t>(where - one.value.begin());
        return value_text({one.parameter, one.value[g], one.sigma[g], one.unit}) + " in " + one.runs[g];
    };
    return "the " + one.parameter + " of " + one.name + " differs from run to run: from " + at(low) + " to " + at(high);
}

/// Where a longer prediction, or that of another channel, is worse with what was found than without it: never silent.
std::string worse_elsewhere(const Discovery& discovery) {
    std::string text;
    for (std::size_t i = 1; i < discovery.error.size(); ++i) {
        const ErrorChange& change = discovery.error[i];
        if (!(change.after.rmse > allowed_rise * change.before.rmse)) {
            continue;
        }
        const std::string over = std::isinf(change.horizon) ? " in a free run"
                                 : change.horizon > 0       ? " over " + core::format_number(change.horizon, 3) + " s"
                                                            : "";
        text += (text.empty() ? " But that of " : ", and that of ") + change.channel + over + " rises from " +
                core::format_number(change.before.rmse, 3) + " to " + core::format_number(change.after.rmse, 3) + " " +
                change.unit;
    }
    const bool longer = !text.empty() && discovery.error.front().horizon > 0;
    return text.empty() ? text
                        : text + (longer ? ": predictions as long as that are no better with what was found." : ".");
}

bool is_fitted(const std::string& held_out) { return held_out == fitted_runs || held_out == fitted_readings; }

/// What the data cannot tell from the verdict.
std::string rivals_of(const Discovery& discovery) {
    std::string text;
    for (const FoundEffect& rival : discovery.alternatives) {
        if (is_tied(discovery, rival)) {
            text += " These data cannot well tell it from " + rival.name + " (" +
                    core::format_number(rival.probability, 2) + ").";
        }
    }
    return text;
}

std::string unknown_sentence(const Discovery& discovery, const std::string& error) {
    if (discovery.by_run) {
        return "Something real is missing that is not the same in all runs: " + by_run_text(*discovery.by_run) +
               ". The model is as declared: what one run shows says nothing of the next.";
    }
    const bool corrected = std::any_of(discovery.effects.begin(), discovery.effects.end(),
                                       [](const FoundEffect& effect) { return !effect.uses.empty(); });
    const bool over_time = discovery.depends_on == std::vector<std::string>{"time"};
    constexpr double sure = 0.9;  // a sentence without a number says no less
    const double chance = discovery.effects.empty() ? 1 : discovery.effects.front().probability;
    return "Something real is missing that no effect of the catalogue explains; it depends on " +
           list_of(discovery.depends_on) +
           (chance < sure ? " (probability " + probability_text(chance) + ")." : std::string(".")) +
           rivals_of(discovery) +
           (corrected   ? " A smooth correction was put into the model." + error
            : over_time ? " The model is as declared: what one record did over time says nothing of the next."
                        : " The model is as declared: no correction lowers the error" + error_is_on(discovery) +
                              " beyond its interval.");
}

/// What was fitted holds more than noise, and nothing that was tried predicts other data better.
std::string unconfirmed_sentence(const Discovery& discovery) {
    return "No effect is named: the error" + error_is_on(discovery) +
           " is that of noise, and nothing that was tried lowers it beyond its interval. What was fitted holds more "
           "structure than noise would (chance " +
           core::format_number(discovery.gate, 2) + ")" +
           (discovery.alternatives.empty() ? std::string()
                                           : "; nearest to it is " + named(discovery.alternatives.front())) +
           "." +
           (discovery.mended.empty() ? "" : " The logs were read anew: " + discovery.mended + "; the model says so.");
}

/// Readings that scatter by more than their declared noise, and follow nothing.
std::string noise_or_missing_sentence(const Discovery& discovery) {
    const ErrorChange& chief = discovery.error.front();
    return "No effect is named: " + chief.channel + error_is_on(discovery) + " scatters by " +
           core::format_number(chief.before.rmse / std::max(chief.noise, 1e-300), 2) +
           " of its declared noise and follows no variable that was measured. The noise figure is too small, or "
           "something is missing that looks like noise: without repeats of set points this cannot be told. Measure "
           "some set points several times.";
}

/// Too little structure for a name, and too much to be sure that nothing is missing.
std::string unsure_sentence(const Discovery& discovery) {
    return "No effect is named, and it is not sure that nothing is missing: the chance of as much structure in noise "
           "is " +
           core::format_number(discovery.gate, 2) + ", too much for a name" +
           (discovery.alternatives.empty() ? std::string() : "; nearest is " + named(discovery.alternatives.front())) +
           ". More readings would tell.";
}

}  // namespace

std::string error_is_on(const Discovery& discovery) { return error_is_on(discovery.held_out); }

std::string error_is_on(const std::string& held_out) {
    return is_fitted(held_out) ? " on the data it was fitted to" : " on held-out data";
}

std::string verdict_sentence(const Discovery& discovery) {
    const std::string error =
        discovery.error.empty() || (discovery.verdict == "none" && discovery.mended.empty())
            ? ""
            : (is_fitted(discovery.held_out) ? " On the data it was fitted to" : " On held-out data") +
                  std::string(" the error of ") + discovery.error.front().channel +
                  (discovery.error.front().after.rmse > discovery.error.front().before.rmse ? " rises from "
                                                                                            : " falls from ") +
                  error_text(discovery.error.front()) + "." + worse_elsewhere(discovery);
    if (discovery.verdict == "none" && discovery.rest.or_noise_figure && !discovery.error.empty()) {
        return noise_or_missing_sentence(discovery);
    }
    if (discovery.verdict == "none" && discovery.structure) {
        return unconfirmed_sentence(discovery) + error;
    }
    if (discovery.verdict == "none" && is_unsure(discovery)) {
        return unsure_sentence(discovery);
    }
    if (discovery.verdict == "none") {
        return (discovery.mended.empty()
                    ? std::string("Nothing is missing")
                    : "Nothing is missing once the logs are read right (" + discovery.mended + "; the model says so)") +
               ": what the model leaves looks like noise (chance of as much structure in noise: " +
               core::format_number(discovery.gate, 2) + ")." + error;
    }
    if (discovery.verdict == "unknown") {
        return unknown_sentence(discovery, error) + rest_sentence(discovery);
    }
    std::string text = "The model lacks ";
    for (std::size_t i = 0; i < discovery.effects.size(); ++i) {
        text += (i == 0 ? "" : " and ") + named(discovery.effects[i]);
    }
    text += ", probability " + probability_text(discovery.effects.front().probability) + ".";
    return text + rivals_of(discovery) + error + rest_sentence(discovery);
}

}  // namespace underbody::discovery
