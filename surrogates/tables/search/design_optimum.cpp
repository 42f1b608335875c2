// The best design on surrogates, and fronts of several objectives: sequential quadratic programming from many starts.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <utility>

#include "core/no_limit.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/search/design_search.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::tables {

namespace {

using Function = std::function<double(std::span<const double>, std::span<double>)>;  // value and slopes in the cube

/// A function as the optimiser calls it.
struct Called {
    const Function& function;
    const core::Progress& progress;
};

double call(unsigned n, const double* u, double* slope, void* data) {
    const auto& [function, progress] = *static_cast<const Called*>(data);
    if (progress.cancelled()) {
        throw nlopt::forced_stop();  // who called looks at it
    }
    return function({u, n}, slope == nullptr ? std::span<double>() : std::span(slope, n));
}

/// Slopes by central differences, for what has no closed form.
Function with_differences(std::function<double(std::span<const double>)> f) {
    return [f = std::move(f)](std::span<const double> u, std::span<double> slope) {
        constexpr double step = 1e-6;
        std::vector<double> moved(u.begin(), u.end());
        for (std::size_t v = 0; v < slope.size(); ++v) {
            moved[v] = std::min(1.0, u[v] + step);
            const double above = f(moved), upper = moved[v];
            moved[v] = std::max(0.0, u[v] - step);
            slope[v] = (above - f(moved)) / (upper - moved[v]);
            moved[v] = u[v];
        }
        return f(u);
    };
}

/// How many places a search begins with: the error of a curve, which a limit on it asks for, costs hundreds of points.
std::size_t places_for(const SearchProblem& problem, double sigmas, std::size_t an_axis, std::size_t most) {
    const bool dear = sigmas > 0 && std::any_of(problem.limits.begin(), problem.limits.end(),
                                                [](const Limit& limit) { return limit.response.curve.has_value(); });
    return std::min(most, an_axis * problem.variables.size()) / (dear ? 8 : 1);
}

constexpr double of_places = 0.4;  ///< share of the time that goes into looking at places, about

/// What is done of a part of the work, which lasts from one share of it to the other.
void say_step(core::Progress& progress, double from, double to, const char* what, std::size_t done, std::size_t all) {
    progress.check();
    progress.report(from + (to - from) * static_cast<double>(done) / static_cast<double>(all),
                    std::string(what) + ": " + std::to_string(done) + " of " + std::to_string(all));
}

/// Best point from a start; the start itself where no step could be made.
std::vector<double> polished(const Function& objective, const std::vector<Function>& limits, std::vector<double> u,
                             const core::Progress& progress) {
    nlopt::opt search(nlopt::LD_SLSQP, static_cast<unsigned>(u.size()));
    search.set_lower_bounds(0.0);
    search.set_upper_bounds(1.0);
    search.set_maxeval(100);
    search.set_xtol_abs(1e-7);
    Called aim{objective, progress};
    search.set_min_objective(call, &aim);
    std::vector<Called> bounds;
    bounds.reserve(limits.size());
    for (const Function& limit : limits) {
        bounds.push_back({limit, progress});
        search.add_inequality_constraint(call, &bounds.back(), 1e-8);
    }
    std::vector<double> end = u;
    double value = 0;
    try {
        search.optimize(end, value);
        return end;
    } catch (const nlopt::roundoff_limited&) {
        return end;
    } catch (const std::runtime_error&) {
        return u;
    }
}

}  // namespace

/// What the polishing needs: objectives and limits over the cube, the limits with a margin of `sigmas` errors, each
/// scaled by the spread of its quantity so that one tolerance fits all.
struct DesignSearch::OnTheCube {
    std::vector<Function> objectives, limits;

