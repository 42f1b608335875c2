#include "studio/desktop/case_points.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_groups = 8;  ///< more colours are not told apart

/// Cases that differ in the gap alone.
struct Group {
    cases::Conditions held;  ///< what tells them from the other groups
    std::vector<double> gaps, lifts;
};

/// The conditions but the gap that are not the same in all of `entries`.
std::set<std::string> varying(const std::vector<const cases::Conditions*>& entries) {
    std::set<std::string> names;
    const auto differs = [&](const cases::Conditions& one) {
        return std::any_of(entries.begin(), entries.end(), [&](const auto* other) { return !other->satisfies(one); });
    };
    for (const auto* entry : entries) {
        for (const auto& [name, value] : entry->numbers) {
            cases::Conditions one;
            one.set(name, value);
            if (name != "gap" && differs(one)) {
                names.insert(name);
            }
        }
        for (const auto& [name, text] : entry->texts) {
            cases::Conditions one;
            one.texts = {{name, text}};
            if (differs(one)) {
                names.insert(name);
            }
        }
    }
    return names;
}

cases::Conditions only(cases::Conditions all, const std::set<std::string>& names) {
    std::erase_if(all.numbers, [&](const auto& one) { return !names.contains(one.first); });
    std::erase_if(all.texts, [&](const auto& one) { return !names.contains(one.first); });
    return all;
}

std::vector<Group> groups_of(const cases::Study& study, const cases::StudyResults& results) {
    std::vector<const cases::CaseLoads*> drawn;
    std::vector<const cases::Conditions*> conditions;
    for (const auto& loads : results.case_loads) {
        const auto& entry = study.cases[loads.entry].conditions;
        if (entry.number("gap") && std::isfinite(loads.value("lift_force"))) {
            drawn.push_back(&loads);
            conditions.push_back(&entry);
        }
    }
    const std::set<std::string> names = varying(conditions);
    std::vector<Group> groups;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        const cases::Conditions held = only(*conditions[i], names);
        auto at = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
            return group.held.satisfies(held) && held.satisfies(group.held);
        });
        if (at == groups.end()) {
            at = groups.insert(groups.end(), {held, {}, {}});
        }
        at->gaps.push_back(*conditions[i]->number("gap"));
        at->lifts.push_back(drawn[i]->value("lift_force"));
    }
    return groups;
}

/// As people write it where that is the same number, else in SI with all its digits.
std::string written(double value, const std::string& unit) {
    std::string text = core::told(value, unit);
    try {
        cases::Conditions exact;
        exact.set("value", value);
        cases::Conditions read;
        read.set("value", core::parse_in(text, unit));
        if (read.satisfies(exact)) {
            return text;
        }
    } catch (const core::Error&) {  // a unit of the user's own
    }
    return core::format_number(value, 17) + (unit == "1" ? "" : " " + unit);
}

}  // namespace

core::Figure lift_of_cases(const cases::Study& study, const cases::StudyResults& results) {
    const std::vector<Group> groups = groups_of(study, results);
    core::Figure figure;
    figure.title = "lift of the cases over the gap";
    figure.x = {"gap", "mm", 0, 0, false};
    figure.y = {"lift force", "N", 0, 0, false};
    double least = INFINITY, most = -INFINITY;
    for (const Group& group : groups) {
        const bool one_colour = groups.size() > most_groups;
        if (figure.points.empty() || !one_colour) {
            core::FigurePoints points;
            points.name = one_colour || groups.size() < 2 ? "" : group.held.label();
            points.colour = core::palette(figure.points.size());
            figure.points.push_back(points);
        }
        for (std::size_t i = 0; i < group.gaps.size(); ++i) {
            const double gap = 1000 * group.gaps[i];
            least = std::min(least, gap);
            most = std::max(most, gap);
            figure.points.back().x.push_back(gap);
            figure.points.back().y.push_back(group.lifts[i]);
        }
    }
    figure.x.logarithmic = least > 0 && least < most && tables::spans_decades(least, most);
    return figure;
}

std::string table_of_cases(const cases::Study& study, const cases::StudyResults& results) {
    const std::vector<Group> groups = groups_of(study, results);
    if (groups.empty()) {
        return {};
    }
    const auto tells = [](const Group& group) { return group.held.numbers.size() + group.held.texts.size(); };
    const Group& most = *std::max_element(groups.begin(), groups.end(), [&](const Group& a, const Group& b) {
        return std::pair(tells(a), a.gaps.size()) < std::pair(tells(b), b.gaps.size());
    });
    std::string where;
    for (const auto& [name, value] : most.held.numbers) {
        where += (where.empty() ? "" : ", ") + name + " = \"" + written(value, most.held.unit(name)) + "\"";
    }
    for (const auto& [name, text] : most.held.texts) {
        where += (where.empty() ? "" : ", ") + name + " = \"" + text + "\"";
    }
    return "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"gap\"]" +
           (where.empty() ? "" : "\nwhere = { " + where + " }");
}

}  // namespace underbody::studio
