// Objectives and limits of [design].
#include <algorithm>
#include <cmath>
#include <set>

#include "cases/asked_points.h"
#include "cases/design_curves.h"
#include "core/angle.h"
#include "core/error.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::cases {

using core::TomlTable;
using tables::Objective;

namespace {

const std::vector<std::string> senses = {"minimise", "maximise"};

/// A condition of which [design] has one value need not be said; where it is said, it is that one.
void drop_the_only_values(tables::Response& r, const DesignSpec& spec) {
    for (const auto& [name, value] : only_values(spec)) {
        std::erase_if(r.conditions, [&, name = name, value = value](const auto& c) {
            return c.name == name && std::abs(c.value - value) <= 1e-9 * std::abs(value);
        });
    }
}

/// A response with the conditions of `at`; conditions that have one value need not be said.
tables::Response response_from(const TomlTable& table, const DesignSpec& spec) {
    tables::Response r;
    const bool of_curves = table.has("curve");
    r.name = table.string(of_curves ? "curve" : "quantity");
    r.quantity = of_curves ? "" : r.name;
    if (!of_curves && std::find(spec.quantities.begin(), spec.quantities.end(), r.quantity) == spec.quantities.end()) {
        throw core::InputError("quantity",
                               table.path_of("quantity") + ": " + r.quantity + " is none of design.quantities",
                               table.place("quantity"), core::did_you_mean(r.quantity, spec.quantities));
    }
    r.slope_along = of_curves ? "" : table.string_or("slope_along", "");
    const TomlTable at = table.table_or_empty("at");
    for (const std::string& name : at.keys()) {
        const auto* known = core::find_quantity(name);
        if (known == nullptr) {
            throw core::InputError("condition", at.path_of(name) + " is no condition", at.place(name),
                                   core::did_you_mean(name, {"gap", "pitch", "speed"}));
        }
        const double value = at.quantity(name, known->unit);
        r.conditions.push_back({name, value});
        r.name +=
            "_" + name + core::format_number(core::convert(value, known->unit, geometry::shown_unit(known->unit)), 6);
    }
    if (!r.slope_along.empty()) {
        const auto* along = core::find_quantity(r.slope_along);
        const std::string unit = along == nullptr ? "1" : along->unit;
        r.half_width = table.quantity_or("half_width", unit, unit == "rad" ? core::degree : 1e-3);
        r.name += "_slope";
    } else if (table.has("half_width")) {
        table.accept("half_width");
    }
    r.name = table.string_or("name", r.name);
    if (of_curves) {
        read_curve(table, spec, r);
    }
    if (r.name.find_first_of(",\"[]\n\r") != std::string::npos) {
        throw core::InputError("name", table.path_of("name") + ": '" + r.name + "' cannot head a column of plan.csv",
                               table.place("name"), "no commas, quotation marks and square brackets");
    }
    drop_the_only_values(r, spec);
    return r;
}

/// Surrogates know nothing beyond the conditions that are computed.
void check_inside(const tables::Response& r, const tables::SearchVariable& v, double at, const core::Place& place) {
    const double half = r.slope_along == v.name ? r.half_width : 0, rounding = 1e-9 * (v.upper - v.lower);
    if (at - half >= v.lower - rounding && at + half <= v.upper + rounding) {
        return;
    }
    const std::string shown = geometry::shown_value(at, v.unit, 6), range = geometry::shown_value(v.lower, v.unit, 6) +
                                                                            " to " +
                                                                            geometry::shown_value(v.upper, v.unit, 6);
    throw core::InputError("range",
                           "\"" + r.name + "\" is taken at a " + v.name + " of " + shown +
                               (half > 0 ? " +- " + geometry::shown_value(half, v.unit, 6) : "") +
                               ", and [design] computes " + range,
                           place, "take it there, or add values of " + v.name + " to [design]");
}

void check_response(const tables::Response& r, const std::vector<tables::SearchVariable>& conditions,
                    const core::Place& place) {
    std::vector<std::string> names;
    const auto along = r.curve ? r.curve->runs_over() : std::vector<std::string>{};
    for (const tables::SearchVariable& v : conditions) {
        names.push_back(v.name);
        if (std::find(along.begin(), along.end(), v.name) != along.end()) {
            continue;
        }
        const auto said =
            std::find_if(r.conditions.begin(), r.conditions.end(), [&](const auto& c) { return c.name == v.name; });
        if (said == r.conditions.end()) {
            throw core::InputError("missing", "\"" + r.name + "\" does not say at which " + v.name, place,
                                   "at = { " + v.name + " = ... }");
        }
        check_inside(r, v, said->value, place);
    }
    for (const auto& condition : r.conditions) {
        if (std::find(names.begin(), names.end(), condition.name) == names.end()) {
            throw core::InputError("condition",
                                   "\"" + r.name + "\" states " + condition.name + ", which has one value in [design]",
                                   place, "leave it out, or give [design] several values of it");
        }
    }
    if (!r.slope_along.empty() && std::find(names.begin(), names.end(), r.slope_along) == names.end()) {
        throw core::InputError(
            "condition",
            "\"" + r.name + "\" is a slope along " + r.slope_along + ", of which [design] has no two values", place,
            core::did_you_mean(r.slope_along, names));
    }
}

/// Two of one name could not be told apart in tables and files.
void check_name(std::set<std::string>& names, const std::string& name, const char* what, const core::Place& place) {
    if (!names.insert(name).second) {
        throw core::InputError("name", std::string("there are two ") + what + " '" + name + "'", place,
                               "name = \"...\" of each, or one of them");
    }
}

/// Of a target or a limit.
std::string stated_unit(const tables::Response& response) {
    return response.curve ? response_unit(response) : core::find_quantity(response.quantity)->unit;
}

Objective objective_from(const TomlTable& table, const DesignSpec& spec) {
    Objective objective;
    objective.response = response_from(table, spec);
    if (table.has("target")) {
        objective.sense = Objective::Sense::target;
        objective.target = table.quantity("target", stated_unit(objective.response));
    } else {
        objective.sense =
            table.choice("sense", senses) == "minimise" ? Objective::Sense::minimise : Objective::Sense::maximise;
    }
    return objective;
}

void limit_from(const TomlTable& table, DesignSpec& spec) {
    const tables::Response response = response_from(table, spec);
    const std::string unit = stated_unit(response);
    const auto lower = table.find_quantity("at_least", unit), upper = table.find_quantity("at_most", unit);
    if (!lower && !upper) {
        (void)table.quantity("at_least", unit);  // says how it is written
    }
    if (lower && upper && *lower > *upper) {
        throw core::InputError("range", table.path_of("at_least") + " is above at_most: no design can meet both",
                               table.place("at_least"));
    }
    spec.limits.push_back({response, lower.value_or(-core::no_limit), upper.value_or(core::no_limit)});
    spec.limit_places.push_back(table.place());
}

bool same_response(const tables::Response& a, const tables::Response& b) {
    const auto same = [](const core::NamedValue& x, const core::NamedValue& y) {
        return x.name == y.name && x.value == y.value;
    };
    return a.quantity == b.quantity && a.slope_along == b.slope_along && a.half_width == b.half_width &&
           a.curve == b.curve &&
           std::is_permutation(a.conditions.begin(), a.conditions.end(), b.conditions.begin(), b.conditions.end(),
                               same);
}

}  // namespace

