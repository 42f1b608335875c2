#include "surrogates/tables/search/surrogate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/normal.h"

namespace underbody::tables {

double SearchVariable::scaled(double value) const {
    return logarithmic ? std::log(value / lower) / std::log(upper / lower) : (value - lower) / (upper - lower);
}

double SearchVariable::unscaled(double share) const {
    return logarithmic ? lower * std::pow(upper / lower, share) : lower + share * (upper - lower);
}

double SearchVariable::scaled_slope(double value) const {
    return 1 / (logarithmic ? value * std::log(upper / lower) : upper - lower);
}

namespace {

/// The factor of the stated errors starts as if there had been this many shapes left out whose errors were as stated: a
/// handful of shapes says little.
constexpr double shapes_of_prior = 4;

void check_runs(const std::string& quantity, const std::vector<SearchVariable>& variables,
                const std::vector<SearchRun>& runs) {
    const auto refuse = [&](const std::string& what, const std::string& hint) {
        throw core::InputError("surrogate", "a surrogate of " + quantity + ": " + what, {}, hint);
    };
    if (variables.empty() || variables.size() > Surrogate::most_variables) {
        refuse(std::to_string(variables.size()) + " variables",
               "between one and " + std::to_string(Surrogate::most_variables) + " can be learned");
    }
    if (runs.size() < 3) {
        refuse("only " + std::to_string(runs.size()) + " runs", "at least three are needed, and about ten a variable");
    }
    for (const SearchRun& run : runs) {
        if (run.at.size() != variables.size() || !std::isfinite(run.value) || !(run.sigma >= 0) ||
            !std::isfinite(run.sigma)) {
            refuse("a run without a finite value and error", "leave out runs that failed");
        }
    }
    for (std::size_t v = 0; v < variables.size(); ++v) {
        const auto [low, high] = std::minmax_element(
            runs.begin(), runs.end(), [v](const SearchRun& a, const SearchRun& b) { return a.at[v] < b.at[v]; });
        if (!(low->at[v] < high->at[v])) {
            refuse(variables[v].name + " has the same value in all runs", "take it out of the variables");
        }
        if (variables[v].logarithmic && !(low->at[v] > 0)) {
            refuse(variables[v].name + " is logarithmic and has a value of zero or below", "use a linear range");
        }
    }
}

/// Number of the shape of each run: equal where all numbers of the shape are.
std::vector<std::size_t> shapes_of(const std::vector<SearchVariable>& variables, const std::vector<SearchRun>& runs) {
    std::map<std::vector<long long>, std::size_t> known;
    std::vector<std::size_t> result;
    for (const SearchRun& run : runs) {
        std::vector<long long> key;
        for (std::size_t v = 0; v < variables.size(); ++v) {
            if (variables[v].of_shape) {
                key.push_back(std::llround(1e9 * variables[v].scaled(run.at[v])));
            }
        }
        result.push_back(known.try_emplace(key, known.size()).first->second);
    }
    return result;
}

}  // namespace

std::vector<double> Surrogate::scaled(std::span<const double> x) const {
    std::vector<double> result;
    for (std::size_t v = 0; v < variables_.size(); ++v) {
        result.push_back(variables_[v].scaled(x[v]));
    }
    return result;
}

Surrogate Surrogate::fit(std::string quantity, std::string unit, std::vector<SearchVariable> variables,
                         const std::vector<SearchRun>& runs, core::Progress& progress) {
    check_runs(quantity, variables, runs);
    double mean = 0, square = 0;
    for (const SearchRun& run : runs) {
        mean += run.value / static_cast<double>(runs.size());
    }
    for (const SearchRun& run : runs) {
        square += (run.value - mean) * (run.value - mean) / static_cast<double>(runs.size());
    }
    const double spread = square > 0 ? std::sqrt(square) : 1;

    std::vector<std::size_t> shapes = shapes_of(variables, runs);
    if (*std::max_element(shapes.begin(), shapes.end()) == 0) {
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            shapes[i] = i;  // conditions alone: each run is left out by itself
        }
    }
    // Levels that nobody ran are no levels.
    std::map<std::size_t, std::size_t> level_of;
    for (const SearchRun& run : runs) {
        level_of.try_emplace(run.level, 0);
    }
    std::size_t next = 0;
    for (auto& [given, own] : level_of) {
        own = next++;
    }
    std::vector<FidelityRuns> levels(level_of.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
        FidelityRuns& level = levels[level_of[runs[i].level]];
        for (std::size_t v = 0; v < variables.size(); ++v) {
            level.x.push_back(variables[v].scaled(runs[i].at[v]));
        }
        level.y.push_back((runs[i].value - mean) / spread);
        level.noise.push_back(std::pow(runs[i].sigma / spread, 2));
        level.group.push_back(shapes[i]);
    }
    Surrogate result(MultiFidelity::fit(std::move(levels), variables.size(), progress));
    result.quantity_ = std::move(quantity);
    result.unit_ = std::move(unit);
    result.variables_ = std::move(variables);
    for (const auto& [given, own] : level_of) {
        result.fidelities_.push_back(given);
    }
    result.middle_ = mean;
    result.spread_ = spread;
    result.check_left_out(progress);
    return result;
}

