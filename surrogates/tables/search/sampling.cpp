#include "surrogates/tables/search/sampling.h"

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/random.h"

namespace underbody::tables {

Plan sobol_plan(std::size_t count, std::size_t axes, std::uint64_t seed, std::size_t first) {
    boost::random::sobol_engine<std::uint32_t, 32> engine(axes);
    engine.discard(static_cast<std::uintmax_t>(first * axes));
    core::Random random(seed);
    std::vector<std::uint32_t> shift;
    for (std::size_t a = 0; a < axes; ++a) {
        shift.push_back(static_cast<std::uint32_t>(random.bits() >> 32));
    }
    Plan plan(count, std::vector<double>(axes));
    for (std::vector<double>& point : plan) {
        for (std::size_t a = 0; a < axes; ++a) {
            point[a] = (static_cast<double>(engine() ^ shift[a]) + 0.5) * 0x1p-32;
        }
    }
    return plan;
}

double smallest_distance(const Plan& plan) {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < plan.size(); ++i) {
        for (std::size_t j = i + 1; j < plan.size(); ++j) {
            double square = 0;
            for (std::size_t a = 0; a < plan[i].size(); ++a) {
                square += std::pow(plan[i][a] - plan[j][a], 2);
            }
            smallest = std::min(smallest, square);
        }
    }
    return std::sqrt(smallest);
}

Plan latin_hypercube(std::size_t count, std::size_t axes, std::uint64_t seed) {
    constexpr int tries = 50;
    Plan best;
    double farthest = -1;
    for (int t = 0; t < tries; ++t) {
        core::Random random(seed, static_cast<std::uint64_t>(t));
        Plan plan(count, std::vector<double>(axes));
        for (std::size_t a = 0; a < axes; ++a) {
            std::vector<std::size_t> order(count);
            std::iota(order.begin(), order.end(), std::size_t{0});
            for (std::size_t i = count; i > 1; --i) {
                std::swap(order[i - 1], order[random.below(i)]);
            }
            for (std::size_t i = 0; i < count; ++i) {
                plan[i][a] = (static_cast<double>(order[i]) + random.uniform()) / static_cast<double>(count);
            }
        }
        if (const double distance = smallest_distance(plan); distance > farthest) {
            farthest = distance;
            best = std::move(plan);
        }
    }
    return best;
}

}  // namespace underbody::tables
