// Responses that are numbers of whole curves: the surrogates at nodes over gap and pitch.
#include <algorithm>
#include <cmath>

#include "surrogates/tables/search/curve_forces.h"
#include "surrogates/tables/search/design_search.h"

namespace underbody::tables {

namespace {

// Nodes of a curve. Forces learned from a few gaps and pitches are smooth between these.
constexpr std::size_t gaps_alone = 25, pitches_alone = 17, gaps_of_both = 13, pitches_of_both = 9;

std::vector<double> nodes_of(const SearchVariable& v, std::size_t count) {
    std::vector<double> nodes;
    for (std::size_t i = 0; i < count; ++i) {
        nodes.push_back(v.unscaled(static_cast<double>(i) / static_cast<double>(count - 1)));
    }
    return nodes;
}

std::size_t axis_of(const Surrogate& surrogate, const std::string& name) {
    const auto& variables = surrogate.variables();
    return static_cast<std::size_t>(
        std::find_if(variables.begin(), variables.end(), [&](const SearchVariable& v) { return v.name == name; }) -
        variables.begin());
}

/// Ends and middle.
std::vector<std::size_t> coarse(std::size_t count) {
    return count == 1 ? std::vector<std::size_t>{0} : std::vector<std::size_t>{0, count / 2, count - 1};
}

}  // namespace

void DesignSearch::bind_curve(const CurveAsked& asked, const std::vector<double>& point, Bound& bound) const {
    BoundCurve& curve = *bound.curve;
    curve.asked = asked;
    const auto along = asked.runs_over();
    const auto& variables = bound.surrogate->variables();
    const auto nodes = [&](const char* name, std::size_t alone, std::size_t of_both) {
        return std::find(along.begin(), along.end(), name) == along.end()
                   ? std::vector<double>{0}
                   : nodes_of(variables[axis_of(*bound.surrogate, name)], along.size() == 1 ? alone : of_both);
    };
    CurveForces to;
    to.gaps = nodes("gap", gaps_alone, gaps_of_both);
    to.pitches = nodes("pitch", pitches_alone, pitches_of_both);
    to.lift_size = curve.lift != nullptr ? curve.lift->spread() : 1;
    to.moment_size = curve.moment != nullptr ? curve.moment->spread() : 1;
    bound.size = asked.curve == Curve::kick
                     ? std::sqrt(2 * to.lift_size * (to.gaps.back() - to.gaps.front()) / asked.virtual_mass)
                     : 0.5 * (to.pitches.back() - to.pitches.front());
    for (const double pitch : to.pitches) {
        for (const double gap : to.gaps) {
            bound.points.push_back(point);
            for (const std::string& name : along) {
                bound.points.back()[axis_of(*bound.surrogate, name)] = name == "gap" ? gap : pitch;
            }
        }
    }
    const std::size_t gaps = to.gaps.size(), pitches = to.pitches.size();
    for (const std::size_t j : coarse(pitches)) {
        for (const std::size_t i : coarse(gaps)) {
            bound.runs.push_back(j * gaps + i);
        }
    }
    bound.told = (pitches / 2) * gaps + gaps / 2;
    curve.nodes = std::make_shared<const CurveForces>(std::move(to));
}

ResponseValue DesignSearch::curve_value(const Bound& bound, std::span<const double> x, Errors errors) {
    const BoundCurve& curve = *bound.curve;
    const auto points = bound.filled_points(x);
    const auto with = errors == Errors::stated ? Surrogate::With::covariance : Surrogate::With::values;
    const auto of = [&](const Surrogate* surrogate) {
        return surrogate != nullptr ? surrogate->along(points, with) : SurrogateCurve{};
    };
    const SurrogateCurve lift = of(curve.lift), moment = of(curve.moment);
    CurveForces forces = *curve.nodes;
    forces.lift = lift.value;
    forces.moment = moment.value;
    const CurveNumber number = curve_number(curve.asked, forces);
    const double sigma =
        errors == Errors::stated ? curve_sigma(curve.asked, forces, {lift.covariance, moment.covariance}) : 0;
    return {number.value, sigma, number.at_least};
}

/// The forces' slopes are those of the surrogates; what a number makes of them is a difference along them, which asks
/// the surrogates nothing.
void DesignSearch::slopes_of_curve(const Bound& bound, std::span<const double> x, std::vector<double>& by_value) const {
    const BoundCurve& curve = *bound.curve;
    const auto points = bound.filled_points(x);
    const auto of = [&](const Surrogate* surrogate) {
        return surrogate != nullptr ? surrogate->along(points, Surrogate::With::slopes) : SurrogateCurve{};
    };
    const SurrogateCurve lift = of(curve.lift), moment = of(curve.moment);
    const std::size_t variables = bound.surrogate->variables().size();
    CurveForces forces = *curve.nodes;
    const auto moved = [&](const SurrogateCurve& of_one, std::size_t v, double by) {
        std::vector<double> values = of_one.value;
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] += by * of_one.slope[i * variables + v];
        }
        return values;
    };
    const auto number = [&](std::size_t v, double by) {
        forces.lift = moved(lift, v, by);
        forces.moment = moved(moment, v, by);
        return curve_number(curve.asked, forces).value;
    };
    for (std::size_t v = 0; v < x.size(); ++v) {
        if (bound.filled[v] != static_cast<std::size_t>(-1)) {
            const double step = 1e-5 / problem_.variables[v].scaled_slope(x[v]);
            by_value[v] = (number(bound.filled[v], step) - number(bound.filled[v], -step)) / (2 * step);
        }
    }
}

}  // namespace underbody::tables
