// Closing the loop with heave runs: the declared model inside the experiment.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/parallel.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave_error.h"
#include "surrogates/discovery/heave_experiment.h"
#include "surrogates/discovery/heave_figures.h"
#include "surrogates/discovery/heave_next.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

namespace {

using Variable = FlexibleForce::Variable;

/// Set on the bench of tests/bench/discovery; see its README for the data sets.
Calibration heave_calibration() {
    Calibration c;
    c.gate = 0.002;
    c.form_share = 0.01;
    c.unknown_share = 0.12;
    c.unknown_p = 1e-4;
    c.pair_share = 0.1;
    c.pair_gain = 40;
    c.origin = "tests/bench/discovery, heave runs";
    return c;
}

class HeaveLoop {
public:
    HeaveLoop(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
              core::Progress& progress)
        : model_(model), data_(data), options_(options), progress_(progress), records_(prepare_heave_records(model, data)) {}

    Discovery run() {
        split();
        experiment_.emplace(model_, records_, train_, data_.declared_noise("gap"), data_.declared_noise("heave_velocity"));
        progress_.report(0.02, "noise");
        fit_null();
        progress_.report(0.08, "fitting the effects of the catalogue");
        fit_singles();
        try_hold();
        colour_noise();
        progress_.report(0.5, "testing what is left");
        open_gate();
        if (gate_ < calibration_.gate) {
            smooth_corrections();
            progress_.report(0.65, "pairs of effects");
            fit_pairs();
        }
        decide();
        progress_.report(0.85, "error on held-out runs");
        measure_error();
        describe();
        return std::move(result_);
    }

private:
    void split() {
        const std::filesystem::path beside = data_.folder / "held-out";
        const bool named = std::any_of(data_.runs.begin(), data_.runs.end(),
                                       [](const auto& run) { return run.use == dynamics::RunUse::test; });
        const std::size_t count = records_.records.size();
        if (named) {
            for (std::size_t i = 0; i < count; ++i) {
                (data_.runs[records_.records[i].run].use == dynamics::RunUse::test ? test_ : train_).push_back(i);
            }
            result_.held_out = "runs that dataset.toml marks for the test";
        } else if (std::filesystem::exists(beside / "dataset.toml")) {
            const dynamics::Measurements other = dynamics::read_measurements(beside);
            if (other.kind == dynamics::MeasurementKind::time_series) {
                test_records_ = prepare_heave_records(model_, other);
                train_.resize(count);
                std::iota(train_.begin(), train_.end(), std::size_t{0});
                test_.resize(test_records_->records.size());
                std::iota(test_.begin(), test_.end(), std::size_t{0});
                result_.held_out = "the runs in the folder held-out beside the data (another excitation or controller), which nothing was fitted to";
            }
        }
        if (train_.empty()) {
            const std::size_t held = count >= 3 ? std::max<std::size_t>(1, count / 4) : 0;
            std::vector<bool> out(count, false);
            core::Random random(options_.seed);
            for (std::size_t left = held; left > 0;) {
                const std::size_t i = random.below(count);
                left -= out[i] ? 0 : 1;
                out[i] = true;
            }
            for (std::size_t i = 0; i < count; ++i) {
                (out[i] ? test_ : train_).push_back(i);
            }
            result_.held_out = std::to_string(held) + " of " + std::to_string(count) + " runs, drawn before anything was fitted (same controller)";
            if (held == 0) {
                test_ = train_;
                result_.held_out = "the same runs that were fitted: there are too few to hold any out, so the error after is too good";
                result_.problems.push_back({core::Problem::Severity::warning,
                                            "with " + std::to_string(count) + " run(s) nothing can be held out: the error is that of the fit, and what "
                                            "runs have in common cannot be told from chance",
                                            core::Place{data_.folder.string(), {}, {}, {}}});
            }
        }
    }

    void fit_null() {
        HeaveNoise noise = experiment_->noise();
        experiment_->fit_process({}, noise);
        experiment_->fit_noise({}, noise);
        set_null(noise);
    }

