// Is anything there, and is anything left? Linearised answers of named effects and smooth forces, judged against
// reordered innovations.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/noise_chance.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

using Variable = FlexibleForce::Variable;

/// Laws of the gap may bend often, beside another variable too; those of velocity, input and time bend less.
const std::vector<HeaveExperiment::SmoothSet>& smooth_sets() {
    static const std::vector<HeaveExperiment::SmoothSet> sets{
        {{}, {}},
        {{Variable::gap}, {7}},
        {{Variable::gap}, {15}},
        {{Variable::heave_velocity}, {7}},
        {{Variable::time}, {7}},
        {{Variable::input_force}, {7}},
        {{Variable::gap, Variable::heave_velocity}, {6, 2}},
        {{Variable::gap, Variable::heave_velocity}, {12, 2}},
        {{Variable::gap, Variable::input_force}, {6, 2}},
        {{Variable::heave_velocity, Variable::input_force}, {3, 3}}};
    return sets;
}

/// The same variables with other columns, coarser and finer, for the correction that goes into a model.
std::vector<HeaveExperiment::SmoothSet> other_sets(const HeaveExperiment::SmoothSet& set) {
    std::vector<HeaveExperiment::SmoothSet> list;
    if (set.variables.size() == 1) {
        for (const std::size_t columns : {7U, 11U, 15U}) {
            list.push_back({set.variables, {columns}});
        }
    } else if (set.variables.size() == 2) {
        const bool gap = set.variables.front() == Variable::gap;
        for (const std::vector<std::size_t>& columns :
             gap ? std::vector<std::vector<std::size_t>>{{12, 1}, {12, 2}, {9, 4}, {6, 3}}
                 : std::vector<std::vector<std::size_t>>{{5, 5}}) {
            list.push_back({set.variables, columns});
        }
    }
    std::erase_if(list, [&](const auto& one) { return one.columns == set.columns; });
    return list;
}

/// Of an input that never changes (free runs with a column of noughts) no law can be seen.
bool input_changes(const HeaveRecords& records) {
    double low = INFINITY, high = -INFINITY;
    for (const HeaveRecord& record : records.records) {
        for (const double u : record.raw_input) {
            low = std::min(low, u);
            high = std::max(high, u);
        }
    }
    return high > low;
}

}  // namespace

std::vector<HeaveLoop::Probe> HeaveLoop::things_missing(const std::vector<dynamics::EffectUse>& uses,
                                                        bool named) const {
    std::vector<Probe> list;
    for (std::size_t i = 0; named && i < candidates_.size(); ++i) {
        const bool inside = std::any_of(uses.begin(), uses.end(),
                                        [&](const auto& use) { return use.name == candidates_[i].names.front(); });
        if (!inside) {
            list.emplace_back();
            list.back().candidate = i;
        }
    }
    const bool input_moves = records_.input_recorded && input_changes(records_);
    for (const HeaveExperiment::SmoothSet& set : smooth_sets()) {
        const bool possible = std::none_of(set.variables.begin(), set.variables.end(),
                                           [&](Variable v) { return v == Variable::input_force && !input_moves; });
        if (possible) {
            list.emplace_back();
            list.back().smooth = &set;
        }
    }
    return list;
}

DesignMatrix HeaveLoop::answers_of(const Probe& probe, const HeaveExperiment& experiment,
                                   const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise,
                                   const std::vector<double>& innovations) const {
    if (probe.smooth != nullptr) {
        return experiment.answers(experiment.flat_force(*probe.smooth, uses, noise), uses, noise, innovations);
    }
    DesignMatrix matrix;
    matrix.rows = innovations.size();
    std::vector<double> there;
    for (const std::vector<double>& p : small_steps(candidates_[probe.candidate])) {
        std::vector<dynamics::EffectUse> with = uses;
        for (dynamics::EffectUse& use : candidates_[probe.candidate].with(p)) {
            with.push_back(std::move(use));
        }
        experiment.evaluate(with, nullptr, noise, there);
        ++matrix.columns;
        for (std::size_t i = 0; i < there.size(); ++i) {
            matrix.values.push_back(there[i] - innovations[i]);
        }
    }
    return matrix;
}

