// Closing the loop with forces measured at set points.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/parallel.h"
#include "core/random.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/static_checks.h"
#include "surrogates/discovery/static_consequence.h"
#include "surrogates/discovery/static_experiment.h"
#include "surrogates/discovery/static_figures.h"
#include "surrogates/discovery/static_next.h"
#include "surrogates/discovery/static_structure.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

/// Set on the bench of tests/bench/discovery; see its README for the data sets.
Calibration static_calibration() {
    Calibration c;
    c.gate = 0.002;
    c.form_share = 0.003;
    c.unknown_share = 0.12;
    c.unknown_p = 0.002;
    c.pair_share = 0.05;
    c.pair_gain = 20;
    c.origin = "tests/bench/discovery, static sets";
    return c;
}

class StaticLoop {
public:
    StaticLoop(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
               core::Progress& progress)
        : model_(model), data_(data), options_(options), progress_(progress), experiment_(model, data) {}

    Discovery run() {
        split();
        experiment_.estimate_noise();
        progress_.report(0.1, "fitting the effects of the catalogue");
        fit_singles();
        leave_accidents_out();
        whiten();
        progress_.report(0.4, "testing what is left");
        open_gate();
        if (gate_ < calibration_.gate) {
            fit_pairs();
        }
        decide();
        progress_.report(0.8, "error on held-out set points");
        if (test_experiment_) {
            test_experiment_->set_noise(experiment_.noise());
        }
        measure_error();
        describe();
        if (options_.placebo_twins > 0) {
            progress_.report(0.85, "the same on twins with nothing missing");
            run_placebo();
        }
        return std::move(result_);
    }

private:
    void split() {
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
            result_.held_out = test_.empty() ? "the readings that were fitted, because fewer than eight set points leave none to hold out: too good by nature"
                                             : "a quarter of the set points, drawn before anything was fitted (same rig, same order of measurement)";
        } else if (!named) {
            train_.resize(all.size());
            std::iota(train_.begin(), train_.end(), std::size_t{0});
        }
        // in the order of measurement, one quantity after the other, so that blocks of neighbours are blocks in time
        std::stable_sort(train_.begin(), train_.end(), [&](std::size_t a, std::size_t b) {
            return std::tuple(all[a].quantity, all[a].run, all[a].row) < std::tuple(all[b].quantity, all[b].run, all[b].row);
        });
    }

    void fit_singles() {
        std::vector<Hypothesis> candidates = static_hypotheses(experiment_.model(), experiment_.varying(), experiment_.quantities());
        keep_lengths_inside(candidates);
        keep_only(candidates, options_.candidates);
        experiment_.residuals(train_, {}, null_residuals_);
        null_cost_ = sum_of_squares(null_residuals_);
        fitted_.resize(candidates.size());
        core::parallel_for(candidates.size(), [&](std::size_t i) { fitted_[i] = fitted(candidates[i]); }, progress_);
        singles_ = fitted_.size();
    }

    /// A change over the gap at a length that was not measured is no such change: it would pass for a gain.
    void keep_lengths_inside(std::vector<Hypothesis>& candidates) const {
        double low = 1e300;
        double high = -1e300;
        for (const std::size_t i : train_) {
            low = std::min(low, experiment_.observations()[i].at[Channel::gap]);
            high = std::max(high, experiment_.observations()[i].at[Channel::gap]);
        }
        for (Hypothesis& candidate : candidates) {
            for (std::size_t j = 0; j < candidate.parameters.size(); ++j) {
                FitParameter& parameter = candidate.parameters[j];
                if (candidate.names.front() == "surface_roughness" && parameter.name == "length" && low > 0 && high > 1.5 * low) {
                    parameter.lower = std::max(parameter.lower, 1.2 * low);
                    parameter.upper = std::min(parameter.upper, 0.85 * high);
                    parameter.start = std::clamp(parameter.start, parameter.lower, parameter.upper);
                    parameter.typical = std::min(parameter.typical, 0.5 * (parameter.upper - parameter.lower));
                    const double inside[] = {std::pow(low, 0.75) * std::pow(high, 0.25), std::sqrt(low * high), std::pow(low, 0.25) * std::pow(high, 0.75)};
                    for (std::size_t k = 0; k < candidate.starts.size(); ++k) {
                        candidate.starts[k][j] = inside[k % 3];
                    }
                }
            }
        }
    }

    /// What neither the best single effect nor a smooth function of one channel explains; of time only what is far too much for colour.
    std::vector<double> left_over() const {
        const std::size_t best = best_hypothesis(fitted_, 1);
        std::vector<double> left = best < fitted_.size() ? fitted_[best].fit.residuals : null_residuals_;
        const StaticStructure structure(experiment_, train_);
        for (const StaticStructure::Test& test : structure.tests()) {
            // coloured noise alone makes a slow wave over time; only what is far more than that is no colour
            const bool slow = test.variables.front() == Channel::time;
            const double colour_alone = 50 + 5 * static_cast<double>(test.basis.columns);
            if (test.variables.size() == 1 && (!slow || explained_square(test.basis, left) > colour_alone)) {
                take_out(test.basis, left);
            }
        }
        return left;
    }

    /// One bad reading would pass for an effect, or for more noise than there is.
    void leave_accidents_out() {
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
                where += (where.empty() ? "" : ", ") + data_.runs[one.run].table.place(one.row, experiment_.quantities()[one.quantity]).text();
            }
        }
        train_ = std::move(kept);
        experiment_.mark_accidents(left_out);
        result_.problems.push_back({core::Problem::Severity::warning,
                                    std::to_string(bad.size()) + (bad.size() == 1 ? " reading lies" : " readings lie") +
                                        " more than six standard deviations from everything else and was left out of every fit: " + where,
                                    {}});
        experiment_.estimate_noise();
        fit_singles();
    }

    /// Noise whose neighbours in time go together would pass for drift and the like: what the best effect and a smooth function of
    /// time leave is looked at, and if it is coloured everything is judged again after whitening.
    void whiten() {
        if (experiment_.find_colour(train_, left_over())) {
            result_.problems.push_back({core::Problem::Severity::note,
                                        "neighbouring readings share part of their noise (coloured noise): whitened before anything was judged", {}});
            fit_singles();
        }
    }

    static void take_out(const DesignMatrix& basis, std::vector<double>& y) {
        for (std::size_t k = 0; k < basis.columns; ++k) {
            const double* column = basis.values.data() + k * basis.rows;
            double dot = 0;
            for (std::size_t i = 0; i < y.size(); ++i) {
                dot += column[i] * y[i];
            }
            for (std::size_t i = 0; i < y.size(); ++i) {
                y[i] -= dot * column[i];
            }
        }
    }

    FittedHypothesis fitted(const Hypothesis& hypothesis) const {
        FittedHypothesis fit = experiment_.fit(hypothesis, train_);
        fit.explained = null_cost_ - fit.cost;
        fit.explained_by_group.assign(experiment_.set_points(), 0);
        for (std::size_t i = 0; i < train_.size(); ++i) {
            fit.explained_by_group[experiment_.observations()[train_[i]].set_point] +=
                null_residuals_[i] * null_residuals_[i] - fit.fit.residuals[i] * fit.fit.residuals[i];
        }
        return fit;
    }

    /// What each effect does to the residuals when it is small.
    std::vector<DesignMatrix> directions() const {
        std::vector<DesignMatrix> list;
        std::vector<double> moved;
        for (std::size_t i = 0; i < singles_; ++i) {
            const Hypothesis& h = fitted_[i].hypothesis;
            DesignMatrix matrix;
            matrix.rows = train_.size();
            for (std::size_t j = 0; j < h.parameters.size(); ++j) {
                std::vector<double> p;
                for (const FitParameter& parameter : h.parameters) {
                    p.push_back(parameter.start);
                }
                p[j] += (p[j] + 0.1 * h.parameters[j].typical <= h.parameters[j].upper ? 0.1 : -0.1) * h.parameters[j].typical;
                experiment_.residuals(train_, h.with(p), moved);
                ++matrix.columns;
                for (std::size_t k = 0; k < moved.size(); ++k) {
                    matrix.values.push_back(moved[k] - null_residuals_[k]);
                }
            }
            list.push_back(orthonormal(matrix));
        }
        return list;
    }

    void open_gate() {
        structure_.emplace(experiment_, train_);
        whole_ = structure_->best(null_residuals_);
        best_single_ = best_hypothesis(fitted_, 1);
        rest_ = whole_;
        std::vector<double> noise_like = null_residuals_;
        if (best_single_ < fitted_.size()) {
            rest_ = structure_->best(fitted_[best_single_].fit.residuals);
            noise_like = fitted_[best_single_].fit.residuals;
        }
        gate_ = simulated_gate(*structure_, directions(), null_residuals_, noise_like, options_.seed, progress_);
        result_.depends_on = whole_.variables;
    }

    double structure_left(const SmoothFit& rest, double explained) const {
        const double left = std::max(0.0, rest.gain - rest.degrees);
        return left / std::max(left + std::max(explained, 0.0), 1e-12);
    }

    /// A second effect is looked for only where the best single one leaves structure, and stays only when it earns its place.
    void fit_pairs() {
        if (best_single_ >= fitted_.size() || rest_.p > calibration_.unknown_p) {
            return;
        }
        std::vector<std::size_t> order(singles_);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return fitted_[a].score() < fitted_[b].score(); });
        std::vector<std::size_t> leaders;
        std::set<std::vector<std::string>> seen;
        for (const std::size_t i : order) {
            std::vector<std::string> law = fitted_[i].hypothesis.names;
            if (law.front() == "cable_buoyancy") {
                law.front() = "strut_buoyancy";  // one law under two names takes one place
            }
            if (leaders.size() < 5 && seen.insert(law).second) {
                leaders.push_back(i);
            }
        }
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        for (const std::size_t a : leaders) {
            for (std::size_t b = 0; b < singles_; ++b) {
                const bool both_lead = std::find(leaders.begin(), leaders.end(), b) != leaders.end();
                if (fitted_[a].hypothesis.names != fitted_[b].hypothesis.names && !(both_lead && b < a)) {
                    pairs.emplace_back(a, b);
                }
            }
        }
        std::vector<FittedHypothesis> found(pairs.size());
        core::parallel_for(
            pairs.size(),
            [&](std::size_t k) {
                const auto [a, b] = pairs[k];
                found[k] = fitted(joined(fitted_[a].hypothesis, fitted_[a].fit.parameters, fitted_[b].hypothesis,
                                         nudged(fitted_[b].hypothesis)));
            },
            progress_);
        const std::size_t best = best_hypothesis(found, 2);
        if (best >= found.size()) {
            return;
        }
        const double gain = fitted_[best_single_].score() - found[best].score();
        const SmoothFit rest = structure_->best(found[best].fit.residuals);
        const double share = gain / std::max(found[best].explained, 1e-12);
        // two laws together bend to much: what they leave must look like noise, or nearly
        if (gain > calibration_.pair_gain && share > calibration_.pair_share &&
            (rest.p > calibration_.unknown_p || structure_left(rest, found[best].explained) < 0.15 * calibration_.unknown_share)) {
            fitted_.insert(fitted_.end(), found.begin(), found.end());
            rest_ = rest;
        }
    }

    static std::vector<double> nudged(const Hypothesis& h) {
        if (!h.starts.empty()) {
            return h.starts.front();
        }
        std::vector<double> p;
        for (const FitParameter& parameter : h.parameters) {
            p.push_back(parameter.start);
        }
        return p;
    }

    void decide() {
        attribution_ = attribute(fitted_, gate_, rest_, calibration_);
        result_.verdict = attribution_.verdict;
        result_.gate = gate_;
        result_.none_probability = attribution_.none_probability;
        result_.model = model_;
        for (const auto& [quantity, figure] : experiment_.noise()) {
            result_.noise[quantity] = {figure.value, figure.unit, figure.from, figure.estimated};
        }
        if (result_.verdict == "effect") {
            const FittedHypothesis& best = fitted_[attribution_.chosen];
            uses_ = best.hypothesis.with(best.fit.parameters);
            set_sigmas(uses_, best);
        } else if (result_.verdict == "unknown") {
            make_correction();
        }
        for (const dynamics::EffectUse& use : uses_) {
            result_.model = result_.model.with_effect(use);
        }
    }

    static void set_sigmas(std::vector<dynamics::EffectUse>& uses, const FittedHypothesis& fitted) {
        for (std::size_t j = 0; j < fitted.hypothesis.slots.size(); ++j) {
            const Hypothesis::Slot& slot = fitted.hypothesis.slots[j];
            uses[slot.use].sigmas[slot.value] = std::isfinite(fitted.fit.sigma[j]) ? fitted.fit.sigma[j] : 0;
        }
    }

    void make_correction() {
        std::vector<Channel> variables;
        for (const std::string& name : whole_.variables) {
            Channel channel{};
            if (dynamics::find_channel(name, channel)) {
                variables.push_back(channel);
            }
        }
        std::vector<double> residuals;
        for (const std::size_t i : train_) {
            residuals.push_back(experiment_.observations()[i].value - experiment_.predict(experiment_.observations()[i], {}));
        }
        for (std::size_t q = 0; q < experiment_.quantities().size(); ++q) {
            std::vector<double> own = null_residuals_;
            for (std::size_t i = 0; i < train_.size(); ++i) {
                own[i] = experiment_.observations()[train_[i]].quantity == q ? own[i] : 0;
            }
            if (structure_->best(own).p > 0.01) {
                continue;  // nothing was seen in this quantity: a correction would only carry its noise into the model
            }
            uses_.push_back(smooth_correction(experiment_, train_, variables, q, residuals));
        }
    }

    void measure_error() {
        const StaticExperiment& experiment = test_experiment_ ? *test_experiment_ : experiment_;
        std::vector<std::size_t> chosen = test_;
        if (test_experiment_) {
            chosen.resize(experiment.observations().size());
            std::iota(chosen.begin(), chosen.end(), std::size_t{0});
        } else if (chosen.empty()) {
            chosen = train_;
        }
        for (std::size_t q = 0; q < experiment.quantities().size(); ++q) {
            std::vector<double> before(experiment.set_points(), 0);
            std::vector<double> after = before;
            std::vector<double> count = before;
            double noise = 0;
            for (const std::size_t i : chosen) {
                const Observation& one = experiment.observations()[i];
                if (one.quantity == q) {
                    const double b = one.value - experiment.predict(one, {});
                    const double a = one.value - experiment.predict(one, uses_);
                    before[one.set_point] += b * b;
                    after[one.set_point] += a * a;
                    count[one.set_point] += 1;
                    noise = experiment.sigma(one);
                }
            }
            ErrorChange change;
            change.channel = experiment.quantities()[q];
            change.unit = core::find_quantity(change.channel)->unit;
            change.before = error_by_groups(before, count, options_.seed);
            change.after = uses_.empty() ? change.before : error_by_groups(after, count, options_.seed);
            change.noise = noise;
            result_.error.push_back(change);
        }
        std::stable_sort(result_.error.begin(), result_.error.end(), [](const ErrorChange& a, const ErrorChange& b) {
            return a.before.rmse / std::max(a.noise, 1e-300) > b.before.rmse / std::max(b.noise, 1e-300);
        });
    }

    /// The data with what the declared model says at every set point, and noise.
    dynamics::Measurements twin(std::uint64_t seed) const {
        dynamics::Measurements data = data_;
        data.folder.clear();  // the folder beside belongs to the real data
        const std::vector<double> noise = experiment_.drawn_noise(seed);
        const std::vector<std::string>& quantities = experiment_.quantities();
        std::map<std::pair<std::size_t, std::string>, std::vector<double>> columns;
        for (std::size_t i = 0; i < experiment_.observations().size(); ++i) {
            const Observation& one = experiment_.observations()[i];
            std::vector<double>& values = columns[{one.run, quantities[one.quantity]}];
            values.resize(data.runs[one.run].table.rows(), std::nan(""));
            values[one.row] = experiment_.predict(one, {}) + noise[i];
        }
        for (std::size_t r = 0; r < data.runs.size(); ++r) {
            core::Table table;
            table.source = data_.runs[r].table.source;
            for (const core::Column& column : data_.runs[r].table.columns()) {
                const auto drawn = columns.find({r, column.name});
                if (column.is_text()) {
                    table.add_text(column.name, column.text);
                } else if (drawn != columns.end()) {
                    table.add_numbers(column.name, column.unit, drawn->second);
                } else if (std::find(quantities.begin(), quantities.end(), column.name) == quantities.end()) {
                    table.add_numbers(column.name, column.unit, column.numbers);
                }
            }
            data.runs[r].table = std::move(table);
        }
        return data;
    }

    void run_placebo() {
        DiscoverOptions quiet = options_;
        quiet.consequence = quiet.figures = false;
        quiet.placebo_twins = 0;
        double before = 0;
        double after = 0;
        for (std::size_t k = 0; k < options_.placebo_twins; ++k) {
            const Discovery of_twin = discover_static(model_, twin(options_.seed * 1000 + k), quiet, core::Progress::none());
            progress_.check();
            ++result_.placebo.twins;
            result_.placebo.alarms += of_twin.verdict == "none" ? 0 : 1;
            before += std::pow(of_twin.error.front().before.rmse, 2);
            after += std::pow(of_twin.error.front().after.rmse, 2);
        }
        result_.placebo.error_ratio = before > 0 ? std::sqrt(after / before) : 1;
    }

    /// Share of resampled groups of set points in which the chosen names have the least score.
    double stability() const {
        if (result_.verdict == "none" || attribution_.shares.empty()) {
            return result_.none_probability;
        }
        core::Random random(options_.seed + 1);
        const std::size_t groups = experiment_.set_points();
        int same = 0;
        constexpr int draws = 200;
        for (int d = 0; d < draws; ++d) {
            std::vector<double> weight(groups, 0);
            for (std::size_t g = 0; g < groups; ++g) {
                weight[random.below(groups)] += 1;
            }
            double best = 1e300;
            std::size_t chosen = 0;
            for (const Attribution::Share& share : attribution_.shares) {
                const FittedHypothesis& one = fitted_[share.hypothesis];
                double score = one.occam - 2 * std::log(one.hypothesis.prior);
                for (std::size_t g = 0; g < groups; ++g) {
                    score -= weight[g] * one.explained_by_group[g];
                }
                if (score < best) {
                    best = score;
                    chosen = share.hypothesis;
                }
            }
            same += chosen == attribution_.chosen ? 1 : 0;
        }
        return static_cast<double>(same) / draws;
    }

    FoundEffect found(const FittedHypothesis& fitted, double probability) const {
        FoundEffect effect = found_effect(fitted, probability);
        effect.evidence = "explains " + core::format_number(100 * std::max(0.0, fitted.explained) /
                                                                std::max({whole_.gain, fitted.explained, 1e-12}), 3) +
                          " % of the structure in the residual (fall of -2 log likelihood " +
                          core::format_number(fitted.explained, 4) + " for " + std::to_string(fitted.hypothesis.parameters.size()) +
                          " free numbers)" + (fitted.hypothesis.form.empty() ? "" : "; " + fitted.hypothesis.form);
        return effect;
    }

    void describe() {
        result_.stability = stability();
        if (result_.verdict == "effect") {
            const FittedHypothesis& best = fitted_[attribution_.chosen];
            for (FoundEffect& effect : split_by_name(found(best, attribution_.shares.front().probability), best)) {
                result_.effects.push_back(std::move(effect));
            }
        } else if (result_.verdict == "unknown") {
            FoundEffect unknown;
            unknown.name = "unknown";
            unknown.probability = attribution_.unknown_probability;
            unknown.depends_on = whole_.variables;
            unknown.uses = uses_;
            unknown.explained = whole_.gain;
            unknown.evidence = "the best named effect (" + fitted_[attribution_.chosen].hypothesis.label() + ") leaves " +
                               core::format_number(100 * structure_left(rest_, fitted_[attribution_.chosen].explained), 3) +
                               " % of the structure; a smooth correction over " + list_of(whole_.variables) + " takes its place";
            result_.effects.push_back(std::move(unknown));
        }
        add_alternatives();
        add_limits();
        next_static_experiment(experiment_, fitted_, attribution_, options_.seed, result_);
        result_.problems.insert(result_.problems.end(), data_.problems.begin(), data_.problems.end());
        result_.problems.insert(result_.problems.end(), experiment_.problems().begin(), experiment_.problems().end());
        const core::Problems odd = check_static_data(experiment_, data_);
        result_.problems.insert(result_.problems.end(), odd.begin(), odd.end());
        std::vector<double> left;
        for (const std::size_t i : train_) {
            const Observation& one = experiment_.observations()[i];
            left.push_back((one.value - experiment_.predict(one, uses_)) / experiment_.sigma(one));
        }
        const core::Problems apart = check_runs_agree(experiment_, data_, train_, left);
        result_.problems.insert(result_.problems.end(), apart.begin(), apart.end());
        if (options_.consequence) {
            result_.consequence = static_consequence(model_, uses_, experiment_, progress_);
        }
        result_.sentence = verdict_sentence(result_);
        if (options_.figures) {
            result_.figures = static_figures(experiment_, train_, uses_, result_);
        }
    }

    void add_alternatives() {
        for (const Attribution::Share& share : attribution_.shares) {
            const FittedHypothesis& one = fitted_[share.hypothesis];
            const bool is_verdict = result_.verdict == "effect" && share.hypothesis == attribution_.chosen;
            if (!is_verdict && result_.alternatives.size() < 6 && (share.probability > 1e-3 || result_.alternatives.size() < 3)) {
                FoundEffect rival = found(one, share.probability);
                rival.name = one.hypothesis.label();
                if (result_.verdict == "effect") {
                    rival.told_apart_by = static_told_apart(experiment_, fitted_[attribution_.chosen], one);
                }
                result_.alternatives.push_back(std::move(rival));
            }
        }
        if (result_.verdict == "effect" && attribution_.unknown_probability > 1e-3) {
            FoundEffect unknown;
            unknown.name = "unknown";
            unknown.probability = attribution_.unknown_probability;
            unknown.depends_on = rest_.variables;
            result_.alternatives.push_back(std::move(unknown));
        }
    }

    void add_limits() {
        for (const Attribution::Share& share : attribution_.shares) {
            const FittedHypothesis& one = fitted_[share.hypothesis];
            if (one.hypothesis.names.size() != 1 || one.hypothesis.parameters.empty()) {
                continue;
            }
            // five standard deviations: seen 9 times in 10 by a gate of about 3.7
            result_.limits.push_back({one.hypothesis.names.front(), one.hypothesis.parameters.front().name,
                                      5 * one.fit.sigma.front(), one.hypothesis.parameters.front().unit});
        }
    }

    static double sum_of_squares(const std::vector<double>& r) {
        double sum = 0;
        for (const double value : r) {
            sum += value * value;
        }
        return sum;
    }

    const dynamics::Model& model_;
    const dynamics::Measurements& data_;
    const DiscoverOptions& options_;
    core::Progress& progress_;
    Calibration calibration_ = static_calibration();
    StaticExperiment experiment_;
    std::optional<StaticExperiment> test_experiment_;
    std::vector<std::size_t> train_;
    std::vector<std::size_t> test_;
    std::vector<double> null_residuals_;
    double null_cost_ = 0;
    std::vector<FittedHypothesis> fitted_;
    std::size_t singles_ = 0;
    std::size_t best_single_ = 0;
    std::optional<StaticStructure> structure_;
    SmoothFit whole_;
    SmoothFit rest_;
    double gate_ = 1;
    Attribution attribution_;
    std::vector<dynamics::EffectUse> uses_;
    Discovery result_;
};

}  // namespace

Discovery discover_static(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
                          core::Progress& progress) {
    return StaticLoop(model, data, options, progress).run();
}

}  // namespace underbody::discovery