    HeaveExperiment::Result fitted(const Hypothesis& hypothesis, const HeaveNoise& begin) const {
        HeaveExperiment::Result result = experiment_->fit(hypothesis, begin);
        result.fitted.explained = null_cost_ - result.fitted.cost;
        const FitParameter& chief = hypothesis.parameters.front();
        if (result.fitted.fit.parameters.front() >= chief.upper - 1e-9 * std::abs(chief.upper)) {
            result.fitted.hypothesis.prior *= 1e-4;  // driven against the bound of what physics allows: it stands in for something else
        }
        result.fitted.explained_by_group = null_by_record_;
        for (std::size_t r = 0; r < null_by_record_.size(); ++r) {
            result.fitted.explained_by_group[r] -= result.fitted.cost_of_group[r];
        }
        return result;
    }

    void fit_singles() {
        if (candidates_.empty()) {
            candidates_ = heave_hypotheses(model_, records_.velocity_measured);
            for (Hypothesis& candidate : candidates_) {
                if (candidate.names.front() == "periodic_disturbance") {
                    candidate.starts = experiment_->periodic_starts({}, null_noise_, 3);
                }
            }
            if (!records_.input_recorded) {
                std::erase_if(candidates_, [](const Hypothesis& h) {
                    return h.names.front().rfind("input_", 0) == 0 || h.names.front() == "actuator_lag";
                });
            }
        }
        fitted_.assign(candidates_.size(), {});
        noises_.assign(candidates_.size(), {});
        core::parallel_for(
            candidates_.size(),
            [&](std::size_t i) {
                HeaveExperiment::Result result = fitted(candidates_[i], null_noise_);
                fitted_[i] = std::move(result.fitted);
                noises_[i] = result.noise;
            },
            progress_);
        singles_ = fitted_.size();
        best_single_ = best_hypothesis(fitted_, 1);
    }

    /// Is the recorded input held from sample to sample, or linear between? Half a sample of delay hangs on it.
    void try_hold() {
        if (!records_.input_recorded) {
            return;
        }
        const FittedHypothesis& best = fitted_[best_single_];
        std::vector<double> innovations;
        experiment_->set_hold(false);
        const double linear = experiment_->evaluate(best.hypothesis.with(best.fit.parameters), nullptr, noises_[best_single_], innovations);
        const double null_linear = experiment_->evaluate({}, nullptr, null_noise_, innovations);
        if (best.cost - linear > 10 && null_cost_ - null_linear > -10) {
            null_by_record_.clear();
            fit_null();
            fit_singles();
            return;
        }
        experiment_->set_hold(true);
    }

    /// Coloured sensor noise would pass for an effect, and an effect for coloured noise: it was looked for beside the declared model,
    /// now beside the best explanation; if the answer is another one, everything is judged again.
    void colour_noise() {
        for (int round = 0; round < 2; ++round) {
            HeaveNoise noise = noises_[best_single_];
            const FittedHypothesis& best = fitted_[best_single_];
            const double before = null_noise_.slow;
            const bool coloured = experiment_->fit_noise(best.hypothesis.with(best.fit.parameters), noise);
            if (!coloured && before == 0) {
                return;
            }
            if (coloured && before > 0 && noise.slow < 1.6 * before && noise.slow > before / 1.6) {
                return;
            }
            HeaveNoise null = noise;
            null.process = null_noise_.process;
            if (!coloured) {
                null.gap = experiment_->noise().gap;
            }
            set_null(null);
            fit_singles();
        }
    }

    void set_null(HeaveNoise noise) {
        experiment_->fit_process({}, noise);
        null_noise_ = noise;
        null_by_record_.clear();
        null_cost_ = experiment_->evaluate({}, nullptr, null_noise_, null_innovations_, &null_by_record_);
    }

    /// What each effect does to the innovations when it is small, as orthonormal columns.
    std::vector<DesignMatrix> directions() const {
        std::vector<DesignMatrix> list(singles_);
        core::parallel_for(singles_, [&](std::size_t i) {
            const Hypothesis& h = fitted_[i].hypothesis;
            DesignMatrix matrix;
            matrix.rows = null_innovations_.size();
            std::vector<double> moved;
            const std::vector<double>& start = h.starts.empty() ? fitted_[i].fit.parameters : h.starts.front();
            for (std::size_t j = 0; j < h.parameters.size(); ++j) {
                std::vector<double> p;
                for (std::size_t k = 0; k < h.parameters.size(); ++k) {
                    p.push_back(h.parameters[k].start);
                }
                // a shape or a phase shows only beside a strength
                if (h.names.front() == "periodic_disturbance") {
                    p = {1e-4, start[1], j == 0 ? 0.0 : 1.5707963};
                } else if (h.parameters.size() > 1 && j > 0) {
                    p.front() += 0.05 * h.parameters.front().typical;
                }
                if (h.names.front() != "periodic_disturbance") {
                    p[j] += 0.05 * h.parameters[j].typical;
                }
                experiment_->evaluate(h.with(p), nullptr, null_noise_, moved);
                ++matrix.columns;
                for (std::size_t k = 0; k < moved.size(); ++k) {
                    matrix.values.push_back(moved[k] - null_innovations_[k]);
                }
            }
            list[i] = orthonormal(matrix);
        });
        return list;
    }