    OnTheCube(const DesignSearch& search, double sigmas) {
        const SearchProblem& problem = search.problem_;
        for (const Objective& objective : problem.objectives) {
            const double spread = search.bind(objective.response).size;
            objectives.push_back(response(
                search, objective.response, Errors::none,
                [&search, &objective, spread](ResponseValue v) {
                    return std::pair{search.cost_of(objective, v.value) / spread, 0.0};
                },
                [&objective, spread](ResponseValue v) {
                    const double sign = objective.sense == Objective::Sense::maximise                               ? -1
                                        : objective.sense == Objective::Sense::target && v.value < objective.target ? -1
                                                                                                                    : 1;
                    return std::pair{sign / spread, 0.0};
                }));
        }
        for (const Limit& limit : problem.limits) {
            const double spread = search.bind(limit.response).size;
            const Errors errors = sigmas > 0 ? Errors::stated : Errors::none;
            if (core::is_limit(limit.upper)) {
                limits.push_back(response(
                    search, limit.response, errors,
                    [=](ResponseValue v) {
                        return std::pair{(v.value + sigmas * v.sigma - limit.upper) / spread, 0.0};
                    },
                    [=](ResponseValue) {
                        return std::pair{1 / spread, sigmas / spread};
                    }));
            }
            if (core::is_limit(limit.lower)) {
                limits.push_back(response(
                    search, limit.response, errors,
                    [=](ResponseValue v) {
                        return std::pair{(limit.lower - v.value + sigmas * v.sigma) / spread, 0.0};
                    },
                    [=](ResponseValue) {
                        return std::pair{-1 / spread, sigmas / spread};
                    }));
            }
        }
        for (const auto& known : problem.known_limits) {
            limits.push_back(
                with_differences([&search, &known](std::span<const double> u) { return known(search.unscaled(u)); }));
        }
    }

    [[nodiscard]] double violation(std::span<const double> u) const {
        double worst = 0;
        for (const Function& limit : limits) {
            worst = std::max(worst, limit(u, {}));
        }
        return worst;
    }

private:
    using OfValue = std::function<std::pair<double, double>(ResponseValue)>;

    /// f(response) with slopes by the chain rule: `rates` are df/dvalue and df/dsigma.
    static Function response(const DesignSearch& search, const Response& response, Errors errors, OfValue f,
                             OfValue rates) {
        const Bound bound = search.bind(response);
        return [&search, bound, errors, f = std::move(f), rates = std::move(rates)](std::span<const double> u,
                                                                                    std::span<double> slope) {
            const std::vector<double> x = search.unscaled(u);
            if (slope.empty()) {
                return f(search.value(bound, x, errors)).first;
            }
            const auto [value, by_value, by_sigma] = search.value_with_slopes(bound, x, errors);
            const auto [a, b] = rates(value);
            for (std::size_t v = 0; v < slope.size(); ++v) {
                slope[v] = (a * by_value[v] + b * by_sigma[v]) / search.problem_.variables[v].scaled_slope(x[v]);
            }
            return f(value).first;
        };
    }
};

ResponseSlopes DesignSearch::value_with_slopes(const Bound& bound, std::span<const double> x, Errors errors) const {
    ResponseSlopes result{value(bound, x, errors), std::vector<double>(x.size(), 0.0),
                          std::vector<double>(x.size(), 0.0)};
    auto& [value, by_value, by_sigma] = result;
    if (bound.curve) {
        slopes_of_curve(bound, x, by_value);
    }
    for (std::size_t p = 0; p < bound.weights.size(); ++p) {
        const SurrogatePrediction here = bound.surrogate->at(bound.filled_point(p, x), true);
        for (std::size_t v = 0; v < x.size(); ++v) {
            if (bound.filled[v] != static_cast<std::size_t>(-1)) {
                by_value[v] += bound.weights[p] * here.slope[bound.filled[v]];
                by_sigma[v] = here.sigma_slope[bound.filled[v]];
            }
        }
    }
    if (bound.points.size() > 1 && errors == Errors::stated) {
        slopes_of_sigma(bound, x, by_sigma);
    }
    return result;
}

ResponseSlopes DesignSearch::slopes(const Response& response, std::span<const double> x) const {
    return value_with_slopes(bind(response), x, Errors::stated);
}

/// The error of a difference and of a curve has no simple slope; that of a curve has small kinks, where a drawn one
/// gains or loses a balance.
void DesignSearch::slopes_of_sigma(const Bound& bound, std::span<const double> x, std::vector<double>& by_sigma) const {
    for (std::size_t v = 0; v < x.size(); ++v) {
        std::vector<double> moved(x.begin(), x.end());
        const double step = (bound.curve ? 1e-3 : 1e-5) / problem_.variables[v].scaled_slope(x[v]);
        moved[v] = x[v] + step;
        const double above = this->value(bound, moved, Errors::stated).sigma;
        moved[v] = x[v] - step;
        by_sigma[v] = (above - this->value(bound, moved, Errors::stated).sigma) / (2 * step);
    }
}