namespace {

struct LevelRun {
    std::size_t level = 0, run = 0;
};

/// Of each shape its runs of the best fidelity that it has.
std::map<std::size_t, std::vector<LevelRun>> best_runs(const std::vector<FidelityRuns>& levels) {
    std::map<std::size_t, std::vector<LevelRun>> of_shape;
    for (std::size_t level = levels.size(); level-- > 0;) {
        for (std::size_t i = 0; i < levels[level].count(); ++i) {
            auto& runs = of_shape[levels[level].group[i]];
            if (runs.empty() || runs.front().level == level) {
                runs.push_back({level, i});
            }
        }
    }
    return of_shape;
}

/// The runs of a shape on the best of its fidelities, `best` at most, that others were run on as well.
std::vector<LevelRun> predicted_runs(const std::vector<FidelityRuns>& levels, const std::vector<FidelityRuns>& others,
                                     std::size_t shape, std::size_t best) {
    std::vector<LevelRun> runs;
    for (std::size_t level = best + 1; level-- > 0 && runs.empty();) {
        const bool known = level < others.size() && others[level].count() > 0;
        for (std::size_t i = 0; known && i < levels[level].count(); ++i) {
            if (levels[level].group[i] == shape) {
                runs.push_back({level, i});
            }
        }
    }
    return runs;
}

/// What the nearest run of another shape says: of the same fidelity, else of any; nothing where there is none.
std::optional<double> nearest_value(const std::vector<FidelityRuns>& levels, const LevelRun& of, std::size_t axes) {
    const std::size_t shape = levels[of.level].group[of.run];
    const double* x = &levels[of.level].x[of.run * axes];
    const auto among = [&](const FidelityRuns& runs, double& best, std::optional<double>& value) {
        for (std::size_t j = 0; j < runs.count(); ++j) {
            double distance = 0;
            for (std::size_t a = 0; a < axes; ++a) {
                distance += std::pow(runs.x[j * axes + a] - x[a], 2);
            }
            if (runs.group[j] != shape && distance < best) {
                best = distance;
                value = runs.y[j];
            }
        }
    };
    double best = std::numeric_limits<double>::infinity();
    std::optional<double> value;
    among(levels[of.level], best, value);
    for (std::size_t level = 0; !value && level < levels.size(); ++level) {
        among(levels[level], best, value);
    }
    return value;
}

}  // namespace

void Surrogate::check_left_out(core::Progress& progress) {
    const std::size_t axes = variables_.size();
    const std::vector<FidelityRuns>& levels = process_.runs();
    const auto of_shape = best_runs(levels);
    std::vector<double> squares;  // of standardised errors, the mean of each shape
    double own = 0, nearest = 0;
    std::vector<double> error, sigma;
    for (const auto& [shape, best] : of_shape) {
        progress.check();
        const MultiFidelity others = process_.without(shape);
        const std::vector<LevelRun> points = predicted_runs(levels, others.runs(), shape, best.front().level);
        if (points.empty()) {
            continue;  // no other shape was run on its fidelities: nothing predicts it
        }
        double square = 0;
        check_.shapes_of_best += best.front().level + 1 == levels.size() ? 1 : 0;
        for (const LevelRun& point : points) {
            const FidelityRuns& runs = levels[point.level];
            const std::size_t i = point.run;
            const double scatter = process_.parameters(point.level).scatter;
            const GpPrediction p = others.at({&runs.x[i * axes], axes}, std::min(point.level, others.levels() - 1));
            const double miss = runs.y[i] - p.mean;
            const double variance = p.variance + runs.noise[i] + scatter * scatter;
            error.push_back(miss);
            sigma.push_back(std::sqrt(variance));
            square += miss * miss / variance / static_cast<double>(points.size());
            own += miss * miss;
            const auto other = nearest_value(levels, point, axes);
            // no other shape: no such error
            nearest += other ? std::pow(runs.y[i] - *other, 2) : std::numeric_limits<double>::infinity();
            check_.measured.push_back(middle_ + spread_ * runs.y[i]);
            check_.predicted.push_back(middle_ + spread_ * p.mean);
        }
        squares.push_back(square);
    }
    double sum = shapes_of_prior;
    for (const double s : squares) {
        sum += s;
    }
    error_factor_ = std::sqrt(sum / (shapes_of_prior + static_cast<double>(squares.size())));
    check_.shapes = squares.size();
    check_.points = error.size();
    std::size_t inside = 0;
    for (std::size_t i = 0; i < error.size(); ++i) {
        inside += std::abs(error[i]) <= core::sigmas_of_95 * error_factor_ * sigma[i] ? 1 : 0;
        check_.sigma.push_back(error_factor_ * spread_ * sigma[i]);
    }
    const auto count = static_cast<double>(error.size());
    check_.inside_95 = static_cast<double>(inside) / count;
    const auto shapes = static_cast<double>(check_.shapes);
    const core::Interval sure = core::wilson_interval(check_.inside_95 * shapes, shapes);
    check_.inside_lower = sure.low;
    check_.inside_upper = sure.high;
    check_.root_mean_square = spread_ * std::sqrt(own / count);
    check_.nearest_shape = spread_ * std::sqrt(nearest / count);
}

