// Learning the noise of a vehicle that is its model.
#include <algorithm>
#include <cmath>
#include <functional>

#include "core/no_limit.h"
#include "core/normal.h"
#include "core/quantile.h"
#include "surrogates/discovery/watch/watch_residuals.h"

namespace underbody::discovery {

namespace {

constexpr double least_process = 1e-14, first_process = 1e-11;  ///< m^2/s^3, of the search
constexpr double grid_begin = 1e-10, grid_end = 2e-2;           ///< m^2/s^3, a decade a step
constexpr double shortest_colour = 0.02, longest_colour = 20;   ///< s
constexpr std::array<double, 3> colour_times{0.1, 0.4, 1.6};    ///< s, from which it begins
constexpr double rough = 0.2, fine = 0.05;  ///< of a logarithm, last steps of the search: of one number, of three
constexpr double no_gain = 1e-3;            ///< in -2 log likelihood
constexpr double least_scale = 1e-12;
constexpr double least_beyond_colour =
    0.02;  ///< one less the sum of the coefficients: how long the noise remembers at most

constexpr double widest = 2.5;             ///< robust deviations: what is further away counts as if it were there
constexpr double least_correlation = 0.1;  ///< of neighbouring readings: with less the noise is called white
constexpr std::size_t enough = 100;        ///< readings from which a colour can be told

/// Variance of numbers some of which are wild: their squares limited about the median's scale, as if normal.
double robust_variance(const std::vector<double>& values) {
    if (values.empty()) {
        return 1;
    }
    std::vector<double> sizes;
    sizes.reserve(values.size());
    for (const double value : values) {
        sizes.push_back(std::abs(value));
    }
    const double scale = std::max(core::sigma_of_median_distance * core::median(sizes), least_scale),
                 bound = widest * scale;
    double sum = 0;
    for (const double size : sizes) {
        sum += std::min(size * size, bound * bound);
    }
    // E min(x^2, c^2) of a standard normal number for c = 2.5
    constexpr double kept = 0.97765;
    return sum / static_cast<double>(sizes.size()) / kept;
}

using Steps = std::deque<WatchStep>;
using Plant = std::shared_ptr<const dynamics::HeavePlant>;

WatchResiduals::Likelihood run_over(const Plant& plant, const Steps& steps, const HeaveNoise& noise) {
    WatchResiduals::Likelihood likelihood;
    WatchResiduals residuals(plant, noise);
    residuals.learn_into(&likelihood);
    for (const WatchStep& step : steps) {
        residuals.take(step);
    }
    return likelihood;
}

/// -2 log likelihood with the scale of each sensor's noise at its best.
double cost_of(const WatchResiduals::Likelihood& likelihood) {
    double cost = 0;
    for (std::size_t s = 0; s < 2; ++s) {
        const auto count = static_cast<double>(likelihood.normals[s].size());
        cost +=
            likelihood.log_variances[s] + (count > 0 ? count * std::log(robust_variance(likelihood.normals[s])) : 0);
    }
    return std::isfinite(cost) ? cost : core::no_limit;
}

/// Steps along each number by turns, halved where none helps (Hooke and Jeeves 1961).
void descend(const std::function<double(const std::vector<double>&)>& cost, std::vector<double>& at, double& best,
             double step, double least) {
    while (step > least) {
        bool moved = false;
        for (std::size_t i = 0; i < at.size(); ++i) {
            for (const double change : {step, -step}) {
                std::vector<double> trial = at;
                trial[i] += change;
                const double c = cost(trial);
                if (c < best - no_gain) {
                    best = c;
                    at = trial;
                    moved = true;
                    break;
                }
            }
        }
        step *= moved ? 1 : 0.5;
    }
}

/// Autoregressive coefficients of these values (Levinson and Durbin); nothing where they are no better than none.
WatchColour colour_of(std::vector<double> values) {
    WatchColour colour;
    const double variance = robust_variance(values), bound = 3 * std::sqrt(variance);
    colour.scale = std::sqrt(variance);
    if (values.size() < enough) {
        return colour;
    }
    for (double& value : values) {
        value = std::clamp(value, -bound, bound);
    }
    std::array<double, WatchColour::order + 1> r{};
    for (std::size_t lag = 0; lag < r.size(); ++lag) {
        for (std::size_t i = lag; i < values.size(); ++i) {
            r[lag] += values[i] * values[i - lag];
        }
    }
    std::array<double, WatchColour::order> phi{};
    double error = r[0];
    for (std::size_t k = 0; k < phi.size() && error > 0; ++k) {
        double reflection = r[k + 1];
        for (std::size_t j = 0; j < k; ++j) {
            reflection -= phi[j] * r[k - j];
        }
        reflection /= error;
        const auto before = phi;
        phi[k] = reflection;
        for (std::size_t j = 0; j < k; ++j) {
            phi[j] = before[j] - reflection * before[k - 1 - j];
        }
        error *= 1 - reflection * reflection;
    }
    const auto count = static_cast<double>(values.size());
    if (error > 0 && count * std::log(r[0] / error) > static_cast<double>(phi.size()) * std::log(count)) {
        colour.phi = phi;
        colour.scale *= std::sqrt(error / r[0]);
    }
    return colour;
}

HeaveNoise noise_of(HeaveNoise noise, const std::vector<double>& logs) {
    noise.process = std::exp(std::clamp(logs[0], std::log(least_process), std::log(1.0)));
    if (logs.size() > 1) {
        noise.slow = std::exp(logs[1]);
        noise.slow_time = std::exp(std::clamp(logs[2], std::log(shortest_colour), std::log(longest_colour)));
    }
    return noise;
}

/// Process noise, size and time of a coloured noise, as logarithms: from several begins, for the likelihood has
/// valleys.
std::vector<double> coloured_noise(const std::function<double(const std::vector<double>&)>& cost, double white,
                                   double gap_noise, double& best) {
    std::vector<double> coloured;
    best = core::no_limit;
    for (const double q : {std::log(first_process), white}) {
        for (const double time : colour_times) {
            for (const double size : {1.0, 4.0}) {
                const std::vector<double> trial{q, std::log(size * gap_noise), std::log(time)};
                const double c = cost(trial);
                if (c < best) {
                    best = c;
                    coloured = trial;
                }
            }
        }
    }
    descend(cost, coloured, best, 1, fine);
    return coloured;
}

/// How long the gap's noise remembers, s; `usual`: time between readings.
double correlation_time(const WatchNoise& found, double usual) {
    double time = found.correlation_time;
    const double slow = found.noise.slow * found.noise.slow, all = slow + found.noise.gap * found.noise.gap;
    if (slow * std::exp(-usual / found.noise.slow_time) > least_correlation * all) {
        time = found.noise.slow_time;
    }
    if (!found.colours[0].white()) {
        double sum = 0;
        for (const double phi : found.colours[0].phi) {
            sum += phi;
        }
        time = std::max(time, usual / std::max(1 - sum, least_beyond_colour));
    }
    return time;
}

}  // namespace

double noise_cost(const Plant& plant, const Steps& steps, const HeaveNoise& noise) {
    return cost_of(run_over(plant, steps, noise));
}

WatchNoise learn_noise(const Plant& plant, const Steps& steps, const HeaveNoise& begin) {
    HeaveNoise plain = begin;
    plain.slow = 0;
    const auto cost = [&](const std::vector<double>& logs) {
        return cost_of(run_over(plant, steps, noise_of(plain, logs)));
    };
    std::vector<double> white{std::log(first_process)};
    double white_cost = cost(white);
    for (double q = grid_begin; q < grid_end; q *= 10) {
        const double c = cost({std::log(q)});
        if (c < white_cost) {
            white_cost = c;
            white = {std::log(q)};
        }
    }
    descend(cost, white, white_cost, 1, rough);
    double coloured_cost = 0;
    const std::vector<double> coloured = coloured_noise(cost, white[0], begin.gap, coloured_cost);
    const bool has_colour = coloured_cost < white_cost - 2 * std::log(static_cast<double>(steps.size()));
    WatchNoise out;
    out.noise = noise_of(plain, has_colour ? coloured : white);
    auto likelihood = run_over(plant, steps, out.noise);
    // the scale that the likelihood had at its best
    const double variance = robust_variance(likelihood.normals[0]), factor = std::sqrt(variance);
    out.noise.gap *= factor;
    out.noise.slow *= factor;
    out.noise.process *= variance;
    if (!likelihood.normals[1].empty()) {
        out.noise.velocity *= std::sqrt(robust_variance(likelihood.normals[1]));
    }
    likelihood = run_over(plant, steps, out.noise);
    out.cost = cost_of(likelihood);
    for (std::size_t s = 0; s < 2; ++s) {
        out.colours[s] = colour_of(likelihood.normals[s]);
    }
    out.correlation_time =
        correlation_time(out, (steps.back().time - steps.front().time) / static_cast<double>(steps.size() - 1));
    return out;
}

}  // namespace underbody::discovery
