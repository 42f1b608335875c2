#include "surrogates/tables/search/design_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <utility>

#include "core/error.h"
#include "core/no_limit.h"
#include "surrogates/tables/search/acquisition.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::tables {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double apart = 0.01;  // share of the ranges within which two runs say the same

/// Which design of a batch is looked for.
void say_design(core::Progress& progress, std::size_t done, std::size_t count) {
    progress.report(static_cast<double>(done) / static_cast<double>(count),
                    "design " + std::to_string(done + 1) + " of " + std::to_string(count));
}

/// How often a run near `x` gave a result: runs count by their distance, and two that did stand for what is known
/// before any.
double chance_solved(const std::vector<SearchVariable>& variables, std::span<const double> x,
                     const DesignSearch::NextOptions& options) {
    constexpr double reach = 0.15, before = 2;
    const auto weight = [&](const std::vector<double>& other) {
        double square = 0;
        for (std::size_t v = 0; v < variables.size(); ++v) {
            square += std::pow((variables[v].scaled(x[v]) - variables[v].scaled(other[v])) / reach, 2);
        }
        return std::exp(-0.5 * square);
    };
    double good = before, bad = 0;
    for (const std::vector<double>& design : options.solved) {
        good += weight(design);
    }
    for (const std::vector<double>& design : options.failed) {
        bad += 4 * weight(design);  // a failure tells more than a success of what lies around it
    }
    return good / (good + bad);
}

/// Designs that a further one must not repeat.
class Taken {
public:
    Taken(const std::vector<SearchVariable>& variables, const DesignSearch::NextOptions& options)
        : variables_(variables) {
        for (const auto& [at, fidelity] : options.planned) {
            add(at);
        }
    }
    void add(const std::vector<double>& at) { designs_.push_back(at); }
    [[nodiscard]] bool holds(std::span<const double> x) const {
        return std::any_of(designs_.begin(), designs_.end(), [&](const std::vector<double>& other) {
            for (std::size_t v = 0; v < variables_.size(); ++v) {
                if (std::abs(variables_[v].scaled(x[v]) - variables_[v].scaled(other[v])) > apart) {
                    return false;
                }
            }
            return true;
        });
    }

private:
    const std::vector<SearchVariable>& variables_;
    std::vector<std::vector<double>> designs_;
};

}  // namespace

void TrustRegion::step(bool improved, std::size_t variables) {
    successes = improved ? successes + 1 : 0;
    failures = improved ? 0 : failures + 1;
    if (successes == 3) {
        length = std::min(1.6, 2 * length);
        successes = 0;
    } else if (failures >= static_cast<int>(std::max<std::size_t>(4, variables))) {
        length /= 2;
        failures = 0;
    }
}

DesignSearch::DesignSearch(SearchProblem problem, std::map<std::string, Surrogate> surrogates)
    : problem_(std::move(problem)), surrogates_(std::move(surrogates)) {
    if (problem_.objectives.empty()) {
        throw core::InputError("objective", "the search has no objective", {},
                               "state what is to be made small or large");
    }
    for (const Objective& objective : problem_.objectives) {
        (void)bind(objective.response);
    }
    for (const Limit& limit : problem_.limits) {
        (void)bind(limit.response);
    }
}

bool DesignSearch::has_curves() const {
    const auto is_curve = [](const auto& one) { return one.response.curve.has_value(); };
    return std::any_of(problem_.objectives.begin(), problem_.objectives.end(), is_curve) ||
           std::any_of(problem_.limits.begin(), problem_.limits.end(), is_curve);
}

/// How many places of a plan the next designs are looked for in first: a curve with its error costs hundreds of points.
std::size_t DesignSearch::starts(std::size_t an_axis, std::size_t most) const {
    return std::min(most, an_axis * problem_.variables.size()) / (has_curves() ? 8 : 1);
}

