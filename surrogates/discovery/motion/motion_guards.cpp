// What a verdict may say: judged by runs that nothing was fitted to, beside twins in which nothing is missing.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/parallel.h"
#include "core/random.h"
#include "surrogates/discovery/motion/motion_loop.h"
#include "surrogates/discovery/report_findings.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr std::size_t blocks_wanted = 12;     ///< of held-out runs: enough for Student's t, each of several windows
constexpr std::size_t twins_each = 2;         ///< draws of noise for each window
constexpr std::size_t twins_for_chance = 24;  ///< the same, where it matters how much they differ

void add(WindowSquares& windows, std::size_t run, const std::vector<double>& errors) {
    windows.record.push_back(run);
    windows.square.push_back(sum_of_squares(errors));
    windows.count.push_back(static_cast<double>(errors.size()));
    windows.errors.insert(windows.errors.end(), errors.begin(), errors.end());
}

/// Noise of a sensor over samples at these times: white, and coloured where there is any.
std::vector<double> drawn_noise(const std::vector<double>& time, std::size_t from, std::size_t end,
                                const MotionNoise& noise, std::size_t state, core::Random& random) {
    const double slow = noise.slow[state];
    double coloured = slow * random.normal();
    std::vector<double> out;
    for (std::size_t k = from; k <= end; ++k) {
        out.push_back(coloured + noise.white[state] * random.normal());
        if (k < end && slow > 0) {
            const double decay = std::exp(-(time[k + 1] - time[k]) / noise.slow_time);
            coloured = decay * coloured + std::sqrt(1 - decay * decay) * slow * random.normal();
        }
    }
    return out;
}

}  // namespace

dynamics::Model MotionLoop::model_with(const std::vector<dynamics::EffectUse>& uses) const {
    dynamics::Model model = model_;
    model.records = experiment_->reading();
    for (const dynamics::EffectUse& use : uses) {
        model = model.with_effect(use);
    }
    return model;
}

MotionLoop::Answer MotionLoop::answer_of(const std::vector<dynamics::EffectUse>& uses, double horizon) const {
    return answer_of(uses, horizon, experiment_->reading(), test_data_);
}

MotionLoop::Answer MotionLoop::answer_of(const std::vector<dynamics::EffectUse>& uses, double horizon,
                                         const dynamics::RecordReading& reading,
                                         const dynamics::Measurements& data) const {
    Answer answer{uses, reading, &data, horizon, {}, {}};
    dynamics::PredictOptions options;
    options.horizon = horizon;
    dynamics::Model model = model_with(uses);
    model.records = reading;
    answer.runs = dynamics::predict_motion_runs(motion_, model, data, options, progress_);
    answer.windows.resize(channels_.size());
    for (std::size_t r = 0; r < answer.runs.size(); ++r) {
        dynamics::MeasuredMotion& run = *answer.runs[r].run;
        for (const dynamics::MotionWindow& window : answer.runs[r].windows) {
            for (std::size_t c = 0; c < channels_.size(); ++c) {
                const std::vector<double>& read = run.readings().value[channels_[c]];
                std::vector<double> errors;
                for (std::size_t k = window.start; !read.empty() && k <= window.end; ++k) {
                    if (std::isfinite(read[k])) {
                        errors.push_back(run.reading(k, channels_[c], window.at(k)) - read[k]);
                    }
                }
                add(answer.windows[c], r, errors);
            }
        }
    }
    return answer;
}

WindowSquares MotionLoop::together(const Answer& answer) const {
    WindowSquares all;
    std::vector<std::size_t> from(channels_.size(), 0);
    for (std::size_t w = 0; w < answer.windows.front().record.size(); ++w) {
        std::vector<double> errors;
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            const WindowSquares& own = answer.windows[c];
            const std::size_t end = from[c] + static_cast<std::size_t>(own.count[w]);
            for (; from[c] < end; ++from[c]) {
                errors.push_back(own.errors[from[c]] / null_noise_.total(channels_[c]));
            }
        }
        add(all, answer.windows.front().record[w], errors);
    }
    return all;
}

PairedFall MotionLoop::fall(const Answer& before, const Answer& after, double tail) const {
    const std::size_t runs = test_data_.runs.size();
    return paired_fall(together(before).blocks(runs, blocks_wanted), together(after).blocks(runs, blocks_wanted), tail);
}

bool MotionLoop::falls(const Answer& before, const Answer& after) const {
    const PairedFall chief = fall(before, after, calibration_.fall_tail);
    if (chief.falls() || chief.rises() || !(chief.mean > 0)) {
        return chief.falls();
    }
    // slow effects show over longer predictions: there as well, at the price that it has in heave
    const auto longer = [](const Answer& answer, const MotionLoop& loop) {
        return loop.answer_of(answer.uses, 5 * answer.horizon, answer.reading, *answer.data);
    };
    return fall(longer(before, *this), longer(after, *this), calibration_.fall_tail / 4).falls();
}

