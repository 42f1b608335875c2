// Closing the loop with forces measured at set points: what is held out, every effect alone, accidents and colour of
// the noise.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/no_limit.h"
#include "core/parallel.h"
#include "core/random.h"
#include "surrogates/discovery/run_split.h"
#include "surrogates/discovery/static/static_checks.h"
#include "surrogates/discovery/static/static_loop.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

using dynamics::Channel;

StaticLoop::StaticLoop(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
                       core::Progress& progress)
    : model_(model),
      data_(data),
      options_(options),
      progress_(progress),
      calibration_(static_calibration(options.constants)),
      experiment_(model, data) {}

Discovery StaticLoop::run() {
    refuse_outside_tables(experiment_, data_);
    split();
    estimate_noise();
    progress_.report(0.1, "fitting the effects of the catalogue");
    fit_singles();
    try_two();
    leave_accidents_out();
    try_two();
    whiten();
    fitted_.resize(singles_);
    progress_.report(0.4, "testing what is left");
    open_gate();
    if (gate_ < calibration_.gate) {
        fit_pairs();
    }
    decide();
    progress_.report(0.8, "error on held-out set points");
    measure_error();
    describe();
    if (options_.placebo_twins > 0) {
        progress_.report(0.85, "the same on twins with nothing missing");
        run_placebo();
    }
    return std::move(result_);
}

void StaticLoop::estimate_noise() {
    experiment_.estimate_noise(overrule_noise_);
    if (test_experiment_) {
        test_experiment_->set_noise(experiment_.noise());
    }
}

void StaticLoop::split() {
    const bool named = std::any_of(data_.runs.begin(), data_.runs.end(),
                                   [](const auto& run) { return run.use == dynamics::RunUse::test; });
    const auto& all = experiment_.observations();
    const std::filesystem::path beside = data_.folder / "held-out";
    if (named) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            (data_.runs[all[i].run].use == dynamics::RunUse::test ? test_ : train_).push_back(i);
        }
        result_.held_out = "runs that dataset.toml marks for the test";
    } else if (std::filesystem::exists(beside / "dataset.toml")) {
        const dynamics::Measurements other = dynamics::read_measurements(beside);
        if (other.kind == dynamics::MeasurementKind::steady) {
            test_experiment_.emplace(model_, other);
            result_.held_out = "the folder held-out beside the data, which nothing was fitted to";
        }
    }
    if (!named && !test_experiment_) {
        // a quarter of the set points, drawn once
        std::vector<bool> held(experiment_.set_points(), false);
        if (experiment_.set_points() >= 8) {
            core::Random random(options_.seed);
            for (std::size_t left = experiment_.set_points() / 4; left > 0;) {
                const std::size_t g = random.below(held.size());
                left -= held[g] ? 0 : 1;
                held[g] = true;
            }
        }
        for (std::size_t i = 0; i < all.size(); ++i) {
            (held[all[i].set_point] ? test_ : train_).push_back(i);
        }
        result_.held_out =
            test_.empty()
                ? fitted_readings
                : "a quarter of the set points, drawn before anything was fitted (same rig, same order of measurement)";
    } else if (!named) {
        train_.resize(all.size());
        std::iota(train_.begin(), train_.end(), std::size_t{0});
    }
    // in the order of measurement, one quantity after the other, so that blocks of neighbours are blocks in time
    std::stable_sort(train_.begin(), train_.end(), [&](std::size_t a, std::size_t b) {
        return std::tuple(all[a].quantity, all[a].run, all[a].row) <
               std::tuple(all[b].quantity, all[b].run, all[b].row);
    });
}

// A length over which an effect fades with the gap is searched between the gaps measured, where they are apart enough.
constexpr double range_for_length = 1.5, inside_low = 1.2, inside_high = 0.85;

void StaticLoop::keep_lengths_inside(std::vector<Hypothesis>& candidates) const {
    double low = core::no_limit;
    double high = -core::no_limit;
    for (const std::size_t i : train_) {
        low = std::min(low, experiment_.observations()[i].at[Channel::gap]);
        high = std::max(high, experiment_.observations()[i].at[Channel::gap]);
    }
    for (Hypothesis& candidate : candidates) {
        for (std::size_t j = 0; j < candidate.parameters.size(); ++j) {
            FitParameter& parameter = candidate.parameters[j];
            const Hypothesis::Slot& slot = candidate.slots[j];
            const dynamics::EffectInfo& info = dynamics::effect(candidate.uses[slot.use].name).info();
            if (info.parameters[slot.value].within_gaps && low > 0 && high > range_for_length * low) {
                parameter.lower = std::max(parameter.lower, inside_low * low);
                parameter.upper = std::min(parameter.upper, inside_high * high);
                parameter.start = std::clamp(parameter.start, parameter.lower, parameter.upper);
                parameter.typical = std::min(parameter.typical, 0.5 * (parameter.upper - parameter.lower));
                constexpr double quarter = 0.25;  // of the way, by ratio
                const double inside[] = {std::pow(low, 1 - quarter) * std::pow(high, quarter), std::sqrt(low * high),
                                         std::pow(low, quarter) * std::pow(high, 1 - quarter)};
                for (std::size_t k = 0; k < candidate.starts.size(); ++k) {
                    candidate.starts[k][j] = inside[k % 3];
                }
            }
        }
    }
}

