// Searches on surrogates: evaluations until the minimum is found beside OpenTURNS's EfficientGlobalOptimization, both
// from the same first points; fits and candidates a second. UNDERBODY_BENCH_SEEDS: how many seeds (20).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "core/random.h"
#include "surrogates/tables/search/design_search.h"
#include "surrogates/tables/search/sampling.h"
#include "surrogates/tables/search/surrogate.h"

#ifdef UNDERBODY_HAS_OPENTURNS
#include <openturns/OT.hxx>
#endif

namespace {

using namespace underbody;
using namespace underbody::tables;
using std::numbers::pi;
using Point = std::vector<double>;

/// On the unit cube. Limits hold where they are <= 0.
struct TestFunction {
    std::size_t axes;
    std::size_t first;  ///< points before the search
    std::size_t most;   ///< evaluations after which a search counts as not arrived
    double target;      ///< found: a valid value at most this
    std::function<double(const Point&)> f;
    std::vector<std::function<double(const Point&)>> limits;
};

/// Branin and Hoo 1972, minimum 0.397887.
TestFunction branin() {
    return {2,
            8,
            60,
            0.41,
            [](const Point& u) {
                const double x = -5 + 15 * u[0], y = 15 * u[1];
                return std::pow(y - 5.1 / (4 * pi * pi) * x * x + 5 / pi * x - 6, 2) +
                       10 * (1 - 1 / (8 * pi)) * std::cos(x) + 10;
            },
            {}};
}

/// Hartmann 1973 in six variables, minimum -3.32237 (and a local one of -3.2032).
TestFunction hartmann() {
    return {6,
            20,
            90,
            -3.1,
            [](const Point& u) {
                constexpr double a[4] = {1, 1.2, 3, 3.2};
                constexpr double b[4][6] = {{10, 3, 17, 3.5, 1.7, 8},
                                            {0.05, 10, 17, 0.1, 8, 14},
                                            {3, 3.5, 1.7, 10, 17, 8},
                                            {17, 8, 0.05, 10, 0.1, 14}};
                constexpr double p[4][6] = {{1312, 1696, 5569, 124, 8283, 5886},
                                            {2329, 4135, 8307, 3736, 1004, 9991},
                                            {2348, 1451, 3522, 2883, 3047, 6650},
                                            {4047, 8828, 8732, 5743, 1091, 381}};
                double sum = 0;
                for (int i = 0; i < 4; ++i) {
                    double e = 0;
                    for (int j = 0; j < 6; ++j) {
                        e += b[i][j] * std::pow(u[static_cast<std::size_t>(j)] - 1e-4 * p[i][j], 2);
                    }
                    sum -= a[i] * std::exp(-e);
                }
                return sum;
            },
            {}};
}

/// Gramacy et al. 2016: a linear function within two limits, minimum 0.599788.
TestFunction constrained() {
    return {2,
            8,
            60,
            0.61,
            [](const Point& u) { return u[0] + u[1]; },
            {[](const Point& u) { return 1.5 - u[0] - 2 * u[1] - 0.5 * std::sin(2 * pi * (u[0] * u[0] - 2 * u[1])); },
             [](const Point& u) { return u[0] * u[0] + u[1] * u[1] - 1.5; }}};
}

bool valid(const TestFunction& t, const Point& u) {
    return std::all_of(t.limits.begin(), t.limits.end(), [&](const auto& limit) { return limit(u) <= 0; });
}

bool arrived(const TestFunction& t, const Point& u) { return valid(t, u) && t.f(u) <= t.target; }

std::vector<SearchVariable> unit_variables(std::size_t axes) {
    std::vector<SearchVariable> variables;
    for (std::size_t a = 0; a < axes; ++a) {
        variables.push_back({"x" + std::to_string(a), "1", 0, 1});
    }
    return variables;
}

/// Evaluations until it arrives; `most` when it does not.
std::size_t ours(const TestFunction& t, std::uint64_t seed) {
    SearchProblem problem;
    problem.variables = unit_variables(t.axes);
    problem.objectives = {{{"f", "f", {}, "", 0}, Objective::Sense::minimise, 0}};
    for (std::size_t k = 0; k < t.limits.size(); ++k) {
        const std::string name = "c" + std::to_string(k);
        problem.limits.push_back({{name, name, {}, "", 0}, -1e300, 0});
    }
    std::vector<Point> points = sobol_plan(t.first, t.axes, seed);
    DesignSearch::NextOptions options;
    options.seed = seed;
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (arrived(t, points[n])) {
            return n + 1;
        }
    }
    options.solved = points;
    while (points.size() < t.most) {
        std::map<std::string, Surrogate> surrogates;
        const auto fit = [&](const std::string& name, const auto& function) {
            std::vector<SearchRun> runs;
            for (const Point& u : points) {
                runs.push_back({u, 0, function(u), 0});
            }
            surrogates.emplace(name, Surrogate::fit(name, "1", problem.variables, runs));
        };
        fit("f", t.f);
        for (std::size_t k = 0; k < t.limits.size(); ++k) {
            fit("c" + std::to_string(k), t.limits[k]);
        }
        const auto next = DesignSearch(problem, std::move(surrogates)).next_designs(options);
        if (next.empty()) {
            break;
        }
        points.push_back(next.front().at);
        options.solved.push_back(points.back());
        if (arrived(t, points.back())) {
            return points.size();
        }
    }
    return t.most;
}