void read_wishes(const TomlTable& design, DesignSpec& spec) {
    std::set<std::string> objective_names, limit_names;
    for (const TomlTable& table : design.tables("objective")) {
        spec.objectives.push_back(objective_from(table, spec));
        spec.objective_places.push_back(table.place());
        check_name(objective_names, spec.objectives.back().response.name, "objectives", table.place());
    }
    for (const TomlTable& table : design.tables("limit")) {
        limit_from(table, spec);
        const tables::Response& limited = spec.limits.back().response;
        check_name(limit_names, limited.name, "limits", table.place());
        for (const tables::Objective& objective : spec.objectives) {
            if (objective.response.name == limited.name && !same_response(objective.response, limited)) {
                throw core::InputError(
                    "name", "an objective and a limit that are not of the same are both called '" + limited.name + "'",
                    table.place(), "name = \"...\" of each");
            }
        }
    }
    const TomlTable volume = design.table_or_empty("volume");
    spec.least_volume = volume.quantity_or("at_least", "m^3", spec.least_volume);
    spec.most_volume = volume.quantity_or("at_most", "m^3", spec.most_volume);
    if (spec.least_volume > spec.most_volume) {
        throw core::InputError("range", volume.path_of("at_least") + " is above at_most: no design can meet both",
                               volume.place("at_least"));
    }
}

void check_responses(const DesignSpec& spec) {
    const std::vector<tables::SearchVariable> conditions = conditions_of(spec);
    for (std::size_t i = 0; i < spec.objectives.size(); ++i) {
        check_response(spec.objectives[i].response, conditions, spec.objective_places[i]);
    }
    for (std::size_t i = 0; i < spec.limits.size(); ++i) {
        check_response(spec.limits[i].response, conditions, spec.limit_places[i]);
    }
}

std::vector<tables::Response> DesignSpec::responses() const {
    std::vector<tables::Response> all;
    const auto take = [&](const tables::Response& response) {
        if (std::none_of(all.begin(), all.end(), [&](const auto& known) { return known.name == response.name; })) {
            all.push_back(response);
        }
    };
    for (const auto& objective : objectives) {
        take(objective.response);
    }
    for (const auto& limit : limits) {
        take(limit.response);
    }
    return all;
}

std::string response_unit(const tables::Response& response) {
    return tables::response_unit(response, [](const std::string& name) {
        const auto* known = core::find_quantity(name);
        return known == nullptr ? std::string("1") : known->unit;
    });
}

}  // namespace underbody::cases
