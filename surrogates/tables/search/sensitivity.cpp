#include "surrogates/tables/search/sensitivity.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::tables {

namespace {

/// Values at the plan's first half, its second half, and the first half with one coordinate from the second.
struct SaltelliValues {
    std::vector<double> a, b;
    std::vector<std::vector<double>> mixed;  ///< [axis][point]
};

struct Estimate {
    double mean = 0, variance = 0;
    std::vector<double> first, total;
};

Estimate estimate(const SaltelliValues& values, std::span<const std::size_t> chosen) {
    Estimate result;
    const auto n = static_cast<double>(chosen.size());
    for (const std::size_t i : chosen) {
        result.mean += (values.a[i] + values.b[i]) / (2 * n);
    }
    for (const std::size_t i : chosen) {
        result.variance += (std::pow(values.a[i] - result.mean, 2) + std::pow(values.b[i] - result.mean, 2)) / (2 * n);
    }
    for (const std::vector<double>& mixed : values.mixed) {
        double first = 0, total = 0;
        for (const std::size_t i : chosen) {
            first += (values.b[i] - result.mean) * (mixed[i] - values.a[i]) / n;
            total += std::pow(values.a[i] - mixed[i], 2) / (2 * n);
        }
        result.first.push_back(result.variance > 0 ? first / result.variance : 0);
        result.total.push_back(result.variance > 0 ? total / result.variance : 0);
    }
    return result;
}

SobolIndex with_interval(double value, std::vector<double> again) {
    std::sort(again.begin(), again.end());
    const auto at = [&](double share) {
        return again[static_cast<std::size_t>(share * static_cast<double>(again.size() - 1))];
    };
    return {value, at(0.025), at(0.975)};
}

}  // namespace

SobolIndices sobol_indices(const std::function<double(std::span<const double>)>& f, std::size_t axes,
                           std::size_t points, std::uint64_t seed) {
    const Plan plan = sobol_plan(points, 2 * axes, seed);
    SaltelliValues values;
    values.mixed.resize(axes);
    for (const std::vector<double>& point : plan) {
        std::vector<double> a(point.begin(), point.begin() + static_cast<std::ptrdiff_t>(axes));
        const std::vector<double> b(point.begin() + static_cast<std::ptrdiff_t>(axes), point.end());
        values.a.push_back(f(a));
        values.b.push_back(f(b));
        for (std::size_t v = 0; v < axes; ++v) {
            const double own = a[v];
            a[v] = b[v];
            values.mixed[v].push_back(f(a));
            a[v] = own;
        }
    }
    std::vector<std::size_t> chosen(points);
    for (std::size_t i = 0; i < points; ++i) {
        chosen[i] = i;
    }
    const Estimate whole = estimate(values, chosen);
    constexpr int draws = 200;
    std::vector<std::vector<double>> first(axes), total(axes);
    core::Random random(seed, 1);
    for (int d = 0; d < draws; ++d) {
        for (std::size_t& i : chosen) {
            i = random.below(points);
        }
        const Estimate one = estimate(values, chosen);
        for (std::size_t v = 0; v < axes; ++v) {
            first[v].push_back(one.first[v]);
            total[v].push_back(one.total[v]);
        }
    }
    SobolIndices result{whole.mean, whole.variance, {}, {}};
    for (std::size_t v = 0; v < axes; ++v) {
        result.first.push_back(with_interval(whole.first[v], std::move(first[v])));
        result.total.push_back(with_interval(whole.total[v], std::move(total[v])));
    }
    return result;
}

}  // namespace underbody::tables