    /// Chance that the fitted null model would show as much: innovations of the best explanation are reordered in blocks of a
    /// second with random signs (so colour that is left survives), and every linearised effect is fitted to each draw.
    void open_gate() {
        const std::vector<DesignMatrix> columns = directions();
        std::vector<double> noise_like = fitted_[best_single_].fit.residuals;
        const double size = root_mean_square(noise_like);
        const std::size_t n = noise_like.size();
        const std::size_t block = std::max<std::size_t>(8, static_cast<std::size_t>(1.0 / record_step) * (records_.velocity_measured ? 2 : 1));
        const auto chance = [](double gain, double columns_count) {
            const double tail = chi_squared_tail(gain, columns_count);
            return tail > 1e-290 ? -std::log10(tail) : 290 + gain / 10;
        };
        double observed = 0;
        for (std::size_t i = 0; i < singles_; ++i) {
            observed = std::max(observed, chance(fitted_[i].explained, static_cast<double>(fitted_[i].hypothesis.parameters.size())));
        }
        constexpr std::size_t draws = 199;
        std::vector<double> largest(draws, 0);
        core::parallel_for(draws, [&](std::size_t d) {
            core::Random random(options_.seed, d + 1);
            std::vector<double> drawn(n);
            for (std::size_t begin = 0; begin < n; begin += block) {
                const std::size_t from = random.below(n);
                const double sign = random.uniform() < 0.5 ? -1 : 1;
                for (std::size_t k = 0; k < block && begin + k < n; ++k) {
                    drawn[begin + k] = sign * noise_like[(from + k) % n] / size;
                }
            }
            for (const DesignMatrix& matrix : columns) {
                if (matrix.columns > 0) {
                    largest[d] = std::max(largest[d], chance(explained_square(matrix, drawn), static_cast<double>(matrix.columns)));
                }
            }
        }, progress_);
        const std::size_t as_large = static_cast<std::size_t>(std::count_if(largest.begin(), largest.end(), [&](double x) { return x >= observed; }));
        const double top = *std::max_element(largest.begin(), largest.end());
        // beyond every draw: the statistic is a negative decimal logarithm of a chance; its tail is given half its nominal steepness
        const double beyond = as_large == 0 ? std::min(0.5 * (observed - top), 12.0) : 0;
        gate_ = static_cast<double>(as_large + 1) / (draws + 1) * std::pow(10.0, -std::max(0.0, beyond));
    }

    void smooth_corrections() {
        const std::vector<std::vector<Variable>> sets{{},
                                                      {Variable::gap},
                                                      {Variable::heave_velocity},
                                                      {Variable::time},
                                                      {Variable::input_force},
                                                      {Variable::gap, Variable::heave_velocity}};
        whole_list_.resize(sets.size());
        core::parallel_for(sets.size(), [&](std::size_t i) {
            whole_list_[i] = experiment_->fit_smooth(sets[i], {}, null_noise_, null_cost_);
        }, progress_);
        whole_ = best_smooth(whole_list_).fit;
        const FittedHypothesis& best = fitted_[best_single_];
        rest_ = smooth_rest(best, noises_[best_single_]);
    }

    /// The correction of least Bayesian information criterion.
    const HeaveExperiment::Smooth& best_smooth(const std::vector<HeaveExperiment::Smooth>& list) const {
        const double penalty = std::log(static_cast<double>(experiment_->readings()));
        std::size_t best = 0;
        for (std::size_t i = 1; i < list.size(); ++i) {
            if (list[i].fit.gain - penalty * list[i].fit.degrees > list[best].fit.gain - penalty * list[best].fit.degrees) {
                best = i;
            }
        }
        return list[best];
    }

