// What a verdict on heave with pitch is told with: error before and after of each axis, residual loads, consequences.
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/discovery/consequence.h"
#include "surrogates/discovery/heave_pitch/pitch_loop.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

/// Every measured channel over one and five horizons; the channel whose error falls most, in its noise, first.
void PitchLoop::measure_error() {
    const std::size_t runs = test_data_.runs.size();
    double most = -1e300;
    std::size_t chief = 0;
    for (const double horizon : {options_.horizon, 5 * options_.horizon}) {
        const Answer before = answer_of({}, horizon), after = answer_of(uses_, horizon);
        if (before.all.record.empty() || after.all.record.empty()) {
            continue;
        }
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            ErrorChange change;
            change.channel = dynamics::channel_name(dynamics::pitch_channels[channels_[c]]);
            change.unit = dynamics::channel_unit(dynamics::pitch_channels[channels_[c]]);
            change.horizon = horizon;
            change.noise = null_noise_.total(channels_[c]);
            const auto estimate = [&](const Answer& answer) {
                const BlockSquares sums = answer.windows[c].by_record(runs);
                return error_by_groups(sums.square, sums.count, options_.seed);
            };
            change.before = estimate(before);
            change.after = estimate(after);
            if (!std::isfinite(change.before.rmse) || !std::isfinite(change.after.rmse)) {
                continue;
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

/// Force and moment that the model lacks, as declared and as found, over the fitted runs.
void PitchLoop::measure_axes() {
    const auto residuals = [&](const std::vector<dynamics::EffectUse>& uses) {
        const dynamics::Model model = model_with(uses);
        std::array<std::vector<double>, 2> loads, sigmas;
        for (const PitchRecord& record : experiment_->records()) {
            dynamics::PitchRun run(model, data_.runs[record.run], model.records);
            PitchNoise noise = null_noise_;
            noise.force = noise.moment = 0;
            walk_of_loads(run.plant(), noise);
            const SmoothedPitchRun smoothed = smooth_pitch(run, record, noise);
            loads[0].insert(loads[0].end(), smoothed.force.begin(), smoothed.force.end());
            loads[1].insert(loads[1].end(), smoothed.moment.begin(), smoothed.moment.end());
            sigmas[0].insert(sigmas[0].end(), smoothed.force_sigma.begin(), smoothed.force_sigma.end());
            sigmas[1].insert(sigmas[1].end(), smoothed.moment_sigma.begin(), smoothed.moment_sigma.end());
        }
        return std::pair(loads, sigmas);
    };
    const auto before = residuals({}), after = uses_.empty() ? before : residuals(uses_);
    for (const std::size_t axis : {0U, 1U}) {
        AxisResidual one;
        one.quantity = axis == 0 ? "lift_force" : "pitch_moment";
        one.unit = axis == 0 ? "N" : "N m";
        one.mean_before = mean(before.first[axis]);
        one.rms_before = root_mean_square(before.first[axis]);
        one.mean_after = mean(after.first[axis]);
        one.rms_after = root_mean_square(after.first[axis]);
        one.sigma = root_mean_square(before.second[axis]);
        result_.axes.push_back(one);
    }
}

/// Share of resampled runs in which the chosen names have the least score.
double PitchLoop::stability() const {
    if (result_.verdict != "effect") {
        return result_.verdict == "none" ? result_.none_probability : attribution_.unknown_probability;
    }
    return share_of_draws(null_by_record_.size(), options_.seed + 1, [&](const std::vector<double>& weight) {
        return best_in_draw(attribution_, fitted_, weight) == attribution_.chosen;
    });
}

Consequence PitchLoop::consequence() const {
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
            for (const dynamics::HeaveEquilibrium& e : dynamics::HeavePitch(model, held).equilibria()) {
                list.push_back({e.name, e.stable, e.gap});
            }
            return list;
        };
        found.equilibria = paired(balances(model_), balances(result_.model));
        found.text = "Equilibria in heave and pitch together, without input; no map of starts is drawn.";
    });
    return found;
}

void PitchLoop::describe() {
    const bool coloured = null_noise_.gap_slow > 0 || null_noise_.pitch_slow > 0;
    for (const std::size_t i : channels_) {
        const std::string name = dynamics::channel_name(dynamics::pitch_channels[i]);
        result_.noise[name] = {
            null_noise_.total(i), dynamics::channel_unit(dynamics::pitch_channels[i]),
            std::string("fitted") + (data_.declared_noise(name) ? ", begun at the declared one" : "") +
                (coloured && (i == 0 || i == 2)
                     ? ", in part with a correlation time of " + core::format_number(null_noise_.slow_time, 2) + " s"
                     : ""),
            dynamics::pitch_noise(data_, data_.runs[experiment_->records().front().run])[i]};
    }
    result_.stability = stability();
    tell({fitted_, attribution_, whole_, rest_.fit, rest_.share, uses_, "a smooth load", evidence_of_runs,
          [](const FittedHypothesis&, const FittedHypothesis& rival) {
              return "runs in which " + list_of(rival.hypothesis.depends_on) + " is excited apart from the rest";
          }},
         result_);
    const bool tied =
        result_.verdict == "effect" && !result_.alternatives.empty() && result_.alternatives.front().probability > 0.2;
    result_.next_experiment =
        tied ? "To tell " + result_.effects.front().name + " from " + result_.alternatives.front().name + ": " +
                   result_.alternatives.front().told_apart_by + "."
             : "No further experiment is designed for heave with pitch; runs at other gaps, pitches and inputs would "
               "show effects below the limits given here.";
    result_.problems.insert(result_.problems.end(), data_.problems.begin(), data_.problems.end());
    result_.problems.push_back({core::Problem::Severity::note,
                                "heave and pitch together: waves, forces with memory and numbers that differ from run "
                                "to run are not looked for, and no smooth correction is put into the model",
                                core::Place{data_.folder.string(), {}, {}, {}}});
    if (options_.consequence) {
        result_.consequence = consequence();
    }
    result_.sentence = verdict_sentence(result_);
}

}  // namespace underbody::discovery