std::optional<Candidate> DesignSearch::optimum(double sigmas, std::uint64_t seed, core::Progress& progress) const {
    const std::size_t axes = problem_.variables.size();
    const OnTheCube cube(*this, sigmas);
    std::vector<std::pair<double, std::vector<double>>> tried;
    Plan places = sobol_plan(places_for(problem_, sigmas, 250, 2000), axes, seed);
    for (std::vector<double>& u : places) {
        say_step(progress, 0, of_places, "designs looked at", tried.size(), places.size());
        // Starts that break a limit come after those that do not.
        const double value = cube.objectives.front()(u, {}) + 1e3 * cube.violation(u);
        tried.emplace_back(value, std::move(u));
    }
    const std::size_t used = std::min<std::size_t>(10, tried.size());
    std::partial_sort(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(used), tried.end());
    constexpr double tolerance = 1e-6;
    double best = std::numeric_limits<double>::infinity();
    std::optional<Candidate> result;
    for (std::size_t i = 0; i < used; ++i) {
        say_step(progress, of_places, 1, "starts followed to their best design", i, used);
        for (const std::vector<double>& u :
             {tried[i].second, polished(cube.objectives.front(), cube.limits, tried[i].second, progress)}) {
            const double value = cube.objectives.front()(u, {});
            if (cube.violation(u) <= tolerance && value < best) {
                best = value;
                result = describe(unscaled(u));
            }
        }
    }
    progress.check();
    progress.report(1, "best design");
    return result;
}

namespace {

/// A design on the unit cube, and its objectives.
struct FrontPoint {
    std::vector<double> u, f;
};

/// `q` is nowhere worse than `p` and somewhere better.
bool dominates(const FrontPoint& q, const FrontPoint& p) {
    bool better = false;
    for (std::size_t k = 0; k < q.f.size(); ++k) {
        if (q.f[k] > p.f[k]) {
            return false;
        }
        better = better || q.f[k] < p.f[k];
    }
    return better;
}

void keep_front(std::vector<FrontPoint>& points) {
    std::vector<FrontPoint> front;
    std::copy_if(points.begin(), points.end(), std::back_inserter(front), [&](const FrontPoint& p) {
        return std::none_of(points.begin(), points.end(), [&](const FrontPoint& q) { return dominates(q, p); });
    });
    points = std::move(front);
}

/// By the first objective; several starts end at one design, which is kept once.
void sort_distinct(std::vector<FrontPoint>& points) {
    std::sort(points.begin(), points.end(),
              [](const FrontPoint& a, const FrontPoint& b) { return a.f.front() < b.f.front(); });
    const auto same = [](const FrontPoint& a, const FrontPoint& b) {
        return std::equal(a.u.begin(), a.u.end(), b.u.begin(),
                          [](double u, double v) { return std::abs(u - v) < 1e-3; });
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto after = points.begin() + static_cast<std::ptrdiff_t>(i) + 1;
        points.erase(std::remove_if(after, points.end(), [&, i](const FrontPoint& p) { return same(points[i], p); }),
                     points.end());
    }
}

/// The limits, and that all objectives but the one in turn are no worse than at a start. The objectives must live
/// longer.
std::vector<Function> limits_from(const std::vector<Function>& objectives, std::vector<Function> limits,
                                  const FrontPoint& start, std::size_t turn) {
    for (std::size_t k = 0; k < objectives.size(); ++k) {
        if (k != turn) {
            limits.push_back([&f = objectives[k], bound = start.f[k]](
                                 std::span<const double> u, std::span<double> slope) { return f(u, slope) - bound; });
        }
    }
    return limits;
}

}  // namespace

