#include "cases/asked_points.h"

#include <algorithm>
#include <cmath>

#include "cases/design_file.h"
#include "core/text.h"
#include "core/told.h"

namespace underbody::cases {

using tables::SearchVariable;

namespace {

std::vector<std::string> names_of(const std::vector<SearchVariable>& variables) {
    std::vector<std::string> names;
    for (const SearchVariable& v : variables) {
        names.push_back(v.name);
    }
    return names;
}

}  // namespace

std::vector<SearchVariable> conditions_of(const DesignSpec& spec) {
    std::vector<SearchVariable> conditions = spec.all_variables();
    std::erase_if(conditions, [](const SearchVariable& v) { return v.of_shape; });
    return conditions;
}

std::vector<std::pair<std::string, double>> only_values(const DesignSpec& spec) {
    std::vector<std::pair<std::string, double>> all;
    for (const ComputedCondition& c : spec.conditions()) {
        if (c.values.size() == 1) {
            all.emplace_back(c.name, c.values.front());
        }
    }
    return all;
}

void check_asked(const DesignSpec& spec, const AskedPoints& asked) {
    const auto conditions = conditions_of(spec);
    const auto known = names_of(conditions);
    for (const std::string& quantity : asked.quantities) {
        if (!has(spec.quantities, quantity)) {
            throw core::InputError("name", "[design] does not compute " + quantity, {},
                                   core::did_you_mean(quantity, spec.quantities));
        }
    }
    for (const std::string& axis : asked.axes) {
        if (!has(known, axis)) {
            throw core::InputError("name", "'" + axis + "' takes no several values in [design]: it cannot be an axis",
                                   {},
                                   known.empty() ? "give [design] several gaps, pitches, speeds or jets"
                                                 : core::did_you_mean(axis, known));
        }
    }
    const auto only = only_values(spec);
    for (const auto& [name, value] : asked.held.numbers) {
        const auto fixed =
            std::find_if(only.begin(), only.end(), [&, key = name](const auto& v) { return v.first == key; });
        const auto varied = std::find_if(conditions.begin(), conditions.end(),
                                         [&, key = name](const auto& v) { return v.name == key; });
        if (fixed == only.end() && varied == conditions.end()) {
            std::vector<std::string> all = known;
            for (const auto& [one, only_value] : only) {
                all.push_back(one);
            }
            throw core::InputError("name", "'" + name + "' is no condition of [design]", {},
                                   core::did_you_mean(name, all));
        }
        const double lower = fixed != only.end() ? fixed->second : varied->lower;
        const double upper = fixed != only.end() ? fixed->second : varied->upper;
        const double rounding = 1e-9 * std::max(std::abs(lower), std::abs(upper));
        if (value < lower - rounding || value > upper + rounding) {
            const std::string unit = core::find_quantity(name)->unit;
            throw core::InputError(
                "range",
                core::told_condition(name, value) + ": [design] computes " +
                    (upper > lower ? core::told_range(lower, upper, unit) : core::told(lower, unit) + " alone"),
                {}, "stay inside: beyond it nothing was learned");
        }
    }
    if (!asked.axes.empty()) {
        for (const SearchVariable& v : conditions) {
            if (!has(asked.axes, v.name) && !asked.held.number(v.name)) {
                throw core::InputError("missing",
                                       "the loads vary over the " + v.name + ", and it is neither an axis nor held", {},
                                       "say its value, " + core::told_range(v.lower, v.upper, v.unit));
            }
        }
    }
}

}  // namespace underbody::cases