#ifdef UNDERBODY_HAS_OPENTURNS
/// EfficientGlobalOptimization takes no constraints: a broken limit is a penalty of ten times what it is broken by.
/// `gave_up` counts the searches that it ended before its evaluations were spent.
std::size_t openturns(const TestFunction& t, std::uint64_t seed, std::size_t& gave_up) {
    OT::Log::Show(OT::Log::NONE);
    OT::RandomGenerator::SetSeed(seed);
    const auto f = [&t](const Point& u) {
        double value = t.f(u);
        for (const auto& limit : t.limits) {
            value += 10 * std::max(0.0, limit(u));
        }
        return value;
    };
    OT::Sample x(0, static_cast<OT::UnsignedInteger>(t.axes)), y(0, 1);
    std::size_t n = 0;
    for (const Point& u : sobol_plan(t.first, t.axes, seed)) {
        ++n;
        if (arrived(t, u)) {
            return n;
        }
        x.add(OT::Point(OT::Collection<OT::Scalar>(u.begin(), u.end())));
        y.add(OT::Point(1, f(u)));
    }
    struct Evaluation : OT::EvaluationImplementation {
        const std::function<double(const Point&)>* f = nullptr;
        OT::UnsignedInteger axes = 0;
        Evaluation* clone() const override { return new Evaluation(*this); }
        OT::UnsignedInteger getInputDimension() const override { return axes; }
        OT::UnsignedInteger getOutputDimension() const override { return 1; }
        OT::Point operator()(const OT::Point& p) const override {
            return OT::Point(1, (*f)(Point(p.begin(), p.end())));
        }
    } evaluation;
    const auto dimension = static_cast<OT::UnsignedInteger>(t.axes);
    std::size_t calls = 0, found = 0;
    const std::function<double(const Point&)> counted = [&](const Point& u) {
        ++calls;
        if (found == 0 && arrived(t, u)) {
            found = calls;
        }
        return f(u);
    };
    evaluation.f = &counted;
    evaluation.axes = dimension;
    OT::OptimizationProblem problem{OT::Function(evaluation)};
    problem.setBounds(OT::Interval(OT::Point(dimension, 0.0), OT::Point(dimension, 1.0)));
    OT::KrigingAlgorithm kriging(x, y, OT::MaternModel(OT::Point(dimension, 0.5), OT::Point(1, 1.0), 2.5),
                                 OT::ConstantBasisFactory(dimension).build());
    kriging.run();
    OT::EfficientGlobalOptimization search(problem, kriging.getResult());
    search.setMaximumEvaluationNumber(static_cast<OT::UnsignedInteger>(t.most - t.first));
    search.setParameterEstimationPeriod(1);
    search.setImprovementFactor(0);
    search.setCorrelationLengthFactor(1e12);  // stops where a length is below a distance over this: never
    // Its own local searches count as failed where the improvement is flat, and with all of them it ends (Hartmann-6).
    OT::TNC local;
    local.setIgnoreFailure(true);
    OT::Sample starts(0, dimension);
    for (const Point& u : sobol_plan(40, t.axes, seed + 1000)) {
        starts.add(OT::Point(OT::Collection<OT::Scalar>(u.begin(), u.end())));
    }
    search.setOptimizationAlgorithm(OT::MultiStart(local, starts));
    search.setStopCallback([](void* there) { return static_cast<OT::Bool>(*static_cast<std::size_t*>(there) > 0); },
                           &found);
    try {
        search.run();
    } catch (const OT::Exception&) {
        // It gives up where its matrix is singular: not arrived.
    }
    gave_up += found == 0 && calls < t.most - t.first ? 1 : 0;
    return found > 0 ? t.first + found : t.most;
}
#endif

