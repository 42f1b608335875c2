// Learning the noise of a vehicle that is its model.
#include <algorithm>
#include <cmath>
#include <functional>

#include "surrogates/discovery/watch/watch_residuals.h"

namespace underbody::discovery {

namespace {

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
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const double scale = std::max(*middle / 0.6745, 1e-12), bound = widest * scale;
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
    return std::isfinite(cost) ? cost : 1e300;
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
                if (c < best - 1e-3) {
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
    noise.process = std::exp(std::clamp(logs[0], std::log(1e-14), std::log(1.0)));
    if (logs.size() > 1) {
        noise.slow = std::exp(logs[1]);
        noise.slow_time = std::exp(std::clamp(logs[2], std::log(0.02), std::log(20.0)));
    }
    return noise;
}

}  // namespace

WatchNoise learn_noise(const Plant& plant, const Steps& steps, const HeaveNoise& begin) {
    HeaveNoise plain = begin;
    plain.slow = 0;
    const auto cost = [&](const std::vector<double>& logs) {
        return cost_of(run_over(plant, steps, noise_of(plain, logs)));
    };
    std::vector<double> white{std::log(1e-11)};
    double white_cost = cost(white);
    for (double q = 1e-10; q < 2e-2; q *= 10) {
        const double c = cost({std::log(q)});
        if (c < white_cost) {
            white_cost = c;
            white = {std::log(q)};
        }
    }
    descend(cost, white, white_cost, 1, 0.2);
    // coloured: from several begins, for the likelihood has valleys
    std::vector<double> coloured;
    double coloured_cost = 1e300;
    for (const double q : {std::log(1e-11), white[0]}) {
        for (const double time : {0.1, 0.4, 1.6}) {
            for (const double size : {1.0, 4.0}) {
                const std::vector<double> trial{q, std::log(size * begin.gap), std::log(time)};
                const double c = cost(trial);
                if (c < coloured_cost) {
                    coloured_cost = c;
                    coloured = trial;
                }
            }
        }
    }
    descend(cost, coloured, coloured_cost, 1, 0.05);
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
    for (std::size_t s = 0; s < 2; ++s) {
        out.colours[s] = colour_of(likelihood.normals[s]);
    }
    const double usual = (steps.back().time - steps.front().time) / static_cast<double>(steps.size() - 1);
    const double slow = out.noise.slow * out.noise.slow, all = slow + out.noise.gap * out.noise.gap;
    if (slow * std::exp(-usual / out.noise.slow_time) > least_correlation * all) {
        out.correlation_time = out.noise.slow_time;
    }
    if (!out.colours[0].white()) {
        double sum = 0;
        for (const double phi : out.colours[0].phi) {
            sum += phi;
        }
        out.correlation_time = std::max(out.correlation_time, usual / std::max(1 - sum, 0.02));
    }
    return out;
}

}  // namespace underbody::discovery
