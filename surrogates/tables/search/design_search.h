// Where to look next, and where the best is: searches on surrogates over shapes.
//
// A search varies some of the surrogates' variables; the others are conditions that each response states (lift at 5 mm
// and zero pitch; the slope of the pitch moment over +-1 degree), or that it runs over (the kick that a balance over
// the gap survives).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "core/units.h"
#include "surrogates/tables/search/curve.h"
#include "surrogates/tables/search/surrogate.h"

namespace underbody::tables {

struct CurveForces;

/// A number that a design has: a quantity at stated conditions, its difference quotient along one of them, or a number
/// of whole curves over gap and pitch.
struct Response {
    std::string name;                          ///< as people call it: "lift at 5 mm"
    std::string quantity;                      ///< of a surrogate
    std::vector<core::NamedValue> conditions;  ///< SI; variables of the surrogate that are not searched
    std::string slope_along;                   ///< a condition; empty: the value itself
    double half_width = 0;                     ///< of the difference quotient, in the condition's SI unit
    /// A number of curves: `quantity` is lift_force, or of a window at a stated gap the moment; conditions are those
    /// that the curves do not run over.
    std::optional<CurveAsked> curve = {};

    /// Whether it is made of that quantity.
    [[nodiscard]] bool asks_for(const std::string& of) const {
        return of == quantity || (curve && curve->of_moment() && of == curve->moment);
    }
};

struct Objective {
    enum class Sense { minimise, maximise, target };
    Response response;
    Sense sense = Sense::minimise;
    double target = 0;  ///< with Sense::target: the distance to it is minimised
};

struct Limit {
    Response response;
    double lower = -1e300;
    double upper = 1e300;
};

struct SearchProblem {
    std::vector<SearchVariable> variables;  ///< searched
    std::vector<Objective> objectives;      ///< one, or several for a Pareto front
    std::vector<Limit> limits;
    /// What is known without a run (size, certificate, clearance, buoyancy): <= 0 where it holds. May be empty.
    std::vector<std::function<double(std::span<const double>)>> known_limits;
};

/// The SI unit of a response: a slope's is that of the quantity over that of the condition, a curve's its own.
/// `unit_of`: of a quantity or a condition ("1": none, or not known).
std::string response_unit(const Response& response, const std::function<std::string(const std::string&)>& unit_of);

/// What a response is for a design: value and one sigma, SI. Of curves sigma is the root mean square distance to the
/// value of the numbers of curves drawn whole from the surrogates' errors, different quantities independently.
struct ResponseValue {
    double value = 0;
    double sigma = 0;
    bool at_least = false;  ///< of a curve that the range of the data cuts: it may be more
};

/// A response and its derivatives by the searched variables, SI.
struct ResponseSlopes {
    ResponseValue value;
    std::vector<double> by_value, by_sigma;
};

struct Candidate {
    std::vector<double> at;  ///< SI, one a searched variable
    std::vector<ResponseValue> objectives;
    std::vector<ResponseValue> limits;
    double log_value = 0;      ///< log of the acquisition, for candidates of next_designs()
    double chance_valid = 1;   ///< that all limits hold
    double chance_solved = 1;  ///< that a run gives a result, learned from runs that failed
    std::size_t level = 0;     ///< fidelity that pays best, of those that have runs
    /// Of the first objective's quantity at its (first) conditions, in the middle of its curves; highest fidelity.
    double sigma_now = 0;
    double sigma_after = 0;  ///< expected after its run on `level`
};

/// Beyond so many variables a plan cannot fill the ranges: a search keeps to a trust region.
constexpr std::size_t trust_region_from = 6;

/// A box around the best design, for searches in more variables than a plan can fill (Eriksson et al. 2019).
struct TrustRegion {
    double length = 0.8;  ///< share of each range
    int successes = 0;
    int failures = 0;
    /// After a step: doubled after three improvements in a row, halved after as many failures as there are variables.
    void step(bool improved, std::size_t variables);
    /// Too small to go on: start anew elsewhere.
    [[nodiscard]] bool collapsed() const { return length < 0x1p-7; }
};

class DesignSearch {
public:
    /// Surrogates by quantity. Throws core::InputError: a response of an unknown quantity, a variable of a surrogate
    /// that is neither searched nor given as a condition, a condition that no surrogate has (with the nearest).
    DesignSearch(SearchProblem problem, std::map<std::string, Surrogate> surrogates);

    [[nodiscard]] const SearchProblem& problem() const { return problem_; }
    [[nodiscard]] ResponseValue evaluate(const Response& response, std::span<const double> x) const;
    /// evaluate() without the error, which is what costs of a curve.
    [[nodiscard]] ResponseValue evaluate_alone(const Response& response, std::span<const double> x) const;
    /// evaluate() with the derivatives that searches follow.
    [[nodiscard]] ResponseSlopes slopes(const Response& response, std::span<const double> x) const;
    /// Objectives, limits and the chance that these hold.
    [[nodiscard]] Candidate describe(std::span<const double> x) const;