std::vector<HeaveLoop::Probe> HeaveLoop::probes(const HeaveExperiment& experiment,
                                                const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise,
                                                const DesignMatrix& own, bool named) const {
    std::vector<double> innovations;
    experiment.evaluate(uses, nullptr, noise, innovations);
    const DesignMatrix taken = orthonormal(own);
    std::vector<Probe> list = things_missing(uses, named);
    core::parallel_for(list.size(), [&](std::size_t k) {
        Probe& probe = list[k];
        const DesignMatrix matrix = answers_of(probe, experiment, uses, noise, innovations);
        if (!std::all_of(matrix.values.begin(), matrix.values.end(), [](double x) { return std::isfinite(x); })) {
            return;
        }
        probe.columns = orthonormal_beside(taken, matrix);
        probe.gain = explained_square(probe.columns, innovations);
        probe.surprise = surprise(probe.gain, static_cast<double>(probe.columns.columns));
    });
    return list;
}

double HeaveLoop::chance_in_noise(const std::vector<const DesignMatrix*>& columns,
                                  const std::vector<double>& noise_like, double observed, std::uint64_t stream) const {
    const std::size_t second = static_cast<std::size_t>(1.0 / record_step) * (records_.velocity_measured ? 2 : 1);
    return chance_among(columns, noise_like, observed, second, options_.seed + stream, progress_);
}

void HeaveLoop::open_gate() {
    whole_list_.clear();
    const std::vector<Probe> list = probes(*experiment_, {}, null_noise_, {}, true);
    double observed = 0;
    for (std::size_t i = 0; i < singles_; ++i) {
        double own = surprise(fitted_[i].explained, static_cast<double>(fitted_[i].hypothesis.parameters.size()));
        if (is_scanned(fitted_[i].hypothesis)) {
            own -= std::log10(frequencies_tried);
        }
        observed = std::max(observed, own);
    }
    gate_ = named_gate_ = chance_in_noise(columns_of(list), fitted_[best_single_].fit.residuals, observed, 0);
    if (gate_ < calibration_.gate) {
        return;
    }
    // a law that no named effect resembles: the smooth forces that promise most, fitted to the end
    std::vector<const Probe*> smooth;
    for (const Probe& probe : list) {
        if (probe.smooth != nullptr) {
            smooth.push_back(&probe);
        }
    }
    std::sort(smooth.begin(), smooth.end(), [](const Probe* a, const Probe* b) { return a->surprise > b->surprise; });
    for (std::size_t k = 0;
         k < std::min<std::size_t>(2, smooth.size()) && smooth[k]->surprise > calibration_.smooth_surprise; ++k) {
        HeaveExperiment::Smooth fit = experiment_->fit_smooth(*smooth[k]->smooth, {}, null_noise_, null_cost_);
        const double gain = surprise(fit.fit.gain, fit.fit.degrees);
        gate_ = std::min(gate_, chance_in_noise(columns_of(list), fit.residuals, gain, 0));
        whole_list_.push_back(std::move(fit));
    }
}