double DesignSearch::cost_of(const Objective& objective, double value) const {
    switch (objective.sense) {
        case Objective::Sense::minimise:
            return value;
        case Objective::Sense::maximise:
            return -value;
        case Objective::Sense::target:
            return std::abs(value - objective.target);
    }
    return value;
}

bool DesignSearch::known_limits_hold(std::span<const double> x) const {
    return std::all_of(problem_.known_limits.begin(), problem_.known_limits.end(),
                       [&](const auto& limit) { return limit(x) <= 0; });
}

std::vector<double> DesignSearch::unscaled(std::span<const double> u) const {
    std::vector<double> x;
    for (std::size_t v = 0; v < problem_.variables.size(); ++v) {
        x.push_back(problem_.variables[v].unscaled(u[v]));
    }
    return x;
}

Candidate DesignSearch::describe(std::span<const double> x) const {
    Candidate result;
    result.at.assign(x.begin(), x.end());
    for (const Objective& objective : problem_.objectives) {
        result.objectives.push_back(evaluate(objective.response, x));
    }
    double chance = 0;
    for (const Limit& limit : problem_.limits) {
        const ResponseValue v = evaluate(limit.response, x);
        result.limits.push_back(v);
        chance += log_chance_below(v.value, v.sigma, limit.upper).value +
                  log_chance_below(-v.value, v.sigma, -limit.lower).value;
    }
    result.chance_valid = std::exp(chance);
    return result;
}

double DesignSearch::best_of(const std::vector<std::vector<double>>& designs) const {
    double best = std::numeric_limits<double>::quiet_NaN();
    for (const std::vector<double>& x : designs) {
        const bool valid = known_limits_hold(x) &&
                           std::all_of(problem_.limits.begin(), problem_.limits.end(), [&](const Limit& limit) {
                               const double v = evaluate_alone(limit.response, x).value;
                               return v >= limit.lower && v <= limit.upper;
                           });
        if (valid) {
            const Objective& first = problem_.objectives.front();
            best = std::fmin(best, cost_of(first, evaluate_alone(first.response, x).value));
        }
    }
    return best;
}

double DesignSearch::log_acquisition(std::span<const double> x, double best, const NextOptions& options,
                                     Candidate* described) const {
    if (!known_limits_hold(x)) {
        return -infinity;
    }
    Candidate c = describe(x);
    c.chance_solved = chance_solved(problem_.variables, x, options);
    double value = std::log(core::never_zero(c.chance_valid)) + std::log(c.chance_solved);
    if (!std::isnan(best)) {  // with nothing valid yet, what is most likely valid comes first
        const Objective& objective = problem_.objectives.front();
        const ResponseValue v = c.objectives.front();
        if (objective.sense == Objective::Sense::target) {
            // |f - target| < best: the improvement on each side.
            const double below = log_expected_improvement(objective.target - v.value, v.sigma, best).value;
            const double above = log_expected_improvement(v.value - objective.target, v.sigma, best).value;
            value += std::min(below, above);
        } else {
            value += log_expected_improvement(cost_of(objective, v.value), v.sigma, best).value;
        }
    }
    c.log_value = value;
    if (described != nullptr) {
        *described = std::move(c);
    }
    return value;
}

void DesignSearch::choose_level(Candidate& candidate, const NextOptions& options) const {
    const Bound bound = bind(problem_.objectives.front().response);
    const std::vector<double> point = bound.filled_point(bound.told, candidate.at);
    candidate.sigma_now = bound.surrogate->at(point).sigma;
    double best = -1;
    for (const std::size_t t : bound.surrogate->fidelities()) {
        const double cost = t < options.level_costs.size() ? options.level_costs[t] : 1;
        const double after = bound.surrogate->sigma_after(point, point, t);
        const double gain = (candidate.sigma_now * candidate.sigma_now - after * after) / cost;
        if (gain > best) {
            best = gain;
            candidate.level = t;
            candidate.sigma_after = after;
        }
    }
}

