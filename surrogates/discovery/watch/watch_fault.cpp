#include "surrogates/discovery/watch/watch_fault.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/no_limit.h"
#include "core/text.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/input_as_logged.h"

namespace underbody::discovery {

namespace {

/// Noises that a declared figure may be off by: sensors are worse than their sheets. As for measured runs and static
/// sets (Calibration::most_over_declared).
constexpr double most_over_declared = 2.5;
constexpr double by_chance = 1e-3;  ///< of as much noise as was learned, were the declared figure right
/// In -2 log likelihood, what a force must explain that noise does not: one in 20 million for one number; there are
/// four, and a noise that is not quite of the learned form makes more than chance does.
constexpr double least_explained = 30;
/// Errors of a size from none below which noise is not learned anew with it; without random forces and colour in the
/// noise these errors are too small, by four and more.
constexpr double shows = 3, shows_stiffly = 12;
constexpr double velocity_over = 0.25;  ///< s, to each side: a velocity out of readings
constexpr double still = 1e-13;         ///< m^2/s^3: no random force

enum Lacked { constant, with_velocity, with_gap, with_input, kinds };

/// What one newton (N s/m, N/m, 1) of each kind is at each step, N.
std::array<std::vector<double>, kinds> forces_of(const std::deque<WatchStep>& steps) {
    std::array<std::vector<double>, kinds> force;
    std::vector<double> time, gap;
    double sum = 0;
    for (const WatchStep& step : steps) {
        time.push_back(step.time);
        gap.push_back(std::isfinite(step.gap) ? step.gap : gap.empty() ? std::nan("") : gap.back());
        sum += gap.back();
    }
    const double middle = sum / static_cast<double>(steps.size());
    std::size_t from = 0, to = 0;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        while (time[from] < time[k] - velocity_over) {
            ++from;
        }
        while (to + 1 < time.size() && time[to] < time[k] + velocity_over) {
            ++to;
        }
        const double velocity = time[to] > time[from] ? (gap[to] - gap[from]) / (time[to] - time[from]) : 0;
        force[constant].push_back(1);
        force[with_velocity].push_back(std::isfinite(velocity) ? velocity : 0);
        force[with_gap].push_back(std::isfinite(middle) ? gap[k] - middle : 0);
        force[with_input].push_back(steps[k].command);
    }
    return force;
}

constexpr std::array<std::size_t, kinds> direction{0, 1, 3, 4};  ///< of WatchInnovation::slope

/// The sizes that serve best, each alone and to first order, and how many of their errors they are.
struct Sizes {
    std::array<double, kinds> size{}, errors{};
};
Sizes sizes_of(const WatchPlant& plant, const std::deque<WatchStep>& steps, const WatchNoise& noise) {
    WatchResiduals residuals(plant, noise.noise);
    residuals.set_colours(noise.colours);
    std::array<double, kinds> score{}, information{};
    for (const WatchStep& step : steps) {
        for (const auto& one : residuals.take(step)) {
            for (std::size_t j = 0; one && j < kinds; ++j) {
                score[j] += one->value * one->slope[direction[j]];
                information[j] += one->slope[direction[j]] * one->slope[direction[j]];
            }
        }
    }
    Sizes out;
    for (std::size_t j = 0; j < kinds; ++j) {
        if (information[j] > 0) {
            out.size[j] = score[j] / information[j];
            out.errors[j] = std::abs(score[j]) / std::sqrt(information[j]);
        }
    }
    return out;
}

std::deque<WatchStep> with_force(std::deque<WatchStep> steps, const std::vector<double>& force, double size) {
    for (std::size_t k = 0; k < steps.size(); ++k) {
        steps[k].input += size * force[k];
    }
    return steps;
}

/// What a model that is taken at its word is wrong by in the next reading, over how far the gap moves: 1 and more where
/// it says nothing of the motion.
double misfit(const WatchPlant& plant, const std::deque<WatchStep>& steps) {
    constexpr double sure = 0.02;        // noise of a reading, of how far the gap moves
    constexpr std::size_t settled = 50;  // readings by which the state is known
    double sum = 0, squares = 0, count = 0;
    for (const WatchStep& step : steps) {
        if (std::isfinite(step.gap)) {
            sum += step.gap;
            squares += step.gap * step.gap;
            ++count;
        }
    }
    const double spread = count > 0 ? std::sqrt(std::max(0.0, squares / count - sum * sum / count / count)) : 0;
    if (!(spread > 0)) {
        return 0;
    }
    HeaveNoise noise;
    noise.gap = sure * spread;
    noise.slow = 0;
    noise.process = still;
    WatchFilter filter(plant, noise);
    bool begun = false;
    double wrong = 0, readings = 0;
    for (const WatchStep& step : steps) {
        if (!begun && std::isfinite(step.gap)) {
            filter.restart(step.time, step.gap);
            begun = true;
        } else if (begun) {
            filter.advance(step);
            if (std::isfinite(step.gap)) {
                const WatchInnovation seen = filter.gap_innovation(step);
                filter.absorb(seen, seen.normal);
                wrong += ++readings > settled ? std::pow(seen.normal * seen.sigma, 2) : 0;
            }
        }
    }
    const double rms = readings > settled ? std::sqrt(wrong / (readings - settled)) / spread : 0;
    return std::isfinite(rms) ? rms : core::no_limit;
}

double total(const WatchNoise& noise) { return std::hypot(noise.noise.gap, noise.noise.slow); }

}  // namespace