std::vector<Candidate> DesignSearch::pareto_front(std::size_t count, double sigmas, std::uint64_t seed,
                                                  core::Progress& progress) const {
    const std::size_t axes = problem_.variables.size(), objectives = problem_.objectives.size();
    const OnTheCube cube(*this, sigmas);
    std::vector<FrontPoint> points;
    const auto take = [&](std::vector<double> u) {
        if (cube.violation(u) > 1e-6) {
            return;
        }
        FrontPoint point{std::move(u), {}};
        for (const Function& f : cube.objectives) {
            point.f.push_back(f(point.u, {}));
        }
        points.push_back(std::move(point));
    };
    const Plan places = sobol_plan(places_for(problem_, sigmas, 500, 3000), axes, seed);
    for (std::size_t i = 0; i < places.size(); ++i) {
        say_step(progress, 0, of_places, "designs looked at", i, places.size());
        take(places[i]);
    }
    keep_front(points);
    // From points of the front, each as far as it goes.
    const std::vector<FrontPoint> cloud = points;
    const std::size_t used = std::min<std::size_t>(cloud.size(), 2 * count);
    for (std::size_t i = 0; i < used; ++i) {
        say_step(progress, of_places, 1, "points of the front followed", i, used);
        const FrontPoint& start = cloud[i * cloud.size() / used];
        // All other objectives no worse than here; the one in turn as small as it gets.
        const std::size_t turn = i % objectives;
        const std::vector<Function> limits = limits_from(cube.objectives, cube.limits, start, turn);
        take(polished(cube.objectives[turn], limits, start.u, progress));
    }
    progress.check();
    progress.report(1, "front");
    keep_front(points);
    sort_distinct(points);
    std::vector<Candidate> result;
    for (std::size_t i = 0; i < std::min(count, points.size()); ++i) {
        const std::size_t at = points.size() <= count || count < 2 ? i : i * (points.size() - 1) / (count - 1);
        result.push_back(describe(unscaled(points[at].u)));
    }
    return result;
}

core::Table table(const DesignSearch& search, const std::vector<Candidate>& candidates) {
    const SearchProblem& problem = search.problem();
    core::Table result;
    const auto column = [&](const std::string& name, const std::string& unit, auto&& value) {
        std::vector<double> values;
        for (const Candidate& c : candidates) {
            values.push_back(value(c));
        }
        result.add_numbers(name, unit, std::move(values));
    };
    for (std::size_t v = 0; v < problem.variables.size(); ++v) {
        column(problem.variables[v].name, problem.variables[v].unit, [v](const Candidate& c) { return c.at[v]; });
    }
    const auto response = [&](const Response& r, auto&& member) {
        const std::string unit = search.unit_of(r);
        column(r.name, unit, [&](const Candidate& c) { return member(c).value; });
        column(r.name + "_sigma", unit, [&](const Candidate& c) { return member(c).sigma; });
        if (r.curve) {
            column(r.name + "_at_least", "1", [&](const Candidate& c) { return member(c).at_least ? 1.0 : 0.0; });
        }
    };
    for (std::size_t k = 0; k < problem.objectives.size(); ++k) {
        response(problem.objectives[k].response,
                 [k](const Candidate& c) -> const ResponseValue& { return c.objectives[k]; });
    }
    for (std::size_t k = 0; k < problem.limits.size(); ++k) {
        response(problem.limits[k].response, [k](const Candidate& c) -> const ResponseValue& { return c.limits[k]; });
    }
    column("chance_valid", "1", [](const Candidate& c) { return c.chance_valid; });
    column("chance_solved", "1", [](const Candidate& c) { return c.chance_solved; });
    column("level", "1", [](const Candidate& c) { return static_cast<double>(c.level); });
    return result;
}

std::string response_unit(const Response& response, const std::function<std::string(const std::string&)>& unit_of) {
    if (response.curve) {
        return tables::unit_of(response.curve->curve);
    }
    const std::string unit = unit_of(response.quantity);
    const std::string along = response.slope_along.empty() ? "1" : unit_of(response.slope_along);
    return along == "1" ? unit : unit_per(unit, along);
}

std::string DesignSearch::unit_of(const Response& response) const {
    return response_unit(response, [&](const std::string& name) -> std::string {
        const Surrogate& surrogate = *bind(response).surrogate;
        if (name == response.quantity) {
            return surrogate.unit();
        }
        for (const SearchVariable& v : surrogate.variables()) {
            if (v.name == name) {
                return v.unit;
            }
        }
        return "1";
    });
}

}  // namespace underbody::tables
