// What is promised of a next experiment: it is simulated as it will be done, with the controller that the logs show in
// the loop, and judged as discover() will judge it.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/discovery/guards.h"
#include "surrogates/discovery/motion/motion_controller.h"
#include "surrogates/discovery/motion/motion_loop.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr std::size_t simulated = 4;       ///< runs of each explanation
constexpr std::size_t draws = 300;         ///< of experiments out of them
constexpr std::size_t blocks_wanted = 12;  ///< as the guards take them
constexpr double settled_odds = 20;
constexpr std::size_t most_rows = 1000;  ///< of a long run: its first ones, which tell no more than all of it
constexpr double likely = 0.05;          ///< a rival less likely than that is not simulated as the truth

/// Held-out windows of one run by two models: errors in noise, and what the first misses beyond the second.
struct RunErrors {
    std::vector<std::vector<double>> left, missed;  ///< by window
};

std::vector<RunErrors> by_run(const WindowSquares& before, const WindowSquares& after, std::size_t runs) {
    std::vector<RunErrors> out(runs);
    std::size_t from = 0;
    for (std::size_t w = 0; w < after.record.size(); ++w) {
        const auto count = static_cast<std::size_t>(after.count[w]);
        std::vector<double> left, missed;
        for (std::size_t i = from; i < from + count; ++i) {
            left.push_back(after.errors[i]);
            missed.push_back(before.errors[i] - after.errors[i]);
        }
        from += count;
        out[after.record[w]].left.push_back(std::move(left));
        out[after.record[w]].missed.push_back(std::move(missed));
    }
    return out;
}

/// Adds a run's windows; `size`: of the effect over that of the simulation.
void add(const RunErrors& run, double size, WindowSquares& before, WindowSquares& after, std::size_t as) {
    for (std::size_t w = 0; w < run.left.size(); ++w) {
        std::vector<double> missing;
        for (std::size_t i = 0; i < run.left[w].size(); ++i) {
            missing.push_back(run.left[w][i] + size * run.missed[w][i]);
        }
        const auto put = [&](WindowSquares& windows, const std::vector<double>& errors) {
            windows.record.push_back(as);
            windows.square.push_back(sum_of_squares(errors));
            windows.count.push_back(static_cast<double>(errors.size()));
            windows.errors.insert(windows.errors.end(), errors.begin(), errors.end());
        };
        put(before, missing);
        put(after, run.left[w]);
    }
}

/// What is simulated of the run of the experiment.
MotionRecord simulated_part(const MotionRig& rig) {
    MotionRecord part = longest_record(rig);
    part.last = std::min(part.last, part.first + most_rows - 1);
    return part;
}

/// Where the first number does nothing.
double neutral_of(const Hypothesis& hypothesis) {
    return hypothesis.slots.empty() ? 0 : hypothesis.uses[hypothesis.slots[0].use].values[hypothesis.slots[0].value];
}

}  // namespace