FittedHypothesis StaticLoop::fitted(const Hypothesis& hypothesis) const {
    FittedHypothesis fit = experiment_.fit(hypothesis, train_);
    fit.explained = null_cost_ - fit.cost;
    fit.explained_by_group.assign(experiment_.set_points(), 0);
    for (std::size_t i = 0; i < train_.size(); ++i) {
        fit.explained_by_group[experiment_.observations()[train_[i]].set_point] +=
            null_residuals_[i] * null_residuals_[i] - fit.fit.residuals[i] * fit.fit.residuals[i];
    }
    return fit;
}

void StaticLoop::fit_singles() {
    std::vector<Channel> seen = experiment_.varying();
    if (experiment_.set_points() == 1) {
        // nothing tells them apart there: all that can have moved the readings share the probability
        for (const Channel channel : {Channel::gap, Channel::speed, Channel::jet_voltage}) {
            if (experiment_.observations().front().at.has(channel) &&
                std::find(seen.begin(), seen.end(), channel) == seen.end()) {
                seen.push_back(channel);
            }
        }
    }
    std::vector<Hypothesis> candidates = static_hypotheses(experiment_.model(), seen, experiment_.quantities());
    keep_lengths_inside(candidates);
    keep_only(candidates, options_.candidates);
    experiment_.residuals(train_, {}, null_residuals_);
    null_cost_ = sum_of_squares(null_residuals_);
    fitted_.resize(candidates.size());
    core::parallel_for(
        candidates.size(), [&](std::size_t i) { fitted_[i] = fitted(candidates[i]); }, progress_);
    singles_ = fitted_.size();
}

bool StaticLoop::is_slow(Channel channel) const {
    constexpr double together = 0.5;  // correlation of neighbours
    std::vector<double> values;
    for (const std::size_t i : train_) {
        const Observation& one = experiment_.observations()[i];
        if (one.quantity == experiment_.observations()[train_.front()].quantity) {
            values.push_back(one.at[channel]);
        }
    }
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (double& value : values) {  // by rank: gaps may stand in any ratio to each other
        value = static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
    }
    return autocorrelation(values, 1) > together;
}

std::vector<double> StaticLoop::left_over() const {
    const std::size_t best = best_hypothesis(fitted_, 2);
    std::vector<double> left = best < fitted_.size() ? fitted_[best].fit.residuals : null_residuals_;
    const StaticStructure structure(experiment_, train_);
    std::map<Channel, bool> slow;
    for (const Channel channel : experiment_.varying()) {
        slow[channel] = is_slow(channel);
    }
    for (const StaticStructure::Test& test : structure.tests()) {
        // coloured noise alone makes a slow wave over time, and over what was changed slowly (a voltage held for a
        // sweep of gaps); only what is far more than that is no colour
        const double colour_alone = 50 + 5 * static_cast<double>(test.basis.columns);
        if (test.variables.size() == 1 &&
            (!slow.at(test.variables.front()) || explained_square(test.basis, left) > colour_alone)) {
            take_out(test.basis, left);
        }
    }
    return left;
}

void StaticLoop::leave_accidents_out() {
    const std::vector<std::size_t> bad = accidents(left_over());
    if (bad.empty()) {
        return;
    }
    std::string where;
    std::vector<std::size_t> kept;
    std::vector<std::size_t> left_out;
    for (std::size_t i = 0; i < train_.size(); ++i) {
        if (std::find(bad.begin(), bad.end(), i) == bad.end()) {
            kept.push_back(train_[i]);
        } else {
            left_out.push_back(train_[i]);
            const Observation& one = experiment_.observations()[train_[i]];
            where += (where.empty() ? "" : ", ") +
                     data_.runs[one.run].table.place(one.row, experiment_.quantities()[one.quantity]).text();
        }
    }
    train_ = std::move(kept);
    experiment_.mark_accidents(left_out);
    result_.problems.push_back(
        {core::Problem::Severity::warning,
         std::to_string(bad.size()) + (bad.size() == 1 ? " reading lies" : " readings lie") +
             " more than six standard deviations from everything else and was left out of every fit: " + where,
         {}});
    estimate_noise();
    fit_singles();
}

void StaticLoop::whiten() {
    if (experiment_.find_colour(train_, left_over())) {
        result_.problems.push_back(
            {core::Problem::Severity::note,
             "neighbouring readings share part of their noise (coloured noise): whitened before anything was judged",
             {}});
        fit_singles();
    }
}

Discovery discover_static(const dynamics::Model& model, const dynamics::Measurements& data,
                          const DiscoverOptions& options, core::Progress& progress) {
    return StaticLoop(model, data, options, progress).run();
}

}  // namespace underbody::discovery
