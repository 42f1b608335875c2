#include "surrogates/tables/search/multi_fidelity.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>

#include "core/no_limit.h"

namespace underbody::tables {

namespace {

// Standard deviations, in units of the quantity's spread, that the trend's coefficients have before any data: the
// lowest level's mean and slope over a variable's range; the offset between two levels; rho - 1.
constexpr double trend_spread = 3;
constexpr double offset_spread = 1;
constexpr double factor_spread = 0.5;

}  // namespace

std::vector<double> MultiFidelity::trend(std::span<const double> x, std::size_t level,
                                         std::vector<double>* slope) const {
    std::vector<double> h;
    if (level == 0) {
        h.push_back(trend_spread);
        for (const double c : x) {
            h.push_back(trend_spread * (c - 0.5));
        }
        if (slope != nullptr) {
            slope->assign(h.size() * axes_, 0.0);
            for (std::size_t a = 0; a < axes_; ++a) {
                (*slope)[(a + 1) * axes_ + a] = trend_spread;
            }
        }
        return h;
    }
    const GpPrediction below = at(x, level - 1, slope != nullptr);
    h = {offset_spread, factor_spread * below.mean};
    if (slope != nullptr) {
        slope->assign(2 * axes_, 0.0);
        for (std::size_t a = 0; a < axes_; ++a) {
            (*slope)[axes_ + a] = factor_spread * below.mean_slope[a];
        }
    }
    return h;
}

GpData MultiFidelity::data_of(std::size_t level) const {
    const FidelityRuns& runs = runs_[level];
    GpData data;
    data.axes = axes_;
    data.x = runs.x;
    data.y = runs.y;
    data.noise = runs.noise;
    data.noise.resize(runs.count(), 0.0);
    data.trend_variance = 1;
    data.trends = level == 0 ? axes_ + 1 : 2;
    for (std::size_t i = 0; i < runs.count(); ++i) {
        const std::span<const double> x(&runs.x[i * axes_], axes_);
        const std::vector<double> h = trend(x, level, nullptr);
        data.trend.insert(data.trend.end(), h.begin(), h.end());
        if (level > 0) {
            const GpPrediction below = at(x, level - 1);
            data.y[i] -= below.mean;
            data.noise[i] += below.variance;  // nothing where the level below was run at the same place
        }
    }
    return data;
}

void MultiFidelity::add_level(GpParameters parameters) {
    processes_.emplace_back(data_of(processes_.size()), Kernel::matern52, std::move(parameters));
}

MultiFidelity::MultiFidelity(std::vector<FidelityRuns> levels, std::size_t axes, std::vector<GpParameters> parameters)
    : runs_(std::move(levels)), axes_(axes) {
    runs_.resize(parameters.size());
    for (GpParameters& p : parameters) {
        add_level(std::move(p));
    }
}

MultiFidelity MultiFidelity::fit(std::vector<FidelityRuns> levels, std::size_t axes, core::Progress& progress) {
    while (!levels.empty() && levels.back().count() == 0) {
        levels.pop_back();
    }
    if (levels.empty() || levels.front().count() == 0) {
        throw std::invalid_argument("the lowest fidelity has no runs");
    }
    for (const FidelityRuns& runs : levels) {
        if (runs.x.size() != axes * runs.count() || (!runs.group.empty() && runs.group.size() != runs.count()) ||
            (!runs.noise.empty() && runs.noise.size() != runs.count())) {
            throw std::invalid_argument("runs of one fidelity differ in number");
        }
    }
    MultiFidelity result({}, axes, {});
    result.runs_ = std::move(levels);
    for (std::size_t t = 0; t < result.runs_.size(); ++t) {
        GpOptions options;
        options.expected_scatter = 0.01;
        for (const double length : {0.4, 1.2}) {
            GpParameters start;
            start.length.assign(axes, length);
            start.scale = t == 0 ? 1 : 0.3;
            start.scatter = options.expected_scatter;
            options.starts.push_back(start);
        }
        result.add_level(GaussianProcess::fit(result.data_of(t), options, progress).parameters());
    }
    return result;
}

double MultiFidelity::factor(std::size_t level) const {
    return level == 0 ? 1 : 1 + factor_spread * processes_[level].coefficients()[1];
}

GpPrediction MultiFidelity::at(std::span<const double> x, std::size_t level, bool slopes) const {
    GpPrediction below;
    std::vector<double> h, slope;
    if (level == 0) {
        h = trend(x, 0, slopes ? &slope : nullptr);
    } else {
        below = at(x, level - 1, slopes);
        h = {offset_spread, factor_spread * below.mean};
        if (slopes) {
            slope.assign(2 * axes_, 0.0);
            std::transform(below.mean_slope.begin(), below.mean_slope.end(),
                           slope.begin() + static_cast<std::ptrdiff_t>(axes_),
                           [](double s) { return factor_spread * s; });
        }
    }
    GpPrediction own = processes_[level].predict(x, h, slope);
    if (level > 0) {
        const double rho = factor(level);
        own.mean += below.mean;
        own.variance += rho * rho * below.variance;
        for (std::size_t a = 0; a < own.mean_slope.size(); ++a) {
            own.mean_slope[a] += below.mean_slope[a];
            own.variance_slope[a] += rho * rho * below.variance_slope[a];
        }
    }
    return own;
}

GpMeans MultiFidelity::means(std::span<const double> x, std::size_t level, bool slopes) const {
    const std::size_t points = x.size() / axes_;
    std::vector<double> h, dh;
    GpMeans below;
    if (level > 0) {
        below = means(x, level - 1, slopes);
    }
    for (std::size_t i = 0; i < points; ++i) {
        if (level > 0) {
            h.insert(h.end(), {offset_spread, factor_spread * below.mean[i]});
            dh.resize(slopes ? 2 * (i + 1) * axes_ : 0, 0.0);
            for (std::size_t a = 0; slopes && a < axes_; ++a) {
                dh[(2 * i + 1) * axes_ + a] = factor_spread * below.slope[i * axes_ + a];
            }
            continue;
        }
        std::vector<double> slope;
        const std::vector<double> one = trend(x.subspan(i * axes_, axes_), 0, slopes ? &slope : nullptr);
        h.insert(h.end(), one.begin(), one.end());
        dh.insert(dh.end(), slope.begin(), slope.end());
    }
    GpMeans own = processes_[level].means(x, h, dh);
    if (level > 0) {
        std::transform(own.mean.begin(), own.mean.end(), below.mean.begin(), own.mean.begin(), std::plus<>());
        std::transform(own.slope.begin(), own.slope.end(), below.slope.begin(), own.slope.begin(), std::plus<>());
    }
    return own;
}

std::vector<double> MultiFidelity::covariance(std::span<const double> x, std::size_t level) const {
    std::vector<double> h;
    for (std::size_t i = 0; i < x.size(); i += axes_) {
        const std::vector<double> one = trend(x.subspan(i, axes_), level, nullptr);
        h.insert(h.end(), one.begin(), one.end());
    }
    std::vector<double> result = processes_[level].covariance(x, h);
    if (level > 0) {
        const std::vector<double> below = covariance(x, level - 1);
        const double rho = factor(level);
        for (std::size_t i = 0; i < result.size(); ++i) {
            result[i] += rho * rho * below[i];
        }
    }
    return result;
}

double MultiFidelity::variance_after(std::span<const double> target, std::span<const double> x,
                                     std::size_t level) const {
    // A run on `level` tells of that level's value; what it tells of the highest goes through the factors between.
    std::vector<double> both(target.begin(), target.end());
    both.insert(both.end(), x.begin(), x.end());
    const std::vector<double> c = covariance(both, level);
    double through = 1;
    for (std::size_t t = level + 1; t < levels(); ++t) {
        through *= factor(t);
    }
    const double scatter = processes_[level].parameters().scatter;
    const double gain = through * through * c[1] * c[1] / core::never_zero(c[3] + scatter * scatter);
    return std::max(0.0, at(target).variance - gain);
}

MultiFidelity MultiFidelity::without(std::size_t group) const {
    std::vector<FidelityRuns> left(runs_.size());
    std::vector<GpParameters> parameters;
    for (std::size_t t = 0; t < runs_.size(); ++t) {
        const FidelityRuns& all = runs_[t];
        for (std::size_t i = 0; i < all.count(); ++i) {
            const std::size_t own = all.group.empty() ? i : all.group[i];
            if (own == group) {
                continue;
            }
            left[t].x.insert(left[t].x.end(), &all.x[i * axes_], &all.x[i * axes_] + axes_);
            left[t].y.push_back(all.y[i]);
            left[t].noise.push_back(all.noise.empty() ? 0 : all.noise[i]);
            left[t].group.push_back(own);
        }
        parameters.push_back(processes_[t].parameters());
    }
    return {std::move(left), axes_, std::move(parameters)};
}

MultiFidelity MultiFidelity::with(std::span<const double> x, double y, double noise, std::size_t level) const {
    std::vector<FidelityRuns> more = runs_;
    std::vector<GpParameters> parameters;
    FidelityRuns& runs = more.at(level);
    runs.noise.resize(runs.count(), 0.0);
    runs.x.insert(runs.x.end(), x.begin(), x.end());
    runs.y.push_back(y);
    runs.noise.push_back(noise);
    if (!runs.group.empty()) {
        runs.group.push_back(static_cast<std::size_t>(-1));
    }
    for (const GaussianProcess& process : processes_) {
        parameters.push_back(process.parameters());
    }
    return {std::move(more), axes_, std::move(parameters)};
}

}  // namespace underbody::tables