double MotionLoop::Twins::error(std::size_t channel) const {
    double sum = 0, draws = 0;
    for (const std::vector<double>& window : square[channel]) {
        sum += std::accumulate(window.begin(), window.end(), 0.0);
        draws = std::max(draws, static_cast<double>(window.size()));
    }
    return count[channel] > 0 && draws > 0 ? std::sqrt(sum / draws / count[channel]) : 0;
}

double MotionLoop::Twins::chance(std::size_t channel, double error, std::uint64_t seed) const {
    constexpr int sets = 4000;
    core::Random random(seed, channel);
    int larger = 0;
    for (int set = 0; set < sets; ++set) {
        double sum = 0;
        for (const std::vector<double>& window : square[channel]) {
            sum += window.empty() ? 0 : window[random.below(window.size())];
        }
        larger += sum >= error * error * count[channel] ? 1 : 0;
    }
    return (larger + 1.0) / (sets + 1.0);
}

bool MotionLoop::twin_errors(dynamics::MeasuredMotion& run, const dynamics::MotionWindow& window, core::Random& random,
                             std::vector<std::vector<double>>& errors) const {
    dynamics::MotionReadings twin = run.readings();
    for (const std::size_t i : channels_) {
        const std::vector<double> noise = drawn_noise(run.time(), window.from, window.end, null_noise_, i, random);
        for (std::size_t k = window.from; !twin.value[i].empty() && k <= window.end; ++k) {
            double& reading = twin.value[i][k];
            reading = std::isfinite(reading) ? run.reading(k, i, window.at(k)) + noise[k - window.from] : reading;
        }
    }
    const auto state = dynamics::fitted_state(run, twin, window.from, window.start);
    if (!state) {
        return false;
    }
    const std::vector<dynamics::MotionState> motion = dynamics::motion_from(run, *state, window.from, window.end);
    errors.assign(channels_.size(), {});
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const std::vector<double>& read = twin.value[channels_[c]];
        for (std::size_t k = window.start; !read.empty() && k <= window.end; ++k) {
            const double error = run.reading(k, channels_[c], motion[k - window.from]) - read[k];
            if (std::isfinite(error)) {
                errors[c].push_back(error);
            }
        }
    }
    return true;
}

MotionLoop::Twins MotionLoop::twins_of(const Answer& answer, std::size_t draws) const {
    using Squares = std::vector<std::vector<double>>;  // by window and draw
    const std::size_t runs = answer.runs.size();
    std::vector<std::vector<Squares>> squares(runs, std::vector<Squares>(channels_.size()));
    std::vector<std::vector<double>> counts(runs, std::vector<double>(channels_.size(), 0));
    core::parallel_for(
        runs,
        [&](std::size_t r) {
            core::Random random(options_.seed + 77, r);
            std::vector<std::vector<double>> errors;
            for (const dynamics::MotionWindow& window : answer.runs[r].windows) {
                for (Squares& own : squares[r]) {
                    own.emplace_back();
                }
                for (std::size_t draw = 0; draw < draws; ++draw) {
                    if (!twin_errors(*answer.runs[r].run, window, random, errors)) {
                        continue;
                    }
                    for (std::size_t c = 0; c < channels_.size(); ++c) {
                        counts[r][c] += squares[r][c].back().empty() ? static_cast<double>(errors[c].size()) : 0;
                        squares[r][c].back().push_back(sum_of_squares(errors[c]));
                    }
                }
            }
        },
        progress_);
    Twins twins{std::vector<Squares>(channels_.size()), std::vector<double>(channels_.size(), 0)};
    for (std::size_t r = 0; r < runs; ++r) {
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            twins.square[c].insert(twins.square[c].end(), squares[r][c].begin(), squares[r][c].end());
            twins.count[c] += counts[r][c];
        }
    }
    return twins;
}

/// Judged channel by channel: a moment that is missing may leave the gap's error as small as noise. A few windows in
/// coloured noise differ much from each other: their error is also noise where noise makes it often enough.
bool MotionLoop::rest_is_noise(const Answer& answer) {
    const Twins few = twins_of(answer, twins_each);
    std::optional<Twins> many;
    const std::size_t runs = test_data_.runs.size();
    double worst = -1;
    bool noise = true;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const double error = answer.error(c, runs), unit = null_noise_.total(channels_[c]);
        bool own = error <= calibration_.most_over_twins * few.error(c);
        if (!own) {
            many = many ? many : twins_of(answer, twins_for_chance);
            own = many->chance(c, error, options_.seed + 78) > calibration_.rest_chance;
        }
        noise = noise && own;
        const double twins = (many ? *many : few).error(c), ratio = twins > 0 ? error / twins : 0;
        if (ratio > worst) {  // in noises of that channel; report_error gives them the unit of the first error
            worst = ratio;
            result_.rest.twins = twins / unit;
            result_.rest.unexplained = std::sqrt(std::max(0.0, error * error - twins * twins)) / unit;
        }
    }
    result_.rest.is_noise = noise;
    return noise;
}