HeaveLoop::Rest HeaveLoop::rest_beside(const FittedHypothesis& base, const HeaveNoise& noise) const {
    const std::vector<dynamics::EffectUse> uses = base.hypothesis.with(base.fit.parameters);
    const DesignMatrix own = experiment_->answers(base.hypothesis, base.fit.parameters, noise, base.fit.residuals);
    std::vector<Probe> list = probes(*experiment_, uses, noise, own, true);
    Rest rest;
    rest.fit.p = 1;
    std::vector<const Probe*> smooth, second;
    for (const Probe& probe : list) {
        (probe.smooth != nullptr ? smooth : second).push_back(&probe);
    }
    const auto more = [](const Probe* a, const Probe* b) { return a->surprise > b->surprise; };
    std::sort(smooth.begin(), smooth.end(), more);
    std::sort(second.begin(), second.end(), more);
    for (const Probe* probe : second) {
        if (probe->surprise > calibration_.rest_surprise) {
            rest.second.push_back(probe->candidate);
        }
    }
    std::vector<HeaveExperiment::Smooth> fits;
    for (std::size_t k = 0; k < std::min<std::size_t>(2, smooth.size()); ++k) {
        if (smooth[k]->surprise > calibration_.rest_surprise) {
            fits.push_back(experiment_->fit_smooth(*smooth[k]->smooth, uses, noise, base.cost));
        }
    }
    if (!fits.empty()) {
        const HeaveExperiment::Smooth& best = best_smooth(fits);
        rest.fit = best.fit;
        rest.fit.p = chance_in_noise(columns_of(list), best.residuals, surprise(best.fit.gain, best.fit.degrees), 1);
        rest.share = structure_left(rest.fit, base.explained);
    }
    return rest;
}

const HeaveExperiment::Smooth& HeaveLoop::best_smooth(const std::vector<HeaveExperiment::Smooth>& list) const {
    return *std::min_element(list.begin(), list.end(),
                             [&](const auto& a, const auto& b) { return smooth_score(a) < smooth_score(b); });
}

/// With Schwarz's price for each coefficient, as the named effects pay it.
double HeaveLoop::smooth_score(const HeaveExperiment::Smooth& one) const {
    return one.cost + std::log(static_cast<double>(experiment_->readings())) * one.fit.degrees;
}

void HeaveLoop::smooth_corrections() {
    const std::vector<Probe> list = probes(*experiment_, {}, null_noise_, {}, false);
    std::vector<const Probe*> order;
    for (const Probe& probe : list) {
        order.push_back(&probe);
    }
    const auto worth = [&](const Probe* probe) {
        return probe->gain - calibration_.column_price * static_cast<double>(probe->columns.columns);
    };
    std::sort(order.begin(), order.end(), [&](const Probe* a, const Probe* b) { return worth(a) > worth(b); });
    order.resize(std::min<std::size_t>(order.size(), 4));
    std::erase_if(order, [&](const Probe* probe) {  // those that opened the gate are fitted
        return std::any_of(whole_list_.begin(), whole_list_.end(),
                           [&](const auto& one) { return one.set == *probe->smooth; });
    });
    const std::size_t first = whole_list_.size();
    whole_list_.resize(first + order.size());
    core::parallel_for(
        order.size(),
        [&](std::size_t i) {
            whole_list_[first + i] = experiment_->fit_smooth(*order[i]->smooth, {}, null_noise_, null_cost_);
        },
        progress_);
    whole_ = best_smooth(whole_list_).fit;
    rest_ = rest_beside(fitted_[best_single_], noises_[best_single_]);
}

/// As fine as the runs left out ask for: what goes into a model should miss as little as it can.
HeaveExperiment::Smooth HeaveLoop::refined(const HeaveExperiment::Smooth& begin) const {
    const auto held_out = [](const HeaveExperiment::Smooth& one) {
        return std::accumulate(one.held_out.begin(), one.held_out.end(), 0.0);
    };
    const std::vector<HeaveExperiment::SmoothSet> sets = other_sets(begin.set);
    std::vector<HeaveExperiment::Smooth> finer(sets.size());
    core::parallel_for(
        sets.size(),
        [&](std::size_t k) {
            const auto known = std::find_if(whole_list_.begin(), whole_list_.end(),
                                            [&](const auto& one) { return one.set == sets[k]; });
            finer[k] =
                known != whole_list_.end() ? *known : experiment_->fit_smooth(sets[k], {}, null_noise_, null_cost_);
        },
        progress_);
    const HeaveExperiment::Smooth* best = &begin;
    for (const HeaveExperiment::Smooth& one : finer) {
        best = held_out(one) < held_out(*best) ? &one : best;
    }
    return *best;
}

}  // namespace underbody::discovery