double median(std::vector<std::size_t> counts) {
    std::sort(counts.begin(), counts.end());
    const std::size_t n = counts.size();
    return 0.5 * static_cast<double>(counts[(n - 1) / 2] + counts[n / 2]);
}

/// Counters: median of evaluations until the minimum was found, how many seeds did not find it, and how many gave up.
void evaluations_to_the_minimum(benchmark::State& state, const TestFunction& t) {
    const char* asked = std::getenv("UNDERBODY_BENCH_SEEDS");
    const std::uint64_t seeds = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 20;
    for (auto _ : state) {
        std::vector<std::size_t> own, theirs;
        std::size_t gave_up = 0;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            own.push_back(ours(t, seed));
#ifdef UNDERBODY_HAS_OPENTURNS
            theirs.push_back(openturns(t, seed, gave_up));
#endif
        }
        const auto missed = [&](const std::vector<std::size_t>& counts) {
            return static_cast<double>(std::count(counts.begin(), counts.end(), t.most));
        };
        state.counters["underbody"] = median(own);
        state.counters["underbody_missed"] = missed(own);
        if (!theirs.empty()) {
            state.counters["openturns"] = median(theirs);
            state.counters["openturns_missed"] = missed(theirs);
            state.counters["openturns_gave_up"] = static_cast<double>(gave_up);
        }
    }
}
BENCHMARK_CAPTURE(evaluations_to_the_minimum, branin, branin())->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(evaluations_to_the_minimum, constrained, constrained())->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(evaluations_to_the_minimum, hartmann_6, hartmann())->Iterations(1)->Unit(benchmark::kSecond);

/// 300 runs of 60 shapes in eight variables, six of the shape.
std::vector<SearchRun> many_runs(const std::vector<SearchVariable>& variables) {
    std::vector<SearchRun> runs;
    core::Random random(3);
    for (const Point& shape : sobol_plan(60, 6, 1)) {
        for (int k = 0; k < 5; ++k) {
            Point u = shape;
            u.push_back(random.uniform());
            u.push_back(random.uniform());
            double value = 0.1 * random.uniform(-0.05, 0.05);
            for (std::size_t a = 0; a < variables.size(); ++a) {
                value += std::sin((1 + 0.4 * static_cast<double>(a)) * u[a]) * (1 + u[(a + 1) % 8]);
            }
            runs.push_back({u, 0, value, 0.005});
        }
    }
    return runs;
}

std::vector<SearchVariable> eight_variables() {
    std::vector<SearchVariable> variables = unit_variables(8);
    variables[6].of_shape = variables[7].of_shape = false;
    return variables;
}

/// With every shape left out once.
void fit_300_runs_in_8_variables(benchmark::State& state) {
    const auto variables = eight_variables();
    const auto runs = many_runs(variables);
    for (auto _ : state) {
        benchmark::DoNotOptimize(Surrogate::fit("f", "1", variables, runs).check().inside_95);
    }
}
BENCHMARK(fit_300_runs_in_8_variables)->Iterations(1)->Unit(benchmark::kMillisecond);