double MotionLoop::share_left(const Answer& declared, const Answer& answer) const {
    const Twins twins = twins_of(answer, twins_each);
    const std::size_t runs = test_data_.runs.size();
    double missed = 0, left = 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const double unit = null_noise_.total(channels_[c]), noise = std::pow(twins.error(c), 2);
        missed += (std::pow(declared.error(c, runs), 2) - noise) / (unit * unit);
        left += (std::pow(answer.error(c, runs), 2) - noise) / (unit * unit);
    }
    return missed > 0 ? std::max(left, 0.0) / missed : 0;
}

/// A table over time says nothing of another run, and of the loads only the lift has a place for one in a model.
std::optional<dynamics::EffectUse> MotionLoop::smooth_force() const {
    if (!likeliest_smooth_ || likeliest_smooth_->variables.empty() ||
        shape().loads[likeliest_smooth_->axis].quantity != "lift_force") {
        return {};
    }
    for (const std::string& variable : likeliest_smooth_->variables) {
        dynamics::Channel channel{};
        if (!dynamics::find_channel(variable, channel) || channel == dynamics::Channel::time) {
            return {};
        }
    }
    return experiment_->fit_smooth(*likeliest_smooth_, null_noise_, calibration_.correction_reach).use;
}

bool MotionLoop::correct(const Answer& before) {
    if (!smooth_force_) {
        smooth_force_ = smooth_force();
    }
    if (!*smooth_force_ || !falls(before, answer_of({**smooth_force_}, options_.horizon))) {
        return false;
    }
    uses_ = {**smooth_force_};
    return true;
}

void MotionLoop::decide() {
    attribution_ = attribute(fitted_, gate_, rest_.fit, calibration_);
    result_.verdict = attribution_.verdict;
    result_.gate = gate_;
    result_.structure = gate_ < calibration_.gate;
    guard();
    result_.none_probability = attribution_.none_probability;
    result_.model = model_with(uses_);
    if (result_.verdict != "none") {
        result_.depends_on = whole_.variables;
    }
}

/// As in heave: the fit of each window finds where it begins, and runs may contradict each other all the same.
void MotionLoop::call_runs_unlike() {
    result_.verdict = "unknown";
    whole_.variables = {"time"};
    rule_out_none(attribution_, 1 - result_.by_run->chance);
}

/// Guards the verdict of the likelihoods: a name needs a held-out error that falls, and a name and "none" a rest that
/// is noise.
void MotionLoop::guard() {
    const Answer declared = answer_of({}, options_.horizon);
    bool quiet = true;
    if (result_.verdict == "effect") {
        const FittedHypothesis& chosen = fitted_[attribution_.chosen];
        const Answer named = answer_of(found_effect(chosen, 1).uses, options_.horizon);
        if (!falls(declared, named)) {
            warn(chosen.hypothesis.label() +
                 " would explain the fitted runs better, but the held-out error does not fall with it beyond its "
                 "interval: it is not named");
            hold_names_down(attribution_, 0.5);
            result_.verdict = "none";
            look_run_by_run();  // nothing is left that all runs have in common
        } else {
            quiet = rest_is_noise(named);
            if (!quiet && (correct(named) || share_left(declared, named) > calibration_.most_left)) {
                result_.verdict = "unknown";
                give_to_unknown(attribution_, 0.8);
            } else {
                uses_ = named.uses;
            }
        }
    }
    if (result_.verdict == "unknown" && uses_.empty() && !correct(declared)) {
        cap_probabilities(attribution_, 0.5);
    }
    if (result_.verdict != "effect") {
        quiet = uses_.empty() ? rest_is_noise(declared) : rest_is_noise(answer_of(uses_, options_.horizon));
    }
    if (result_.verdict == "none" && result_.by_run) {
        call_runs_unlike();
    } else if (result_.verdict == "none" && !quiet) {
        result_.verdict = "unknown";
        if (correct(declared)) {
            quiet = rest_is_noise(answer_of(uses_, options_.horizon));
        }
        if (uses_.empty() && (whole_.variables.empty() || gate_ >= calibration_.gate)) {
            whole_.variables = {"time"};  // as a random force would: no variable explains it
        }
        rule_out_none(attribution_, 0.5);
    }
    if (result_.verdict == "unknown" && uses_.empty() && !result_.by_run) {
        look_run_by_run();  // what no law of all runs explains may be a number that each has of its own
    }
    if (result_.verdict != "unknown" || !uses_.empty()) {
        result_.by_run.reset();
    }
    result_.rest.is_noise = quiet;
    if (!quiet) {
        result_.rest.depends_on = result_.verdict == "effect" ? rest_.fit.variables : whole_.variables;
    }
}

}  // namespace underbody::discovery