    struct NextOptions {
        std::size_t count = 1;                    ///< for so many machines at once
        std::vector<double> level_costs;          ///< core-seconds of a run of each fidelity; one entry: one fidelity
        std::vector<std::vector<double>> solved;  ///< designs that were run, SI
        std::vector<std::vector<double>> failed;  ///< designs whose run gave no result
        /// Designs that were decided on and have no result yet, and their fidelities: they count as run with what is
        /// predicted there, and nothing is proposed within a hundredth of the ranges about them.
        std::vector<std::pair<std::vector<double>, std::size_t>> planned;
        std::optional<TrustRegion> region;  ///< around the best known design, beyond trust_region_from variables
        std::uint64_t seed = 1;
    };
    /// Where a run improves the first objective most, in the logarithm of the expected improvement times the chances
    /// that limits hold and that it is solved; the batch's earlier members count as planned. Fewer than asked for only
    /// when no more designs meet the known limits.
    [[nodiscard]] std::vector<Candidate> next_designs(const NextOptions& options,
                                                      core::Progress& progress = core::Progress::none()) const;
    /// Where the first objective's sigma, averaged over the searched ranges, falls most a core-second.
    [[nodiscard]] std::vector<Candidate> next_to_learn(const NextOptions& options,
                                                       core::Progress& progress = core::Progress::none()) const;

    /// The best design that meets every limit by `sigmas` of its stated error: gradient-based from many starts. Empty
    /// when none does.
    [[nodiscard]] std::optional<Candidate> optimum(double sigmas, std::uint64_t seed,
                                                   core::Progress& progress = core::Progress::none()) const;
    /// Designs of which none is better in all objectives, at most `count`, along the first objective; each meets every
    /// limit by `sigmas` of its stated error (a design on a limit holds it with a chance of one half).
    [[nodiscard]] std::vector<Candidate> pareto_front(std::size_t count, double sigmas, std::uint64_t seed,
                                                      core::Progress& progress = core::Progress::none()) const;
    /// The best of some designs as predicted (the first objective as something to be made small); NaN when none of them
    /// is valid by its mean.
    [[nodiscard]] double best_of(const std::vector<std::vector<double>>& designs) const;
    /// SI unit of a response: a slope's is that of the quantity over that of the condition.
    [[nodiscard]] std::string unit_of(const Response& response) const;

private:
    struct BoundCurve {
        CurveAsked asked;
        std::shared_ptr<const CurveForces> nodes;  ///< without forces
        const Surrogate *lift = nullptr, *moment = nullptr;
    };
    struct Bound {  ///< a response prepared for evaluation
        const Surrogate* surrogate = nullptr;
        std::vector<double> weights;
        std::vector<std::vector<double>> points;  ///< templates, SI; searched variables are filled in
        std::vector<std::size_t> filled;          ///< surrogate variable of each searched one (npos: none)
        std::vector<std::size_t> runs;            ///< points that runs of a design tell of
        std::size_t told = 0;                     ///< the point whose error stands for the response's
        double size = 1;                          ///< what is a large change of the response, SI
        std::optional<BoundCurve> curve;

        [[nodiscard]] std::vector<double> filled_point(std::size_t point, std::span<const double> x) const;
        [[nodiscard]] std::vector<std::vector<double>> filled_points(std::span<const double> x) const;
    };
    struct OnTheCube;
    enum class Errors { none, stated };
    [[nodiscard]] Bound bind(const Response& response) const;
    [[nodiscard]] const Surrogate& surrogate_of(const Response& response, const std::string& quantity) const;
    void bind_curve(const CurveAsked& asked, const std::vector<double>& point, Bound& bound) const;
    [[nodiscard]] ResponseValue value(const Bound& bound, std::span<const double> x, Errors errors) const;
    [[nodiscard]] static ResponseValue curve_value(const Bound& bound, std::span<const double> x, Errors errors);
    [[nodiscard]] ResponseSlopes value_with_slopes(const Bound& bound, std::span<const double> x, Errors errors) const;
    void slopes_of_curve(const Bound& bound, std::span<const double> x, std::vector<double>& by_value) const;
    void slopes_of_sigma(const Bound& bound, std::span<const double> x, std::vector<double>& by_sigma) const;
    [[nodiscard]] bool has_curves() const;
    [[nodiscard]] std::size_t starts(std::size_t an_axis, std::size_t most) const;
    [[nodiscard]] double cost_of(const Objective& objective, double value) const;
    [[nodiscard]] double log_acquisition(std::span<const double> x, double best, const NextOptions& options,
                                         Candidate* described) const;
    /// Of the region that a search stays in, in the unit cube; empty: the whole cube.
    [[nodiscard]] std::vector<double> centre_of_trust(const NextOptions& options, double best) const;
    [[nodiscard]] bool known_limits_hold(std::span<const double> x) const;
    [[nodiscard]] std::vector<double> unscaled(std::span<const double> u) const;
    void choose_level(Candidate& candidate, const NextOptions& options) const;
    [[nodiscard]] DesignSearch with(const std::vector<double>& at, std::size_t fidelity) const;
    [[nodiscard]] DesignSearch with_planned(const NextOptions& options) const;

    SearchProblem problem_;
    std::map<std::string, Surrogate> surrogates_;
};

/// A design in a table: searched variables with units, objectives and limits with their sigmas, chances.
core::Table table(const DesignSearch& search, const std::vector<Candidate>& candidates);

}  // namespace underbody::tables
