#include "surrogates/discovery/heave/heave_experiment_design.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

namespace {

/// A run that the rig could make: an input force over time, from a gap at rest.
struct Trial {
    std::string text;
    double gap = 0;
    std::vector<double> time;
    std::vector<double> input;
    double separation = 0;  ///< root of the summed squares of the difference over the noise
};

std::vector<Trial> trials(const HeaveExperiment& experiment) {
    std::vector<double> gaps, forces;
    for (const std::size_t r : experiment.chosen()) {
        const HeaveRecord& record = experiment.records().records[r];
        std::copy_if(record.gap.begin(), record.gap.end(), std::back_inserter(gaps),
                     [](double x) { return std::isfinite(x); });
        forces.insert(forces.end(), record.raw_input.begin(), record.raw_input.end());
    }
    const double middle = median(forces);
    const double size =
        std::max(0.5 * (quantile(forces, 0.95) - quantile(forces, 0.05)), 0.1 * std::abs(middle) + 1e-4);
    std::vector<Trial> list;
    for (const double share : {0.1, 0.5, 0.9}) {
        const double gap = quantile(gaps, share);
        for (const double frequency : {0.0, 0.1, 0.3, 0.8, 2.0}) {
            Trial trial;
            trial.gap = gap;
            const double strength = frequency > 0.5 ? 2 * size : size;
            trial.text = frequency == 0 ? "steps of the input force of +-" + core::format_number(1000 * strength, 2) +
                                              " mN every second"
                                        : "a sine of the input force of " + core::format_number(1000 * strength, 2) +
                                              " mN at " + core::format_number(frequency, 2) + " Hz";
            trial.text += " about the holding force, from " + core::format_number(1000 * gap, 3) + " mm";
            // the force that holds the body there, from the nearest record's own model
            const HeaveRecord& record = experiment.records().records[experiment.chosen().front()];
            const double holding = -record.plant->terms.constant -
                                   (record.plant->lift_curve().empty() ? 0 : record.plant->lift_curve()(gap));
            for (int k = 0; k <= 250; ++k) {
                const double t = 0.04 * k;
                trial.time.push_back(t);
                const double wave = frequency == 0 ? (static_cast<int>(t) % 2 == 0 ? 1.0 : -1.0)
                                                   : std::sin(2 * std::numbers::pi * frequency * t);
                trial.input.push_back(holding + strength * wave);
            }
            list.push_back(std::move(trial));
        }
    }
    return list;
}

/// The recorded runs themselves can be asked too; here only what has not been done: free runs of ten seconds in windows
/// of two.
void separate(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& a,
              const std::vector<dynamics::EffectUse>& b, Trial& trial) {
    HeaveRecord record;
    const std::size_t like = experiment.chosen().front();
    record.plant = experiment.records().records[like].plant;
    record.lift_factor = experiment.records().records[like].lift_factor;
    record.time = record.raw_time = trial.time;
    record.raw_input = trial.input;
    std::vector<double> input, first, second;
    double sum = 0;
    const HeaveExplanation one = experiment.explanation(like, a);
    const HeaveExplanation other = experiment.explanation(like, b);
    std::vector<double> input_b;
    transform_input(record, one, input);
    transform_input(record, other, input_b);
    constexpr std::size_t window = 50;
    for (std::size_t begin = 0; begin + window < trial.time.size(); begin += window) {
        // both start from one true state as read by a perfect sensor; an offset of the sensor alone cannot be seen in a
        // start
        free_run(record, one, input, begin, begin + window, trial.gap, 0, first);
        free_run(record, other, input_b, begin, begin + window,
                 trial.gap - (other.terms.sensor_bias - one.terms.sensor_bias), 0, second);
        for (std::size_t k = 1; k < first.size(); ++k) {
            const double difference = (first[k] - second[k]) / (experiment.noise().gap / std::sqrt(2.0));
            sum += std::min(difference * difference, 1e4);
        }
    }
    trial.separation = std::sqrt(sum);
}

std::vector<Trial> separated(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& a,
                             const std::vector<dynamics::EffectUse>& b) {
    std::vector<Trial> list = trials(experiment);
    for (Trial& trial : list) {
        separate(experiment, a, b, trial);
    }
    std::sort(list.begin(), list.end(), [](const Trial& x, const Trial& y) { return x.separation > y.separation; });
    return list;
}

bool delays_only(const FittedHypothesis& one, const dynamics::Model& model) {
    return one.hypothesis.names.size() == 1 && touch_of(one.hypothesis, model).delay;
}

}  // namespace

std::string heave_told_apart(const HeaveExperiment& experiment, const FittedHypothesis& chosen,
                             const FittedHypothesis& rival) {
    if (delays_only(chosen, experiment.model()) && delays_only(rival, experiment.model()) &&
        !experiment.records().velocity_measured) {
        return "from recorded input to gap reading a delay before the body and one behind it are the same: measure "
               "heave_velocity as well "
               "(or move the body by hand at zero input), then a late gap sensor shows against the velocity";
    }
    const std::vector<Trial> list = separated(experiment, chosen.hypothesis.with(chosen.fit.parameters),
                                              rival.hypothesis.with(rival.fit.parameters));
    if (list.front().separation < 0.5) {
        return "no run of the input force tells them apart with these sensors; measure another channel "
               "(heave_velocity, the force itself)";
    }
    return list.front().text + ": they differ there by " + core::format_number(list.front().separation, 3) +
           " standard deviations in 10 s";
}

void next_heave_experiment(const HeaveExperiment& experiment, const std::vector<FittedHypothesis>& fitted,
                           const Attribution& attribution, Discovery& result) {
    if (attribution.shares.empty()) {
        result.next_experiment = "runs with more motion";
        return;
    }
    const FittedHypothesis& best = fitted[attribution.shares.front().hypothesis];
    std::vector<dynamics::EffectUse> a = best.hypothesis.with(best.fit.parameters);
    std::vector<dynamics::EffectUse> b;
    std::string purpose;
    if (result.verdict == "effect" && attribution.shares.size() > 1) {
        const FittedHypothesis& rival = fitted[attribution.shares[1].hypothesis];
        b = rival.hypothesis.with(rival.fit.parameters);
        purpose = "to tell " + best.hypothesis.label() + " from " + rival.hypothesis.label();
        if (delays_only(best, experiment.model()) && delays_only(rival, experiment.model())) {
            result.next_experiment = purpose + ": " + heave_told_apart(experiment, best, rival);
            return;
        }
    } else if (result.verdict == "none") {
        std::vector<double> p = best.fit.parameters;
        p.front() += 3 * (std::isfinite(best.fit.sigma.front()) ? best.fit.sigma.front() : 0.0);
        a = best.hypothesis.with(p);
        purpose = "to see " + best.hypothesis.label() + " below today's limit";
    } else if (result.verdict == "unknown") {
        purpose = "to see the law behind what depends on " + list_of(result.depends_on);
    } else {
        purpose = "to confirm " + best.hypothesis.label();
    }
    const std::vector<Trial> list = separated(experiment, a, b);
    const Trial& trial = list.front();
    const double repeats = 8;
    result.next_power = chance_to_settle(trial.separation * std::sqrt(repeats));
    result.next_experiment =
        experiment_text(purpose, trial.text + ", 10 s, " + core::format_number(repeats, 2) + " times",
                        result.next_power) +
        " (next-experiment.csv; holding force by the declared model, a controller may be added to it)";
    result.next_set_points.add_numbers("time", "s", trial.time);
    result.next_set_points.add_numbers("input_force", "N", trial.input);
}

}  // namespace underbody::discovery