MotionLoop::Repeats MotionLoop::repeats_of(const MotionRig& rig, const MotionTrial& trial,
                                           const std::vector<InputAnswer>& answers,
                                           const std::vector<dynamics::EffectUse>& truth, const FittedHypothesis* rival,
                                           std::size_t repeats) const {
    Repeats out;
    out.runs.resize(simulated);
    const dynamics::Model real = model_with(truth);
    const MotionRecord part = simulated_part(rig);
    core::parallel_for(simulated, [&](std::size_t i) {
        core::Random random(options_.seed + 79, i);
        out.runs[i] = run_again(rig, real, part, trial, answers, random);
        out.runs[i].name += "-again-" + std::to_string(i + 1);
        out.runs[i].table.source = out.runs[i].name;
    });
    dynamics::Measurements again = data_;
    again.runs = out.runs;
    std::vector<std::size_t> all(simulated);
    for (std::size_t i = 0; i < simulated; ++i) {
        all[i] = i;
    }
    core::Problems not_told;
    MotionExperiment experiment(motion_, model_, again, motion_records(motion_, model_, again, all, not_told));
    if (experiment.records().size() < simulated) {
        return out;  // the body comes to the ground at once
    }
    experiment.read(experiment_->reading());
    std::vector<double> own, other;
    const auto distance = [&](const std::vector<dynamics::EffectUse>& uses, std::vector<double>& there) {
        experiment.evaluate(uses, null_noise_, there);
        double sum = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
            sum += std::pow(std::clamp(there[i] - own[i], -100.0, 100.0), 2);
        }
        return sum / static_cast<double>(simulated);
    };
    experiment.evaluate(truth, null_noise_, own);
    out.explained = out.apart = distance({}, other);
    if (rival == nullptr) {
        return out;
    }
    const std::vector<dynamics::EffectUse> uses = rival->hypothesis.with(rival->fit.parameters);
    out.apart = distance(uses, other);
    // its numbers will be fitted to the old runs and these: what they can take back of the distance
    const auto n = static_cast<Eigen::Index>(rival->fit.parameters.size());
    std::vector<std::vector<double>> steps;
    Eigen::VectorXd size(n);
    for (Eigen::Index j = 0; j < n; ++j) {
        const auto at = static_cast<std::size_t>(j);
        const FitParameter& p = rival->hypothesis.parameters[at];
        const double sigma = rival->fit.sigma[at];
        size(j) = std::isfinite(sigma) && sigma > 0 ? std::min(sigma, 0.1 * p.typical) : 0.02 * p.typical;
        std::vector<double> moved = rival->fit.parameters;
        size(j) = moved[at] + size(j) > p.upper ? -size(j) : size(j);
        moved[at] += size(j);
        steps.push_back(std::move(moved));
    }
    const auto rows = static_cast<Eigen::Index>(own.size());
    const Eigen::Map<const Eigen::VectorXd> true_one(own.data(), rows), false_one(other.data(), rows);
    Eigen::MatrixXd answer(rows, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        std::vector<double> there;
        experiment.evaluate(rival->hypothesis.with(steps[static_cast<std::size_t>(j)]), null_noise_, there);
        answer.col(j) = Eigen::Map<const Eigen::VectorXd>(there.data(), rows) - false_one;
    }
    const double share = static_cast<double>(repeats) / static_cast<double>(simulated);
    Eigen::MatrixXd known = share * answer.transpose() * answer;
    if (rival->fit.covariance.size() == rival->fit.parameters.size() * rival->fit.parameters.size()) {
        const Eigen::Map<const Eigen::MatrixXd> covariance(rival->fit.covariance.data(), n, n);
        const Eigen::MatrixXd old = covariance.completeOrthogonalDecomposition().pseudoInverse();
        if (old.allFinite()) {
            known += size.asDiagonal() * old * size.asDiagonal();
        }
    }
    const Eigen::VectorXd slope = share * answer.transpose() * (false_one - true_one);
    const double taken = slope.dot(known.completeOrthogonalDecomposition().solve(slope));
    out.apart = std::max(0.0, out.apart - (std::isfinite(taken) ? taken : 0) / static_cast<double>(repeats));
    return out;
}

