// Is anything there, and is anything left? Linearised answers of named effects and of smooth loads, judged against
// reordered innovations.
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "surrogates/discovery/by_run.h"
#include "surrogates/discovery/motion/motion_loop.h"
#include "surrogates/discovery/noise_chance.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

/// Each load over every variable, over time, and over two variables together.
std::vector<MotionSmooth> MotionLoop::smooth_loads() const {
    std::vector<MotionSmooth> list;
    const std::vector<dynamics::MotionShape::Variable>& variables = shape().variables;
    for (std::size_t axis = 0; axis < shape().loads.size(); ++axis) {
        list.push_back({axis, {}, {}});
        for (const dynamics::MotionShape::Variable& one : variables) {
            list.push_back({axis, {one.quantity}, {6}});
        }
        list.push_back({axis, {"time"}, {6}});
        const auto& [a, b] = shape().together;
        list.push_back({axis, {variables[a].quantity, variables[b].quantity}, {4, 3}});
    }
    return list;
}

std::vector<MotionLoop::Probe> MotionLoop::probes(const std::vector<dynamics::EffectUse>& uses,
                                                  const MotionNoise& noise, const DesignMatrix& own) const {
    std::vector<double> innovations;
    std::vector<MotionTrace> traces;
    experiment_->evaluate(uses, noise, innovations, nullptr, &traces);
    const DesignMatrix taken = orthonormal(own);
    std::vector<Probe> list;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const bool inside = std::any_of(uses.begin(), uses.end(), [&](const auto& use) {
            return use.name == candidates_[i].names.front() && use.parameter == candidates_[i].uses.front().parameter;
        });
        if (!inside) {
            list.emplace_back();
            list.back().candidate = i;
        }
    }
    for (const MotionSmooth& load : smooth_loads()) {
        list.emplace_back();
        list.back().smooth = load;
    }
    core::parallel_for(
        list.size(),
        [&](std::size_t k) {
            Probe& probe = list[k];
            DesignMatrix matrix;
            const std::vector<std::vector<double>> steps =
                !probe.smooth ? small_steps(candidates_[probe.candidate]) : std::vector<std::vector<double>>{};
            matrix = probe.smooth ? experiment_->answers(*probe.smooth, traces)
                                  : experiment_->answers(candidates_[probe.candidate], steps, uses, noise, innovations);
            if (!std::all_of(matrix.values.begin(), matrix.values.end(), [](double x) { return std::isfinite(x); })) {
                return;
            }
            probe.columns = orthonormal_beside(taken, matrix);
            probe.gain = explained_square(probe.columns, innovations);
            probe.surprise = surprise(probe.gain, static_cast<double>(probe.columns.columns));
            if (!probe.smooth && steps.size() == 1) {
                const FitParameter& p = candidates_[probe.candidate].parameters.front();
                double jj = 0, jr = 0;
                for (std::size_t i = 0; i < innovations.size(); ++i) {
                    jj += matrix.values[i] * matrix.values[i];
                    jr += matrix.values[i] * innovations[i];
                }
                probe.numbers = {jj > 0 ? p.start - (steps.front().front() - p.start) * jr / jj : p.start};
            }
        },
        progress_);
    return list;
}

double MotionLoop::chance_in_noise(const std::vector<const DesignMatrix*>& columns,
                                   const std::vector<double>& noise_like, double observed, std::uint64_t stream) const {
    double seconds = 0;
    for (const MotionRecord& record : experiment_->records()) {
        const std::vector<double>& time = data_.runs[record.run].table.numbers("time");
        seconds += time[record.last] - time[record.first];
    }
    const auto second = static_cast<std::size_t>(static_cast<double>(noise_like.size()) / std::max(seconds, 1e-9));
    return chance_among(columns, noise_like, observed, second, options_.seed + stream, progress_);
}

void MotionLoop::open_gate() {
    double observed = 0;
    for (const FittedHypothesis& one : fitted_) {
        double own = surprise(one.explained, static_cast<double>(one.hypothesis.parameters.size()));
        own -= is_scanned(one.hypothesis) ? std::log10(frequencies_tried) : 0;
        observed = std::max(observed, own);
    }
    if (!fitted_.empty()) {
        gate_ = chance_in_noise(columns_of(probes_), fitted_[best_single_].fit.residuals, observed, 0);
    }
    const Probe* most = nullptr;
    const auto worth = [&](const Probe& probe) {
        return probe.gain - calibration_.column_price * static_cast<double>(probe.columns.columns);
    };
    for (const Probe& probe : probes_) {
        if (probe.smooth && (most == nullptr || worth(probe) > worth(*most))) {
            most = &probe;
        }
    }
    if (most == nullptr) {
        return;
    }
    likeliest_smooth_ = most->smooth;
    whole_.variables = most->smooth->variables;
    whole_.gain = most->gain;
    whole_.degrees = static_cast<double>(most->columns.columns);
    if (gate_ >= calibration_.gate &&
        most->surprise > calibration_.smooth_surprise) {  // a law that no named effect resembles
        std::vector<double> left = null_innovations_;
        take_out(most->columns, left);
        gate_ = std::min(gate_, chance_in_noise(columns_of(probes_), left, most->surprise, 0));
    }
    whole_.p = gate_;
}

