#include "surrogates/discovery/noise_chance.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/random.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

double chance_among(const std::vector<const DesignMatrix*>& probes, const std::vector<double>& noise_like,
                    double observed, std::size_t block, std::uint64_t seed, core::Progress& progress) {
    constexpr std::size_t draws = 199, shortest_block = 8;
    const double size = root_mean_square(noise_like);
    const std::size_t n = noise_like.size();
    block = std::max(shortest_block, block);
    std::vector<double> largest(draws, 0);
    core::parallel_for(
        draws,
        [&](std::size_t d) {
            core::Random random(seed, d + 1);
            std::vector<double> drawn(n);
            for (std::size_t begin = 0; begin < n; begin += block) {
                const std::size_t from = random.below(n);
                const double sign = random.uniform() < 0.5 ? -1 : 1;
                for (std::size_t k = 0; k < block && begin + k < n; ++k) {
                    drawn[begin + k] = sign * noise_like[(from + k) % n] / size;
                }
            }
            for (const DesignMatrix* probe : probes) {
                if (probe->columns > 0) {
                    largest[d] = std::max(
                        largest[d], surprise(explained_square(*probe, drawn), static_cast<double>(probe->columns)));
                }
            }
        },
        progress);
    const std::size_t as_large = static_cast<std::size_t>(
        std::count_if(largest.begin(), largest.end(), [&](double x) { return x >= observed; }));
    const double top = *std::max_element(largest.begin(), largest.end());
    // beyond every draw: the statistic is a negative decimal logarithm of a chance; its tail is given half its nominal
    // steepness
    const double beyond = as_large == 0 ? std::clamp(0.5 * (observed - top), 0.0, 12.0) : 0;
    return static_cast<double>(as_large + 1) / (draws + 1) * std::pow(10.0, -beyond);
}

}  // namespace underbody::discovery