/// The strength of the true effect is as unsure as the old runs leave it. It is settled where the odds are 20 after all
/// runs, the gate opens, and the held-out error falls: of a quarter of all runs, old and new ones alike.
double MotionLoop::chance_to_settle_by(const MotionRig& rig, const MotionTrial& trial,
                                       const std::vector<InputAnswer>& answers, const FittedHypothesis& truth,
                                       const FittedHypothesis* rival, std::size_t repeats) const {
    const Hypothesis& law = truth.hypothesis;
    const double neutral = neutral_of(law), strength = truth.fit.parameters.front() - neutral;
    const double sigma = std::isfinite(truth.fit.sigma.front()) ? truth.fit.sigma.front() : 0;
    std::vector<double> numbers = truth.fit.parameters;
    const double shown = std::abs(strength) < sigma ? std::copysign(sigma, strength) : strength;
    numbers.front() = std::clamp(neutral + shown, law.parameters.front().lower, law.parameters.front().upper);
    if (numbers.front() == neutral) {
        return 0;
    }
    const std::vector<dynamics::EffectUse> uses = law.with(numbers);
    const Repeats again = repeats_of(rig, trial, answers, uses, rival, repeats);
    const std::size_t old_held = test_data_.runs.size();
    dynamics::Measurements both = test_data_;
    both.runs.insert(both.runs.end(), again.runs.begin(), again.runs.end());
    // as the guards do: over the horizon, and for what is slow over five of them
    const double horizons[] = {options_.horizon, 5 * options_.horizon},
                 tails[] = {calibration_.fall_tail, calibration_.fall_tail / 4};
    std::vector<RunErrors> errors[2];
    for (std::size_t h = 0; h < 2; ++h) {
        const WindowSquares before = together(answer_of({}, horizons[h], experiment_->reading(), both)),
                            after = together(answer_of(uses, horizons[h], experiment_->reading(), both));
        if (before.record != after.record || before.count != after.count || before.record.empty()) {
            return 0;
        }
        errors[h] = by_run(before, after, both.runs.size());
    }

    const double observed = surprise(truth.explained, static_cast<double>(truth.fit.parameters.size()));
    // the largest of noise, as chance_among() has it: from the chance that it stated, or as usual for these probes
    constexpr double of_draws = 0.005, usual_top = 3.9;
    const double top = gate_ < of_draws ? observed - 2 * std::log10(of_draws / gate_) : usual_top;
    const auto chance_in_noise = [&](double explained) {
        const double own = surprise(explained, static_cast<double>(truth.fit.parameters.size()));
        return own > top ? of_draws * std::pow(10.0, -std::min(0.5 * (own - top), 12.0)) : 1.0;
    };
    core::Random random(options_.seed + 80);
    const std::size_t old_runs = data_.runs.size(), all_runs = old_runs + repeats;
    const std::size_t held = std::max<std::size_t>(1, all_runs / 4);
    const auto times = static_cast<double>(repeats);
    std::size_t settled = 0;
    for (std::size_t draw = 0; draw < draws; ++draw) {
        const double size = (strength + sigma * random.normal()) / (numbers.front() - neutral);
        const double apart = size * size * times * again.apart;
        const double evidence = apart + 2 * std::sqrt(apart) * random.normal();
        const double explained = truth.explained + size * size * times * again.explained;
        bool enough = chance_in_noise(explained) < calibration_.gate;
        if (rival != nullptr) {
            const double temperature = 1 + calibration_.form_share * std::max(0.0, explained);
            const double odds = (rival->score() - rival->occam - truth.score() + truth.occam + evidence) / temperature +
                                rival->occam - truth.occam +
                                2 * std::log(truth.hypothesis.prior / rival->hypothesis.prior);
            enough = enough && odds > 2 * std::log(settled_odds);
        } else {
            enough = enough && 0.5 * chance_in_noise(explained) / calibration_.even_none < 1 / (1 + settled_odds);
        }
        if (!enough) {
            continue;
        }
        // which runs will be held out
        std::vector<std::size_t> out;
        for (std::size_t old_left = old_runs, new_left = repeats; out.size() < (held_out_is_told_ ? old_held : held);) {
            const bool of_old = held_out_is_told_ || random.below(old_left + new_left) < old_left;
            out.push_back(held_out_is_told_ ? out.size()
                          : of_old          ? random.below(old_held)
                                            : old_held + random.below(simulated));
            (of_old ? old_left : new_left) -= 1;
        }
        const auto fall = [&](std::size_t h) {
            WindowSquares with, without;
            for (std::size_t i = 0; i < out.size(); ++i) {
                add(errors[h][out[i]], out[i] < old_held ? 1 : size, without, with, i);
            }
            return paired_fall(without.blocks(out.size(), blocks_wanted), with.blocks(out.size(), blocks_wanted),
                               tails[h]);
        };
        const PairedFall chief = fall(0);
        const bool falls = chief.falls() || (!chief.rises() && chief.mean > 0 && fall(1).falls());
        settled += falls ? 1 : 0;
    }
    return static_cast<double>(settled) / static_cast<double>(draws);
}

MotionPromise MotionLoop::promise_of(const MotionRig& rig, const MotionTrial& trial,
                                     const std::vector<InputAnswer>& answers, const MotionQuestion& question,
                                     std::size_t repeats) const {
    const FittedHypothesis& one = fitted_[question.one];
    const FittedHypothesis* rival = question.rival ? &fitted_[*question.rival] : nullptr;
    MotionPromise promise;
    const auto chance = [&](const FittedHypothesis& truth, const FittedHypothesis* other) {
        try {
            return chance_to_settle_by(rig, trial, answers, truth, other, repeats);
        } catch (const core::Error&) {
            return 0.0;  // with such inputs the body cannot move
        }
    };
    promise.chance = chance(one, rival);
    if (rival != nullptr && attribution_.shares.size() > 1) {
        const double own = attribution_.shares[0].probability, others = attribution_.shares[1].probability,
                     share = own + others > 0 ? others / (own + others) : 0;
        if (share > likely) {
            promise.chance += share * (chance(*rival, &one) - promise.chance);
        }
    }
    const auto some = [&](InputAnswer::Found found) {
        return std::any_of(answers.begin(), answers.end(), [&](const InputAnswer& a) { return a.found == found; });
    };
    promise.controller = "; the chance is of runs simulated with it";
    const MotionRecord part = simulated_part(rig);
    if (part.last < longest_record(rig).last) {
        const std::vector<double>& time = rig.data.runs[part.run].table.numbers("time");
        promise.controller += " over " + core::format_number(time[part.last] - time[part.first], 3) + " s, and no less";
    }
    if (some(InputAnswer::Found::answers)) {
        promise.controller += ", with the controller that the logs show in the loop";
    }
    if (some(InputAnswer::Found::unread)) {
        promise.controller += "; how a controller answers could not be read from the logs and is not counted";
    }
    return promise;
}

}  // namespace underbody::discovery