void MotionLoop::look_run_by_run() {
    RunsInnovations runs{null_innovations_, experiment_->begins(), {}};
    for (const MotionRecord& record : experiment_->records()) {
        runs.runs.push_back(record.name);
    }
    ByRunQuestions ask;
    ask.innovations = [&](const std::vector<dynamics::EffectUse>& uses) {
        std::vector<double> there;
        experiment_->evaluate(uses, null_noise_, there);
        return there;
    };
    ask.chance = [&](const std::vector<const DesignMatrix*>& columns, const std::vector<double>& left,
                     double surprise) { return chance_in_noise(columns, left, surprise, 2); };
    ask.law = gate_ < calibration_.gate ? surprise(whole_.gain, whole_.degrees) : 0;
    result_.by_run = number_by_run(candidates_, runs, ask, calibration_);
}

MotionLoop::Rest MotionLoop::rest_beside(const FittedHypothesis& base, const MotionNoise& noise) const {
    const std::vector<dynamics::EffectUse> uses = base.hypothesis.with(base.fit.parameters);
    DesignMatrix own;
    own.rows = base.fit.residuals.size();
    for (std::size_t j = 0; j < base.fit.parameters.size(); ++j) {
        std::vector<double> moved = base.fit.parameters;
        const FitParameter& p = base.hypothesis.parameters[j];
        moved[j] += (moved[j] + 0.02 * p.typical > p.upper ? -0.02 : 0.02) * p.typical;
        const DesignMatrix column = experiment_->answers(base.hypothesis, {moved}, {}, noise, base.fit.residuals);
        own.values.insert(own.values.end(), column.values.begin(), column.values.end());
        ++own.columns;
    }
    const std::vector<Probe> list = probes(uses, noise, own);
    Rest rest;
    rest.fit.p = 1;
    std::vector<const Probe*> second;
    const Probe* most = nullptr;
    for (const Probe& probe : list) {
        if (!probe.smooth) {
            second.push_back(&probe);
        } else if (most == nullptr || probe.surprise > most->surprise) {
            most = &probe;
        }
    }
    std::sort(second.begin(), second.end(), [](const Probe* a, const Probe* b) { return a->surprise > b->surprise; });
    for (const Probe* probe : second) {
        if (probe->surprise > calibration_.rest_surprise) {
            rest.second.push_back(probe->candidate);
        }
    }
    if (most != nullptr && most->surprise > calibration_.rest_surprise) {
        rest.fit.variables = most->smooth->variables;
        rest.fit.gain = most->gain;
        rest.fit.degrees = static_cast<double>(most->columns.columns);
        std::vector<double> left = base.fit.residuals;
        take_out(most->columns, left);
        rest.fit.p = chance_in_noise(columns_of(list), left, most->surprise, 1);
        rest.share = structure_left(rest.fit, base.explained);
    }
    return rest;
}

/// A second to a fourth effect, one at a time, where the best set so far leaves structure that noise does not make.
void MotionLoop::fit_further() {
    constexpr std::size_t tried = 4;
    for (std::size_t count = 2; count <= static_cast<std::size_t>(calibration_.most_effects); ++count) {
        const std::size_t base = best_hypothesis(fitted_, count - 1);
        if (base >= fitted_.size() || fitted_[base].hypothesis.names.size() + 1 != count || rest_.second.empty()) {
            return;
        }
        std::vector<FittedHypothesis> found(std::min(tried, rest_.second.size()));
        std::vector<MotionNoise> noises(found.size());
        core::parallel_for(
            found.size(),
            [&](std::size_t k) {
                const Hypothesis& next = candidates_[rest_.second[k]];
                const std::vector<std::vector<double>> seconds =
                    next.starts.empty() ? std::vector<std::vector<double>>{next.start()} : next.starts;
                std::vector<std::vector<double>> starts;
                for (const std::vector<double>& begin : seconds) {
                    starts.push_back(fitted_[base].fit.parameters);
                    starts.back().insert(starts.back().end(), begin.begin(), begin.end());
                }
                const Hypothesis both =
                    joined(fitted_[base].hypothesis, fitted_[base].hypothesis.start(), next, next.start());
                MotionExperiment::Result result = fitted(both, starts, noises_[base]);
                found[k] = std::move(result.fitted);
                noises[k] = result.noise;
            },
            progress_);
        const std::size_t best = best_finding(found, count, calibration_.neutral_sigmas);
        if (best == found.size()) {
            return;
        }
        const double kin = one_kin(found[best].hypothesis.names) ? calibration_.kin_share : 1;
        const double gain = fitted_[base].score() - found[best].score();
        if (gain < calibration_.pair_gain || gain < kin * calibration_.pair_share * found[best].explained) {
            return;
        }
        rest_ = rest_beside(found[best], noises[best]);
        for (std::size_t k = 0; k < found.size(); ++k) {
            if (found[k].hypothesis.names.size() == count) {
                fitted_.push_back(std::move(found[k]));
                noises_.push_back(noises[k]);
            }
        }
    }
}

}  // namespace underbody::discovery
