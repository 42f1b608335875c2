// What a verdict on a coupled motion is told with: error before and after of each axis, residual loads, consequences.
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/discovery/consequence.h"
#include "surrogates/discovery/motion/motion_experiment_design.h"
#include "surrogates/discovery/motion/motion_loop.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::discovery {

/// Every measured channel over one and five horizons; the channel whose error falls most, in its noise, first. Before:
/// the model as declared with its logs taken at their word, but for what inputs did between their samples.
void MotionLoop::measure_error() {
    const std::size_t runs = test_data_.runs.size();
    double most = -1e300;
    std::size_t chief = 0;
    dynamics::RecordReading as_declared = model_.records;
    as_declared.input_between = experiment_->reading().input_between;
    for (const double horizon : {options_.horizon, 5 * options_.horizon}) {
        const Answer before = answer_of({}, horizon, as_declared, test_data_), after = answer_of(uses_, horizon);
        if (before.windows.front().record.empty() || after.windows.front().record.empty()) {
            continue;
        }
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            ErrorChange change;
            change.channel = shape().states[channels_[c]].channel;
            change.unit = shape().states[channels_[c]].unit;
            change.horizon = horizon;
            change.noise =
                dynamics::unit_of_errors(data_.declared_noise(change.channel), null_noise_.total(channels_[c]));
            const auto estimate = [&](const Answer& answer) {
                const BlockSquares sums = answer.windows[c].by_record(runs);
                return error_by_groups(sums.square, sums.count, options_.seed);
            };
            change.before = estimate(before);
            change.after = estimate(after);
            if (!std::isfinite(change.before.rmse) || !std::isfinite(change.after.rmse) || change.before.count == 0) {
                continue;  // no held-out run has it
            }
            const double fall = (change.before.rmse - change.after.rmse) / change.noise;
            if (horizon == options_.horizon && fall > most) {
                most = fall;
                chief = result_.error.size();
            }
            result_.error.push_back(change);
        }
    }
    if (!result_.error.empty()) {
        std::rotate(result_.error.begin(), result_.error.begin() + static_cast<std::ptrdiff_t>(chief),
                    result_.error.begin() + static_cast<std::ptrdiff_t>(chief) + 1);
        // the rest is told in noises, and its unit is that of the first error
        result_.rest.twins *= result_.error.front().noise;
        result_.rest.unexplained *= result_.error.front().noise;
    }
}

/// Loads that the model lacks, as declared and as found, over the fitted runs.
void MotionLoop::measure_axes() {
    const auto residuals = [&](const std::vector<dynamics::EffectUse>& uses) {
        const dynamics::Model model = model_with(uses);
        std::vector<std::vector<double>> loads(shape().loads.size()), sigmas(shape().loads.size());
        for (const MotionRecord& record : experiment_->records()) {
            const auto run = motion_.run(model, data_.runs[record.run], model.records);
            MotionNoise noise = null_noise_;
            noise.load = {};
            walk_of_loads(*run, noise);
            const SmoothedMotion smoothed = smooth_motion(*run, record, noise);
            for (std::size_t l = 0; l < loads.size(); ++l) {
                for (std::size_t k = 0; k < smoothed.time.size(); ++k) {
                    loads[l].push_back(smoothed.load[k][l]);
                    sigmas[l].push_back(smoothed.load_sigma[k][l]);
                }
            }
        }
        return std::pair(loads, sigmas);
    };
    const auto before = residuals({}), after = uses_.empty() ? before : residuals(uses_);
    for (std::size_t axis = 0; axis < shape().loads.size(); ++axis) {
        AxisResidual one;
        one.quantity = shape().loads[axis].quantity;
        one.unit = shape().loads[axis].unit;
        one.mean_before = mean(before.first[axis]);
        one.rms_before = root_mean_square(before.first[axis]);
        one.mean_after = mean(after.first[axis]);
        one.rms_after = root_mean_square(after.first[axis]);
        one.sigma = root_mean_square(before.second[axis]);
        result_.axes.push_back(one);
    }
}

/// Share of resampled runs in which the chosen names have the least score.
double MotionLoop::stability() const {
    if (result_.verdict != "effect") {
        return result_.verdict == "none" ? result_.none_probability : attribution_.unknown_probability;
    }
    return share_of_draws(null_by_record_.size(), options_.seed + 1, [&](const std::vector<double>& weight) {
        return best_in_draw(attribution_, fitted_, weight) == attribution_.chosen;
    });
}

Consequence MotionLoop::consequence() const {
    Consequence found;
    map_if_possible(found, [&] {
        const auto balances = [&](const dynamics::Model& model) {
            dynamics::Conditions held;
            for (const auto& [name, value] : data_.runs[experiment_->records().front().run].conditions) {
                dynamics::Channel channel{};
                if (dynamics::find_channel(name, channel)) {
                    held[channel] = value;
                }
            }
            std::vector<Balance> list;
            for (const dynamics::HeaveEquilibrium& e : motion_.equilibria(model, held)) {
                list.push_back({e.name, e.stable, e.gap});
            }
            return list;
        };
        found.equilibria = paired(balances(model_), balances(result_.model));
        found.text = found.equilibria.empty()
                         ? ""
                         : "Equilibria in " + shape().words + ", without input; no map of starts is drawn.";
    });
    return found;
}

void MotionLoop::describe() {
    for (const std::size_t i : channels_) {
        const std::string name = shape().states[i].channel;
        result_.noise[name] = {
            null_noise_.total(i), shape().states[i].unit,
            std::string("fitted") + (data_.declared_noise(name) ? ", begun at the declared one" : "") +
                (null_noise_.slow[i] > 0
                     ? ", in part with a correlation time of " + core::format_number(null_noise_.slow_time, 2) + " s"
                     : ""),
            dynamics::motion_noise(shape(), data_, data_.runs[experiment_->records().front().run])[i]};
    }
    result_.stability = stability();
    const MotionRig made_with{motion_, model_with({}), data_, experiment_->records(), inputs_, channels_, null_noise_};
    tell({fitted_, attribution_, whole_, rest_.fit, rest_.share, uses_, "a smooth force", evidence_of_runs,
          [&](const FittedHypothesis& chosen, const FittedHypothesis& rival) {
              return motion_told_apart(made_with, chosen, rival);
          }},
         result_);
    const std::optional<MotionQuestion> question = motion_question(made_with, fitted_, attribution_, result_);
    const std::vector<InputAnswer> answers = question ? read_controllers(made_with) : std::vector<InputAnswer>{};
    next_motion_experiment(
        made_with, question,
        [&](const MotionTrial& trial, std::size_t repeats) {
            return promise_of(made_with, trial, answers, *question, repeats);
        },
        result_);
    for (const core::Problems& more : {data_.problems, dynamics::taken_as_zero(shape().name, model_, data_)}) {
        result_.problems.insert(result_.problems.end(), more.begin(), more.end());
    }
    const bool lifts = std::any_of(shape().loads.begin(), shape().loads.end(),
                                   [](const auto& load) { return load.quantity == "lift_force"; });
    result_.problems.push_back(
        {core::Problem::Severity::note,
         shape().words + ": forces with memory are not looked for, and " +
             (lifts ? "of laws without a name one of the lift alone is put into the model, as a smooth correction"
                    : "no smooth correction is put into the model"),
         core::Place{data_.folder.string(), {}, {}, {}}});
    if (options_.consequence) {
        result_.consequence = consequence();
    }
    result_.sentence = verdict_sentence(result_);
}

}  // namespace underbody::discovery