#ifdef UNDERBODY_HAS_OPENTURNS
/// The process alone, without leaving anything out.
void openturns_fit_300_runs_in_8_variables(benchmark::State& state) {
    OT::Log::Show(OT::Log::NONE);
    OT::Sample x(0, 8), y(0, 1);
    for (const SearchRun& run : many_runs(eight_variables())) {
        x.add(OT::Point(OT::Collection<OT::Scalar>(run.at.begin(), run.at.end())));
        y.add(OT::Point(1, run.value));
    }
    for (auto _ : state) {
        OT::KrigingAlgorithm kriging(x, y, OT::MaternModel(OT::Point(8, 1.0), OT::Point(1, 1.0), 2.5),
                                     OT::LinearBasisFactory(8).build());
        kriging.run();
    }
}
BENCHMARK(openturns_fit_300_runs_in_8_variables)->Iterations(1)->Unit(benchmark::kMillisecond);
#endif

/// Value and sigma with all slopes, of 300 runs in eight variables: candidates of a search on one core.
void candidates_with_gradients(benchmark::State& state) {
    const auto variables = eight_variables();
    const Surrogate surrogate = Surrogate::fit("f", "1", variables, many_runs(variables));
    const auto points = sobol_plan(512, 8, 9);
    for (auto _ : state) {
        for (const Point& u : points) {
            benchmark::DoNotOptimize(surrogate.at(u, true).sigma);
        }
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * points.size()));
}
BENCHMARK(candidates_with_gradients)->Unit(benchmark::kMillisecond);

/// A kick over the gap, or a window of pitch with its balance at each pitch and its moment, of 300 runs in six numbers
/// of the shape, gap and pitch.
struct CurveSearch {
    Response response;
    DesignSearch search;

    static std::vector<SearchVariable> variables() {
        auto all = eight_variables();
        all[6].name = "gap";
        all[7].name = "pitch";
        return all;
    }
    static SearchProblem problem(const Response& response) {
        return {unit_variables(6), {{response, Objective::Sense::maximise}}, {}, {}};
    }
    static std::map<std::string, Surrogate> surrogates() {
        std::map<std::string, Surrogate> all;
        for (const char* name : {"lift_force", "pitch_moment"}) {
            all.emplace(name, Surrogate::fit(name, "1", variables(), many_runs(variables())));
        }
        return all;
    }
    explicit CurveSearch(Curve curve) : response(made(curve)), search(problem(response), surrogates()) {}
    static Response made(Curve curve) {
        Response r{"curve", "lift_force", {}, "", 0, CurveAsked{}};
        r.curve->curve = curve;
        r.curve->net_weight = 3;
        r.curve->virtual_mass = 4;
        if (curve == Curve::kick) {
            r.conditions = {{"pitch", 0.5}};
        } else {
            r.curve->about = 0.5;
            r.curve->most_moment = 5;
            r.curve->restoring = true;
            r.curve->moment = "pitch_moment";
        }
        return r;
    }
};

enum class Ask { value, with_error, with_slopes };

void candidates_of_curves(benchmark::State& state, Curve curve, Ask ask) {
    const CurveSearch made(curve);
    const auto points = sobol_plan(32, 6, 9);
    for (auto _ : state) {
        for (const Point& u : points) {
            benchmark::DoNotOptimize(ask == Ask::value        ? made.search.evaluate_alone(made.response, u).value
                                     : ask == Ask::with_error ? made.search.evaluate(made.response, u).sigma
                                                              : made.search.slopes(made.response, u).by_sigma[0]);
        }
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * points.size()));
}
BENCHMARK_CAPTURE(candidates_of_curves, kick_value, Curve::kick, Ask::value)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(candidates_of_curves, kick_with_error, Curve::kick, Ask::with_error)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(candidates_of_curves, kick_with_slopes, Curve::kick, Ask::with_slopes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(candidates_of_curves, window_value, Curve::pitch_window, Ask::value)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(candidates_of_curves, window_with_error, Curve::pitch_window, Ask::with_error)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(candidates_of_curves, window_with_slopes, Curve::pitch_window, Ask::with_slopes)
    ->Unit(benchmark::kMillisecond);

}  // namespace