std::optional<WatchDoubt> doubtful_log(const WatchPlant& plant, const std::deque<WatchStep>& steps) {
    constexpr double nothing = 0.5, fits = 0.1;  // of how far the gap moves
    if (!(misfit(plant, steps) > nothing)) {
        return {};
    }
    const bool pushed = std::any_of(steps.begin(), steps.end(),
                                    [&](const WatchStep& step) { return step.command != steps.front().command; });
    std::optional<WatchDoubt> found;
    double least = fits;
    const auto attempt = [&](const WatchDoubt& doubt, const std::deque<WatchStep>& read) {
        const double own = misfit(plant, read);
        if (own > 0 && own < least) {
            least = own;
            found = doubt;
        }
    };
    for (const double factor : {1e-3, 1e3, -1.0}) {
        std::deque<WatchStep> read = steps;
        for (WatchStep& step : read) {
            step.gap *= factor;
        }
        const std::string times = core::format_number(factor, 4);
        attempt({"this log is not the model's: its motion fits a gap of " + times + " times the recorded one",
                 factor == 1e-3  ? "is the column's unit mm, and was it read in m?"
                 : factor == 1e3 ? "is the column's unit m, and was it read in mm?"
                                 : "gap counts upward from the ground: turn its sign"},
                read);
        if (pushed) {
            read = steps;
            for (WatchStep& step : read) {
                step.input *= factor;
                step.command *= factor;
            }
            attempt({dynamics::doubt_text({0, factor, "input_force"}, {"input_force"}),
                     "mend the column, or read it so: [records] input_force_factor = " + times + " in the model"},
                    read);
        }
    }
    if (pushed) {
        // what is logged as input at a reading is the mean up to the next one
        std::deque<WatchStep> read(steps.begin() + 1, steps.end() - 1);
        for (std::size_t k = 0; k < read.size(); ++k) {
            read[k].gap = steps[k + 2].command;
            read[k].input = read[k].command = steps[k].gap;
        }
        attempt({"gap and input_force look exchanged: their motion fits the model with each in the other's place",
                 "exchange the two names in the header line"},
                read);
    }
    return found;
}

std::optional<WatchFault> fault_from_the_begin(const WatchPlant& plant, const std::deque<WatchStep>& steps,
                                               const WatchNoise& learned, std::optional<double> declared) {
    WatchFault fault;
    fault.noise = total(learned);
    if (declared) {
        fault.declared = *declared;
        // as many independent readings as there are: of coloured noise one in two correlation times
        const double each = (steps.back().time - steps.front().time) / static_cast<double>(steps.size()),
                     count = static_cast<double>(steps.size()) * each / std::max(each, 2 * learned.correlation_time),
                     ratio = fault.noise / *declared;
        fault.noisier = ratio > most_over_declared && chi_squared_tail(count * ratio * ratio, count) < by_chance;
    }
    // first without random forces and colour, which follow whatever is missing
    WatchNoise stiff;
    stiff.noise = learned.noise;
    stiff.noise.gap = fault.noise;
    stiff.noise.slow = 0;
    stiff.noise.process = std::min(still, learned.noise.process);
    const auto force = forces_of(steps);
    for (const WatchNoise* begin : {static_cast<const WatchNoise*>(&stiff), &learned}) {
        const Sizes first = sizes_of(plant, steps, *begin);
        const auto most =
            static_cast<std::size_t>(std::max_element(first.errors.begin(), first.errors.end()) - first.errors.begin());
        if (fault.gain > 0 || first.errors[most] < (begin == &stiff ? shows_stiffly : shows)) {
            continue;
        }
        double size = first.size[most];
        WatchNoise noise = learn_noise(plant, with_force(steps, force[most], size), learned.noise);
        // once more beside the noise that is left
        size += sizes_of(plant, with_force(steps, force[most], size), noise).size[most];
        noise = learn_noise(plant, with_force(steps, force[most], size), noise.noise);
        const double without = std::min(learned.cost, noise_cost(plant, steps, noise.noise)),
                     gain = without - noise.cost;
        if (gain > std::max(least_explained, fault.gain)) {
            constexpr const char* words[kinds] = {"a constant force", "a force that grows with the velocity",
                                                  "a force that grows with the gap",
                                                  "a force that grows with the input"};
            const char* const side = most == constant ? (size > 0 ? ", up" : ", down")
                                     : size > 0       ? ", with it"
                                                      : ", against it";
            fault.gain = gain;
            fault.shows = std::string(words[most]) + side;
            fault.force = most == constant ? size : 0;
            fault.noise_with_it = total(noise);
        }
    }
    return fault.noisier || fault.gain > 0 ? std::optional(fault) : std::nullopt;
}

}  // namespace underbody::discovery