    SmoothFit smooth_rest(const FittedHypothesis& base, const HeaveNoise& noise) {
        const std::vector<std::vector<Variable>> sets{{Variable::gap}, {Variable::heave_velocity}, {Variable::time}, {Variable::input_force}};
        std::vector<HeaveExperiment::Smooth> list(sets.size());
        const std::vector<dynamics::EffectUse> uses = base.hypothesis.with(base.fit.parameters);
        core::parallel_for(sets.size(), [&](std::size_t i) { list[i] = experiment_->fit_smooth(sets[i], uses, noise, base.cost); }, progress_);
        SmoothFit best = best_smooth(list).fit;
        best.p = std::min(1.0, best.p * static_cast<double>(sets.size()));
        return best;
    }

    double structure_left(const SmoothFit& rest, double explained) const {
        const double left = std::max(0.0, rest.gain - rest.degrees);
        return left / std::max(left + std::max(explained, 0.0), 1e-12);
    }

    /// A second effect is looked for where the best single one leaves structure, and stays when it earns its place.
    void fit_pairs() {
        const double left = structure_left(rest_, fitted_[best_single_].explained);
        if (rest_.p > calibration_.unknown_p || left < 0.3 * calibration_.pair_share) {
            return;
        }
        std::vector<std::size_t> order(singles_);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return fitted_[a].score() < fitted_[b].score(); });
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        for (std::size_t a = 0; a < std::min<std::size_t>(2, singles_); ++a) {
            for (std::size_t b = a + 1; b < singles_; ++b) {
                pairs.emplace_back(order[a], order[b]);
            }
        }
        std::vector<FittedHypothesis> found(pairs.size());
        std::vector<HeaveNoise> noises(pairs.size());
        core::parallel_for(
            pairs.size(),
            [&](std::size_t k) {
                const auto [a, b] = pairs[k];
                Hypothesis second = fitted_[b].hypothesis;
                std::vector<double> start = second.starts.empty() ? fitted_[b].fit.parameters : second.starts.front();
                if (second.names.front() == "periodic_disturbance") {
                    const auto starts = experiment_->periodic_starts(fitted_[a].hypothesis.with(fitted_[a].fit.parameters), noises_[a], 1);
                    start = starts.empty() ? start : starts.front();
                }
                HeaveExperiment::Result result = fitted(joined(fitted_[a].hypothesis, fitted_[a].fit.parameters, second, start), noises_[a]);
                found[k] = std::move(result.fitted);
                noises[k] = result.noise;
            },
            progress_);
        const std::size_t best = best_hypothesis(found, 2);
        const double gain = fitted_[best_single_].score() - found[best].score();
        // two effects of one kind may be one effect whose law has another form than the catalogue's: that needs more to be believed
        const double share = calibration_.pair_share * (one_kind(found[best].hypothesis.names) ? 3 : 1);
        if (gain < calibration_.pair_gain || gain < share * found[best].explained) {
            return;
        }
        const SmoothFit rest = smooth_rest(found[best], noises[best]);
        if (rest.p > calibration_.unknown_p || structure_left(rest, found[best].explained) < 0.5 * calibration_.unknown_share) {
            fitted_.insert(fitted_.end(), found.begin(), found.end());
            noises_.insert(noises_.end(), noises.begin(), noises.end());
            rest_ = rest;
        }
    }

    static bool one_kind(const std::vector<std::string>& names) {
        static const std::vector<std::set<std::string>> kinds{
            {"linear_damping", "quadratic_damping", "squeeze_film_damping", "coulomb_friction", "history_force"},
            {"added_mass", "gap_dependent_added_mass", "history_force"},
            {"constant_force", "tether_stiffness", "surface_roughness", "gap_sensor_bias", "declared_parameter"},
            {"input_gain", "input_dead_zone", "input_delay", "actuator_lag", "gap_sensor_delay"}};
        return std::any_of(kinds.begin(), kinds.end(), [&](const std::set<std::string>& kind) {
            return std::all_of(names.begin(), names.end(), [&](const std::string& name) { return kind.count(name) > 0; });
        });
    }

    void decide() {
        attribution_ = attribute(fitted_, gate_, whole_, rest_, calibration_);
        result_.verdict = attribution_.verdict;
        result_.gate = gate_;
        result_.none_probability = attribution_.none_probability;
        result_.model = model_;
        after_noise_ = null_noise_;
        if (result_.verdict == "effect") {
            const FittedHypothesis& best = fitted_[attribution_.chosen];
            uses_ = best.hypothesis.with(best.fit.parameters);
            for (std::size_t j = 0; j < best.hypothesis.slots.size(); ++j) {
                const Hypothesis::Slot& slot = best.hypothesis.slots[j];
                uses_[slot.use].sigmas[slot.value] = std::isfinite(best.fit.sigma[j]) ? best.fit.sigma[j] : 0;
            }
            after_noise_ = noises_[attribution_.chosen];
        } else if (result_.verdict == "unknown") {
            const HeaveExperiment::Smooth& smooth = best_smooth(whole_list_);
            uses_ = {force_table(smooth.force)};
            after_noise_ = smooth.noise;
        }
        for (const dynamics::EffectUse& use : uses_) {
            result_.model = result_.model.with_effect(use);
        }
        result_.depends_on = whole_.variables;
    }

    void measure_error() {
        const HeaveRecords& records = test_records_ ? *test_records_ : records_;
        HeaveExperiment test(model_, records, test_, data_.declared_noise("gap"), data_.declared_noise("heave_velocity"));
        test.set_hold(experiment_->hold());
        for (const double horizon : {options_.horizon, 5 * options_.horizon}) {
            ErrorChange change;
            change.channel = "gap";
            change.unit = "m";
            change.horizon = horizon;
            change.noise = null_noise_.gap;
            std::vector<double> square, count;
            horizon_errors(test, {}, null_noise_, horizon, square, count);
            change.before = error_by_groups(square, count, options_.seed);
            change.after = change.before;
            if (!uses_.empty()) {
                horizon_errors(test, uses_, after_noise_, horizon, square, count);
                change.after = error_by_groups(square, count, options_.seed);
            }
            result_.error.push_back(change);
        }
    }

    /// Share of resampled runs in which the chosen names have the least score.
    double stability() const {
        if (result_.verdict == "none") {
            return result_.none_probability;
        }
        if (result_.verdict == "unknown") {
            return attribution_.unknown_probability;
        }
        core::Random random(options_.seed + 1);
        const std::size_t groups = null_by_record_.size();
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
                double score = one.occam;
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

    FoundEffect found(std::size_t index, double probability) const {
        const FittedHypothesis& one = fitted_[index];
        FoundEffect effect = found_effect(one, probability);
        const auto helped = std::count_if(one.explained_by_group.begin(), one.explained_by_group.end(), [](double x) { return x > 0; });
        effect.evidence = "-2 log likelihood falls by " + core::format_number(one.explained, 4) + " for " +
                          std::to_string(one.hypothesis.parameters.size()) + " free number(s), in " + std::to_string(helped) + " of " +
                          std::to_string(one.explained_by_group.size()) + " runs" +
                          (one.hypothesis.form.empty() ? "" : "; " + one.hypothesis.form);
        return effect;
    }

    void describe() {
        result_.noise["gap"] = {null_noise_.gap, "m",
                                experiment_->gap_noise_from() + (null_noise_.slow > 0 ? ", with coloured noise of " +
                                    core::format_number(null_noise_.slow, 3) + " m and " + core::format_number(null_noise_.slow_time, 2) + " s beside it" : ""),
                                records_.gap_noise};
        if (records_.velocity_measured) {
            result_.noise["heave_velocity"] = {null_noise_.velocity, "m/s", experiment_->velocity_noise_from(), records_.velocity_noise};
        }
        result_.stability = stability();
        if (result_.verdict == "effect") {
            const FittedHypothesis& best = fitted_[attribution_.chosen];
            for (FoundEffect& effect : split_by_name(found(attribution_.chosen, attribution_.shares.front().probability), best)) {
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
                               " % of the structure; a smooth force over " + list_of(whole_.variables) + " takes its place";
            result_.effects.push_back(std::move(unknown));
        }
        for (const Attribution::Share& share : attribution_.shares) {
            const bool is_verdict = result_.verdict == "effect" && share.hypothesis == attribution_.chosen;
            if (!is_verdict && result_.alternatives.size() < 6 && (share.probability > 1e-3 || result_.alternatives.size() < 3)) {
                FoundEffect rival = found(share.hypothesis, share.probability);
                rival.name = fitted_[share.hypothesis].hypothesis.label();
                if (result_.verdict == "effect") {
                    rival.told_apart_by = heave_told_apart(*experiment_, fitted_[attribution_.chosen], fitted_[share.hypothesis]);
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
        for (std::size_t i = 0; i < singles_; ++i) {
            const FittedHypothesis& one = fitted_[i];
            result_.limits.push_back({one.hypothesis.names.front(), one.hypothesis.parameters.front().name, 5 * one.fit.sigma.front(),
                                      one.hypothesis.parameters.front().unit});
        }
        next_heave_experiment(*experiment_, fitted_, attribution_, result_);
        for (const core::Problems* list : std::initializer_list<const core::Problems*>{&data_.problems, &records_.problems, &experiment_->problems()}) {
            result_.problems.insert(result_.problems.end(), list->begin(), list->end());
        }
        check_excitation();
        check_runs_agree();
        if (options_.consequence) {
            result_.consequence = heave_consequence(model_, result_.model, records_, progress_);
        }
        result_.sentence = verdict_sentence(result_);
        if (options_.figures) {
            result_.figures = heave_figures(*experiment_, null_noise_, uses_, result_);
        }
    }

    void check_excitation() {
        double widest = 0;
        for (const std::size_t r : train_) {
            const std::vector<double>& gap = records_.records[r].gap;
            std::vector<double> finite;
            std::copy_if(gap.begin(), gap.end(), std::back_inserter(finite), [](double x) { return std::isfinite(x); });
            widest = std::max(widest, quantile(finite, 0.95) - quantile(finite, 0.05));
        }
        if (widest < 20 * null_noise_.gap) {
            result_.problems.push_back({core::Problem::Severity::warning,
                                        "the body hardly moves in any run (" + core::format_number(1000 * widest, 2) +
                                            " mm): effects of velocity, acceleration and gap cannot be seen; only constant ones can",
                                        core::Place{data_.folder.string(), {}, {}, {}}});
        }
        for (std::size_t a = 0; a < records_.records.size(); ++a) {
            for (std::size_t b = a + 1; b < records_.records.size(); ++b) {
                if (records_.records[a].raw_input == records_.records[b].raw_input &&
                    std::equal(records_.records[a].gap.begin(), records_.records[a].gap.end(), records_.records[b].gap.begin(),
                               records_.records[b].gap.end())) {
                    result_.problems.push_back({core::Problem::Severity::warning,
                                                records_.records[a].name + " and " + records_.records[b].name +
                                                    " are the same run twice: everything looks more certain than it is",
                                                core::Place{data_.folder.string(), {}, {}, {}}});
                }
            }
        }
    }

    /// Runs that pull the answer apart.
    void check_runs_agree() {
        if (result_.verdict != "effect") {
            return;
        }
        const FittedHypothesis& best = fitted_[attribution_.chosen];
        const double total = std::max(best.explained, 1.0);
        std::string against;
        for (std::size_t r = 0; r < best.explained_by_group.size(); ++r) {
            if (best.explained_by_group[r] < -0.05 * total && best.explained_by_group[r] < -20) {
                against += (against.empty() ? "" : ", ") + records_.records[train_[r]].name;
            }
        }
        if (!against.empty()) {
            result_.problems.push_back({core::Problem::Severity::warning,
                                        "the runs contradict each other: what explains the others makes " + against +
                                            " worse; look at these runs apart",
                                        core::Place{data_.folder.string(), {}, {}, {}}});
        }
    }

    const dynamics::Model& model_;
    const dynamics::Measurements& data_;
    const DiscoverOptions& options_;
    core::Progress& progress_;
    Calibration calibration_ = heave_calibration();
    HeaveRecords records_;
    std::optional<HeaveRecords> test_records_;
    std::vector<std::size_t> train_;
    std::vector<std::size_t> test_;
    std::optional<HeaveExperiment> experiment_;
    HeaveNoise null_noise_;
    HeaveNoise after_noise_;
    double null_cost_ = 0;
    std::vector<double> null_innovations_;
    std::vector<double> null_by_record_;
    std::vector<Hypothesis> candidates_;
    std::vector<FittedHypothesis> fitted_;
    std::vector<HeaveNoise> noises_;
    std::size_t singles_ = 0;
    std::size_t best_single_ = 0;
    std::vector<HeaveExperiment::Smooth> whole_list_;
    SmoothFit whole_;
    SmoothFit rest_;
    double gate_ = 1;
    Attribution attribution_;
    std::vector<dynamics::EffectUse> uses_;
    Discovery result_;
};

}  // namespace

Discovery discover_time_series(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
                               core::Progress& progress) {
    return HeaveLoop(model, data, options, progress).run();
}

}  // namespace underbody::discovery