DesignSearch DesignSearch::with(const std::vector<double>& at, std::size_t fidelity) const {
    DesignSearch result = *this;
    for (auto& [name, surrogate] : result.surrogates_) {
        for (const Objective& objective : problem_.objectives) {
            if (!objective.response.asks_for(name)) {
                continue;
            }
            const Bound bound = bind(objective.response);
            for (const std::size_t i : bound.runs) {
                surrogate =
                    surrogate.with({bound.filled_point(i, at), fidelity, std::numeric_limits<double>::quiet_NaN(), 0});
            }
        }
    }
    return result;
}

DesignSearch DesignSearch::with_planned(const NextOptions& options) const {
    DesignSearch search = *this;
    for (const auto& [at, fidelity] : options.planned) {
        search = search.with(at, fidelity);
    }
    return search;
}

namespace {

/// Climbs from a point of the cube to the nearest maximum of an acquisition.
template <class Acquisition>
void climb(const Acquisition& acquisition, const std::vector<double>& low, const std::vector<double>& high,
           std::pair<double, std::vector<double>>& tried) {
    const std::size_t axes = low.size();
    nlopt::opt local(nlopt::LN_SBPLX, static_cast<unsigned>(axes));
    local.set_lower_bounds(low);
    local.set_upper_bounds(high);
    local.set_maxeval(static_cast<int>(60 * axes));
    local.set_xtol_abs(1e-5);
    local.set_initial_step(0.03);
    nlopt::func f = [](unsigned n, const double* u, double*, void* data) {
        return (*static_cast<const Acquisition*>(data))(std::span<const double>(u, n));
    };
    local.set_max_objective(f, const_cast<void*>(static_cast<const void*>(&acquisition)));
    double value = 0;
    try {
        local.optimize(tried.second, value);
        tried.first = value;
    } catch (const nlopt::roundoff_limited&) {
        tried.first = acquisition(tried.second);
    }
}

/// The box of the unit cube that is searched.
struct Box {
    std::vector<double> low, high;
};

/// A place in the unit cube and its value.
using Tried = std::pair<double, std::vector<double>>;

/// Of a plan of so many places that fills the box the six (of a small plan three) of the largest value that hold what
/// must hold.
template <class Value, class Holds>
std::vector<Tried> best_places(const Box& box, std::size_t places, std::size_t count, std::uint64_t seed,
                               const Value& value, const Holds& holds) {
    const std::size_t axes = box.low.size();
    std::vector<Tried> tried;
    for (std::vector<double>& u : sobol_plan(places, axes, seed)) {
        for (std::size_t v = 0; v < axes; ++v) {
            u[v] = box.low[v] + u[v] * (box.high[v] - box.low[v]);
        }
        const double at = value(u);
        tried.emplace_back(at, std::move(u));
    }
    std::sort(tried.begin(), tried.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Tried> best;
    for (std::size_t i = 0; i < tried.size() && best.size() < count && tried[i].first > -1e10; ++i) {
        if (holds(tried[i].second)) {
            best.push_back(std::move(tried[i]));
        }
    }
    return best;
}

}  // namespace

std::vector<double> DesignSearch::centre_of_trust(const NextOptions& options, double best) const {
    std::vector<double> centre;
    if (options.region && problem_.variables.size() > trust_region_from && !std::isnan(best)) {
        for (const std::vector<double>& x : options.solved) {
            if (best_of({x}) == best) {
                for (std::size_t v = 0; v < x.size(); ++v) {
                    centre.push_back(problem_.variables[v].scaled(x[v]));
                }
                break;
            }
        }
    }
    return centre;
}

std::vector<Candidate> DesignSearch::next_designs(const NextOptions& options, core::Progress& progress) const {
    const std::size_t axes = problem_.variables.size();
    std::vector<Candidate> batch;
    DesignSearch search = with_planned(options);
    Taken taken(problem_.variables, options);
    const double best = best_of(options.solved);
    Box box{std::vector<double>(axes, 0.0), std::vector<double>(axes, 1.0)};
    const std::vector<double> centre = centre_of_trust(options, best);
    for (std::size_t v = 0; v < centre.size(); ++v) {
        box.low[v] = std::max(0.0, centre[v] - options.region->length / 2);
        box.high[v] = std::min(1.0, centre[v] + options.region->length / 2);
    }
    while (batch.size() < options.count) {
        progress.check();
        say_design(progress, batch.size(), options.count);
        // Surrogates are cheaper than shapes: known limits are asked of those that would be chosen.
        DesignSearch unlimited = search;
        unlimited.problem_.known_limits.clear();
        const auto value_by = [&](const DesignSearch& by, std::span<const double> u) {
            const std::vector<double> x = unscaled(u);
            const double value = taken.holds(x) ? -infinity : by.log_acquisition(x, best, options, nullptr);
            return std::isfinite(value) ? value : -1e10;
        };
        std::vector<Tried> refined = best_places(
            box, starts(500, 4000), has_curves() ? 3 : 6, options.seed + batch.size(),
            [&](std::span<const double> u) { return value_by(unlimited, u); },
            [&](std::span<const double> u) { return search.known_limits_hold(unscaled(u)); });
        if (refined.empty()) {
            break;  // no further design meets the known limits
        }
        for (Tried& one : refined) {
            climb([&](std::span<const double> u) { return value_by(search, u); }, box.low, box.high, one);
        }
        const auto chosen = std::max_element(refined.begin(), refined.end(),
                                             [](const auto& a, const auto& b) { return a.first < b.first; });
        Candidate candidate;
        (void)search.log_acquisition(unscaled(chosen->second), best, options, &candidate);
        search.choose_level(candidate, options);
        batch.push_back(candidate);
        search = search.with(candidate.at, candidate.level);
        taken.add(candidate.at);
    }
    return batch;
}

std::vector<Candidate> DesignSearch::next_to_learn(const NextOptions& options, core::Progress& progress) const {
    const std::size_t axes = problem_.variables.size();
    const Plan where = sobol_plan(64, axes, options.seed + 1000);
    std::vector<Candidate> batch;
    DesignSearch search = with_planned(options);
    Taken taken(problem_.variables, options);
    const Bound bound = bind(problem_.objectives.front().response);
    const auto filled = [&](std::span<const double> u) { return bound.filled_point(bound.told, unscaled(u)); };
    while (batch.size() < options.count) {
        progress.check();
        say_design(progress, batch.size(), options.count);
        const Surrogate& surrogate = search.surrogates_.at(problem_.objectives.front().response.quantity);
        double most = 0;
        Candidate chosen;
        for (const std::vector<double>& u : sobol_plan(100, axes, options.seed + batch.size())) {
            const std::vector<double> x = unscaled(u);
            if (taken.holds(x) || !known_limits_hold(x)) {
                continue;
            }
            const double solved = chance_solved(problem_.variables, x, options);
            for (const std::size_t t : surrogate.fidelities()) {
                double gain = 0;
                for (const std::vector<double>& other : where) {
                    const std::vector<double> target = filled(other);
                    const double now = surrogate.at(target).sigma;
                    const double after = surrogate.sigma_after(target, filled(u), t);
                    gain += now * now - after * after;
                }
                gain *= solved / (t < options.level_costs.size() ? options.level_costs[t] : 1);
                if (gain > most) {
                    most = gain;
                    chosen = search.describe(x);
                    chosen.chance_solved = solved;
                    chosen.level = t;
                    chosen.log_value = std::log(gain);
                    chosen.sigma_now = surrogate.at(filled(u)).sigma;
                    chosen.sigma_after = surrogate.sigma_after(filled(u), filled(u), t);
                }
            }
        }
        if (!(most > 0)) {
            break;
        }
        batch.push_back(chosen);
        search = search.with(chosen.at, chosen.level);
        taken.add(chosen.at);
    }
    return batch;
}

}  // namespace underbody::tables
