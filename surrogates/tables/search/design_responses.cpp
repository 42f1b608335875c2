// Responses prepared for evaluation on surrogates, and their values.
#include <algorithm>

#include "core/error.h"
#include "surrogates/tables/search/design_search.h"

namespace underbody::tables {

namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? none : static_cast<std::size_t>(at - names.begin());
}

/// The values that a response's conditions state; every other variable must be among those that are searched or that a
/// curve runs over.
std::vector<double> stated_point(const Response& response, const std::vector<std::string>& names,
                                 const std::vector<std::size_t>& searched, const std::vector<std::string>& along) {
    std::vector<double> point(names.size(), 0.0);
    std::vector<bool> given(names.size(), false);
    for (const core::NamedValue& condition : response.conditions) {
        const std::size_t i = index_of(names, condition.name);
        if (i == none) {
            throw core::InputError(
                "condition", "\"" + response.name + "\" states " + condition.name + ", which the runs do not vary", {},
                core::did_you_mean(condition.name, names));
        }
        point[i] = condition.value;
        given[i] = true;
    }
    for (const std::size_t i : searched) {
        if (i != none) {
            given[i] = true;
        }
    }
    for (const std::string& name : along) {
        const std::size_t i = index_of(names, name);
        if (i == none) {
            throw core::InputError(
                "condition",
                "\"" + response.name + "\" is a number of a curve over the " + name + ", which the runs do not vary",
                {}, "runs at several values of it");
        }
        given[i] = true;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!given[i]) {
            throw core::InputError("condition", "\"" + response.name + "\" does not say at which " + names[i], {},
                                   "state it as a condition, or search it");
        }
    }
    return point;
}

}  // namespace

const Surrogate& DesignSearch::surrogate_of(const Response& response, const std::string& quantity) const {
    const auto found = surrogates_.find(quantity);
    if (found == surrogates_.end()) {
        std::vector<std::string> names;
        for (const auto& [name, surrogate] : surrogates_) {
            names.push_back(name);
        }
        throw core::InputError("quantity",
                               "\"" + response.name + "\" asks for " + quantity + ", of which there is no surrogate",
                               {}, core::did_you_mean(quantity, names));
    }
    return found->second;
}

DesignSearch::Bound DesignSearch::bind(const Response& response) const {
    Bound bound;
    bound.surrogate = &surrogate_of(response, response.quantity);
    bound.size = bound.surrogate->spread();
    std::vector<std::string> names;
    for (const SearchVariable& v : bound.surrogate->variables()) {
        names.push_back(v.name);
    }
    for (const SearchVariable& v : problem_.variables) {
        bound.filled.push_back(index_of(names, v.name));
    }
    if (response.curve) {
        const CurveAsked& asked = *response.curve;
        bound.curve.emplace();
        bound.curve->lift = asked.net_weight ? &surrogate_of(response, "lift_force") : nullptr;
        bound.curve->moment = asked.of_moment() ? &surrogate_of(response, asked.moment) : nullptr;
        for (const Surrogate* one : {bound.curve->lift, bound.curve->moment}) {
            if (one != nullptr && one->variables().size() != names.size()) {
                throw core::InputError("quantity", "\"" + response.name + "\" is made of forces over unlike variables");
            }
        }
        bind_curve(asked, stated_point(response, names, bound.filled, asked.runs_over()), bound);
        return bound;
    }
    const std::vector<double> point = stated_point(response, names, bound.filled, {});
    if (response.slope_along.empty()) {
        bound.weights = {1};
        bound.points = {point};
        bound.runs = {0};
        return bound;
    }
    const std::size_t along = index_of(names, response.slope_along);
    if (along == none || !(response.half_width > 0)) {
        throw core::InputError("slope",
                               "\"" + response.name + "\" is a slope along " + response.slope_along +
                                   (along == none ? ", which the runs do not vary" : " of no width"),
                               {}, core::did_you_mean(response.slope_along, names));
    }
    bound.weights = {-0.5 / response.half_width, 0.5 / response.half_width};
    bound.points = {point, point};
    bound.runs = {0, 1};
    bound.points[0][along] -= response.half_width;
    bound.points[1][along] += response.half_width;
    return bound;
}

std::vector<double> DesignSearch::Bound::filled_point(std::size_t i, std::span<const double> x) const {
    std::vector<double> point = points[i];
    for (std::size_t v = 0; v < filled.size(); ++v) {
        if (filled[v] != none) {
            point[filled[v]] = x[v];
        }
    }
    return point;
}

std::vector<std::vector<double>> DesignSearch::Bound::filled_points(std::span<const double> x) const {
    std::vector<std::vector<double>> all;
    for (std::size_t i = 0; i < points.size(); ++i) {
        all.push_back(filled_point(i, x));
    }
    return all;
}

ResponseValue DesignSearch::value(const Bound& bound, std::span<const double> x, Errors errors) const {
    if (bound.curve) {
        return curve_value(bound, x, errors);
    }
    const SurrogatePrediction p = bound.points.size() == 1
                                      ? bound.surrogate->at(bound.filled_point(0, x))
                                      : bound.surrogate->sum(bound.weights, bound.filled_points(x));
    return {p.value, p.sigma};
}

ResponseValue DesignSearch::evaluate(const Response& response, std::span<const double> x) const {
    return value(bind(response), x, Errors::stated);
}

ResponseValue DesignSearch::evaluate_alone(const Response& response, std::span<const double> x) const {
    return {value(bind(response), x, Errors::none)};
}

}  // namespace underbody::tables