SurrogatePrediction Surrogate::at(std::span<const double> x, bool slopes) const {
    const GpPrediction p = process_.at(scaled(x), slopes);
    SurrogatePrediction result;
    const double sigma = std::sqrt(p.variance);
    result.value = middle_ + spread_ * p.mean;
    result.sigma = error_factor_ * spread_ * sigma;
    for (std::size_t v = 0; v < p.mean_slope.size(); ++v) {
        const double rate = spread_ * variables_[v].scaled_slope(x[v]);
        result.slope.push_back(rate * p.mean_slope[v]);
        result.sigma_slope.push_back(sigma > 0 ? rate * error_factor_ * 0.5 * p.variance_slope[v] / sigma : 0);
    }
    return result;
}

SurrogatePrediction Surrogate::sum(std::span<const double> weights,
                                   const std::vector<std::vector<double>>& points) const {
    const SurrogateCurve curve = along(points, With::covariance);
    SurrogatePrediction result;
    double variance = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        result.value += weights[i] * curve.value[i];
        for (std::size_t j = 0; j < points.size(); ++j) {
            variance += weights[i] * weights[j] * curve.covariance[i * points.size() + j];
        }
    }
    result.sigma = std::sqrt(std::max(0.0, variance));
    return result;
}

SurrogateCurve Surrogate::along(const std::vector<std::vector<double>>& points, With with) const {
    std::vector<double> x;
    for (const std::vector<double>& point : points) {
        const std::vector<double> one = scaled(point);
        x.insert(x.end(), one.begin(), one.end());
    }
    const std::size_t axes = variables_.size();
    GpMeans means = process_.means(x, process_.levels() - 1, with == With::slopes);
    SurrogateCurve curve{std::move(means.mean), std::move(means.slope), {}};
    for (double& value : curve.value) {
        value = middle_ + spread_ * value;
    }
    for (std::size_t i = 0; i < curve.slope.size(); ++i) {
        curve.slope[i] *= spread_ * variables_[i % axes].scaled_slope(points[i / axes][i % axes]);
    }
    if (with == With::covariance) {
        curve.covariance = process_.covariance(x, process_.levels() - 1);
        for (double& c : curve.covariance) {
            c *= std::pow(error_factor_ * spread_, 2);
        }
    }
    return curve;
}

double Surrogate::sigma_after(std::span<const double> target, std::span<const double> x, std::size_t fidelity) const {
    return error_factor_ * spread_ * std::sqrt(process_.variance_after(scaled(target), scaled(x), level_of(fidelity)));
}

std::size_t Surrogate::level_of(std::size_t fidelity) const {
    const auto at = std::lower_bound(fidelities_.begin(), fidelities_.end(), fidelity);
    return std::min(static_cast<std::size_t>(at - fidelities_.begin()), fidelities_.size() - 1);
}

Surrogate Surrogate::with(const SearchRun& run) const {
    const std::vector<double> x = scaled(run.at);
    const std::size_t level = level_of(run.level);
    const double y = std::isfinite(run.value) ? (run.value - middle_) / spread_ : process_.at(x, level).mean;
    Surrogate result = *this;
    result.process_ = process_.with(x, y, std::pow(run.sigma / spread_, 2), level);
    return result;
}

void to_json(nlohmann::json& json, const Surrogate& surrogate) {
    json = {{"quantity", surrogate.quantity()},        {"unit", surrogate.unit()},
            {"variables", nlohmann::json::array()},    {"fidelities", surrogate.fidelities()},
            {"runs", nlohmann::json::array()},         {"factors", nlohmann::json::array()},
            {"error_factor", surrogate.error_factor()}};
    for (const SearchVariable& v : surrogate.variables()) {
        json["variables"].push_back({{"name", v.name},
                                     {"unit", v.unit},
                                     {"lower", v.lower},
                                     {"upper", v.upper},
                                     {"logarithmic", v.logarithmic}});
    }
    const MultiFidelity& process = surrogate.process();
    for (std::size_t t = 0; t < process.levels(); ++t) {
        json["runs"].push_back(process.runs()[t].count());
        json["factors"].push_back(process.factor(t));
    }
    json["lengths"] = process.parameters(process.levels() - 1).length;
    const LeftOutCheck& check = surrogate.check();
    json["left_out"] = {
        {"shapes", check.shapes},
        {"shapes_of_best", check.shapes_of_best},
        {"points", check.points},
        {"inside_95", check.inside_95},
        {"inside_95_interval", {check.inside_lower, check.inside_upper}},
        {"root_mean_square", check.root_mean_square},
        {"nearest_shape", std::isfinite(check.nearest_shape) ? nlohmann::json(check.nearest_shape) : nlohmann::json()}};
}

}  // namespace underbody::tables
