#include "cases/compare_studies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cases/report_tables.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/loads_case.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/points/settled.h"

namespace underbody::cases {

using nlohmann::json;

namespace {

const double unknown = std::nan("");

/// Does a mesh, or a result, and no set point: what may differ within one case.
bool is_of_mesh(const std::string& name) {
    static const std::set<std::string> names = {"mesh", "cells", "faces", "nodes", "points", "elements"};
    return names.contains(name) || postproc::is_result(name);
}

/// The cases of a campaign that have loads.
struct Member {
    const Case* entry;
    const CaseLoads* loads;
};

std::vector<Member> members_of(const Campaign& side) {
    std::vector<Member> members;
    for (const auto& loads : side.results->case_loads) {
        const Case& entry = side.study->cases[loads.entry];
        if (!loads.values.empty() && entry.conditions.satisfies(side.where)) {
            members.push_back({&entry, &loads});
        }
    }
    return members;
}

std::string condition_text(const Conditions& conditions, const std::string& name, double value) {
    const std::string unit = conditions.unit(name);
    return core::format_number(value, 9) + (unit != "1" ? " " + unit : "");
}

/// The conditions of a case as texts.
std::map<std::string, std::string> conditions_of(const Case& entry) {
    std::map<std::string, std::string> all;
    for (const auto& [name, value] : entry.conditions.texts) {
        all[name] = value;
    }
    for (const auto& [name, value] : entry.conditions.numbers) {
        all[name] = condition_text(entry.conditions, name, value);
    }
    return all;
}

/// The one value that a condition has in all cases of a side; "several" or "" (none has it).
std::map<std::string, std::string> common_values(const std::vector<Member>& members) {
    std::map<std::string, std::pair<std::string, std::size_t>> seen;
    for (const auto& member : members) {
        for (const auto& [name, value] : conditions_of(*member.entry)) {
            auto& [first, count] = seen[name];
            first = count == 0 || first == value ? value : "several";
            ++count;
        }
    }
    std::map<std::string, std::string> common;
    for (const auto& [name, value] : seen) {
        common[name] = value.second == members.size() ? value.first : "several";
    }
    return common;
}

class Comparer {
public:
    Comparer(const Campaign& a, const Campaign& b, core::Progress& progress) : a_(a), b_(b), progress_(progress) {}

    StudyComparison run() {
        result_.a = a_.name;
        result_.b = b_.name;
        for (const Campaign* side : {&a_, &b_}) {
            if (!side->where.label().empty() && members_of(*side).empty()) {
                throw core::InputError("missing",
                                       "no case of '" + side->name + "' that has loads has " + side->where.label(),
                                       {side->study->folder().string(), {}, {}, {}},
                                       "study list shows the conditions of the cases; a number without a unit is SI");
            }
        }
        compare_loads();
        if (a_.results != b_.results) {  // tables and maps of one study are the same
            compare_tables();
            compare_maps();
        }
        if (result_.cases == 0 && result_.tables.empty() && result_.maps.empty()) {
            throw core::InputError("missing",
                                   "'" + a_.name + "' and '" + b_.name + "' have no case, table or map in common",
                                   {b_.study->folder().string(), {}, {}, {}},
                                   "cases belong together whose conditions are alike: study list shows them");
        }
        return std::move(result_);
    }

private:
    // --- loads

    /// Conditions in which the sides differ as a whole.
    void find_what_parts_the_sides(const std::vector<Member>& a, const std::vector<Member>& b) {
        const auto common_a = common_values(a), common_b = common_values(b);
        std::set<std::string> names;
        for (const auto* side : {&common_a, &common_b}) {
            for (const auto& [name, value] : *side) {
                names.insert(name);
            }
        }
        for (const auto& name : names) {
            const auto value = [&](const auto& common) {
                const auto found = common.find(name);
                return found == common.end() ? std::string() : found->second;
            };
            if (value(common_a) != value(common_b) && value(common_a) != "several" && value(common_b) != "several") {
                result_.apart.push_back({name, value(common_a), value(common_b)});
            }
        }
    }

    [[nodiscard]] std::string set_point(const Case& entry, bool with_mesh) const {
        std::string text;
        for (const auto& [name, value] : conditions_of(entry)) {
            const bool apart = std::any_of(result_.apart.begin(), result_.apart.end(),
                                           [&](const auto& one) { return one.condition == name; });
            if (!apart && (with_mesh || !is_of_mesh(name))) {
                text += name + "\t" + value + "\n";
            }
        }
        return text;
    }

    /// By their conditions; a set point that several cases of one side have is nobody's.
    std::map<std::string, const Member*> by_set_point(const std::vector<Member>& members, bool with_mesh) const {
        std::map<std::string, const Member*> found;
        for (const auto& member : members) {
            const auto [at, fresh] = found.emplace(set_point(*member.entry, with_mesh), &member);
            if (!fresh) {
                at->second = nullptr;
            }
        }
        return found;
    }

    void compare_loads() {
        const auto a = members_of(a_), b = members_of(b_);
        find_what_parts_the_sides(a, b);
        std::set<const Member*> paired;
        for (const bool with_mesh : {true, false}) {
            const auto here = by_set_point(a, with_mesh), there = by_set_point(b, with_mesh);
            for (const auto& [point, member] : here) {
                const auto other = there.find(point);
                if (member != nullptr && other != there.end() && other->second != nullptr && !paired.contains(member) &&
                    !paired.contains(other->second)) {
                    paired.insert({member, other->second});
                    compare_case(*member, *other->second);
                }
            }
        }
        for (const auto& [members, only] : {std::pair{&a, &result_.only_a}, {&b, &result_.only_b}}) {
            for (const auto& member : *members) {
                if (!paired.contains(&member)) {
                    only->push_back(member.entry->name);
                }
            }
        }
        std::stable_sort(result_.loads.begin(), result_.loads.end(),
                         [](const MovedLoad& x, const MovedLoad& y) { return moved_more(x.load, y.load); });
    }

    double error_of(const Campaign& side, const Member& member, const std::string& quantity) {
        auto& of_tables = errors_[{&side, quantity}];
        if (!of_tables) {
            of_tables = load_errors(*side.study, *side.results, quantity);
        }
        const auto found = of_tables->find(member.entry->name);
        const double of_table = found == of_tables->end() ? unknown : found->second;
        const double scatter = member.loads->value(quantity + "_sigma");
        return std::isnan(of_table) ? scatter : of_table;
    }

    void compare_case(const Member& a, const Member& b) {
        ++result_.cases;
        result_.unsettled_a += a.loads->settled == "not settled" ? 1 : 0;
        result_.unsettled_b += b.loads->settled == "not settled" ? 1 : 0;
        const auto resultant = [](const CaseLoads& loads) {
            return postproc::resultant([&](const char* name) { return loads.value(name); });
        };
        const double length = a.loads->value("reference_length");
        const postproc::LoadScale scale =
            postproc::load_scale(resultant(*a.loads), resultant(*b.loads), std::isfinite(length) ? length : 1);
        for (const char* quantity :
             {"lift_force", "drag_force", "side_force", "pitch_moment", "roll_moment", "yaw_moment"}) {
            MovedLoad one;
            one.load.name = quantity;
            one.load.unit = core::find_quantity(quantity)->unit;
            one.load.a = a.loads->value(quantity);
            one.load.b = b.loads->value(quantity);
            one.load.sigma_a = error_of(a_, a, quantity);
            one.load.sigma_b = error_of(b_, b, quantity);
            one.load.size =
                postproc::load_measure(one.load.a, one.load.b, std::string_view(quantity).ends_with("_moment"), scale);
            judge(one.load);
            one.case_a = a.entry->name;
            one.case_b = b.entry->name;
            one.conditions = a.entry->conditions.label();
            one.settled_a = a.loads->settled;
            one.settled_b = b.loads->settled;
            result_.loads.push_back(std::move(one));
        }
    }

    // --- tables and their equilibria

    /// How the other side's table is fitted is its own matter: each by its own study.
    static tables::ForceTable fitted(const TableResult& result, const TableSpec& spec) {
        return tables::ForceTable::fit(result.points, spec.quantity, fit_options(spec));
    }

    void compare_tables() {
        for (const auto& spec : a_.study->tables) {
            const TableSpec* other = b_.study->find_table(spec.name);
            if (other == nullptr || other->quantity != spec.quantity) {
                continue;
            }
            progress_.check();
            const auto* a = find_result(a_.results->tables, spec.name);
            const auto* b = find_result(b_.results->tables, spec.name);
            if (a == nullptr || b == nullptr) {
                continue;
            }
            MovedTable moved = compared(fitted(*a, spec), fitted(*b, *other), a->points);
            moved.table = spec.name;
            moved.unsettled_a = tables::not_settled(a->points).size();
            moved.unsettled_b = tables::not_settled(b->points).size();
            result_.tables.push_back(std::move(moved));
            compare_equilibria("table/" + spec.name, a->equilibria, b->equilibria, result_.equilibria);
        }
        std::stable_sort(result_.tables.begin(), result_.tables.end(),
                         [](const MovedTable& x, const MovedTable& y) { return moved_more(x.force, y.force); });
    }

    static MovedTable compared(const tables::ForceTable& a, const tables::ForceTable& b, const core::Table& points) {
        MovedTable moved;
        moved.force.name = a.quantity();
        moved.force.unit = a.unit();
        moved.force.a = moved.force.b = moved.force.sigma_a = moved.force.sigma_b = unknown;
        const std::vector<std::vector<double>> places = common_places(a, b, moved.why_not);
        const double size = largest(points, moved.force.name);
        double squares = 0;
        double worst = -1;
        std::size_t beyond = 0;
        for (const auto& place : places) {
            const auto here = a.at(place), there = b.at(place);
            if (here.no_data || there.no_data) {
                continue;
            }
            ++moved.places;
            Moved one = moved.force;
            one.a = here.value;
            one.b = there.value;
            one.sigma_a = here.sigma > 0 ? here.sigma : unknown;
            one.sigma_b = there.sigma > 0 ? there.sigma : unknown;
            one.size = size;
            judge(one);
            squares += one.difference() * one.difference();
            beyond += one.shift == Shift::beyond ? 1 : 0;
            const double weight = std::isnan(one.in_sigma()) ? one.of_size() : one.in_sigma();
            if (weight > worst) {
                worst = weight;
                moved.force = one;
                moved.at.clear();
                for (std::size_t k = 0; k < place.size(); ++k) {
                    moved.at.emplace_back(a.axes()[k].name, place[k]);
                }
            }
        }
        if (moved.places > 0) {
            moved.beyond_share = static_cast<double>(beyond) / static_cast<double>(moved.places);
            moved.root_mean_square = std::sqrt(squares / static_cast<double>(moved.places));
        } else if (moved.why_not.empty()) {
            moved.why_not = "they have no place with data in common";
        }
        return moved;
    }

    static double largest(const core::Table& points, const std::string& quantity) {
        double size = 0;
        for (const double value : points.numbers(quantity)) {
            size = std::isfinite(value) ? std::max(size, std::abs(value)) : size;
        }
        return size;
    }

    /// The points of both within the range of both, and places between them along each axis.
    static std::vector<std::vector<double>> common_places(const tables::ForceTable& a, const tables::ForceTable& b,
                                                          std::string& why_not) {
        if (a.axes().size() != b.axes().size() ||
            !std::equal(a.axes().begin(), a.axes().end(), b.axes().begin(),
                        [](const auto& x, const auto& y) { return x.name == y.name; })) {
            why_not = "their axes differ";
            return {};
        }
        constexpr std::array<std::size_t, tables::max_axes> steps = {200, 24, 9, 6};
        std::vector<std::vector<double>> places(1);
        for (std::size_t k = 0; k < a.axes().size(); ++k) {
            const double lower = std::max(a.axes()[k].lower, b.axes()[k].lower);
            const double upper = std::min(a.axes()[k].upper, b.axes()[k].upper);
            if (!(lower <= upper)) {
                why_not = "their ranges of " + a.axes()[k].name + " have nothing in common";
                return {};
            }
            std::set<double> values;
            for (const auto* table : {&a, &b}) {
                for (const double x : table->axes()[k].points) {
                    if (x >= lower && x <= upper) {
                        values.insert(x);
                    }
                }
            }
            const std::size_t count = steps[a.axes().size() - 1];
            for (std::size_t i = 0; i <= count; ++i) {
                values.insert(lower + (upper - lower) * static_cast<double>(i) / static_cast<double>(count));
            }
            std::vector<std::vector<double>> more_places;
            for (const auto& place : places) {
                for (const double x : values) {
                    more_places.push_back(place);
                    more_places.back().push_back(x);
                }
            }
            places = std::move(more_places);
        }
        return places;
    }

    /// Those of one kind that lie nearest to each other; what has no partner appeared or vanished.
    static void compare_equilibria(const std::string& result, const std::vector<EquilibriumResult>& a,
                                   const std::vector<EquilibriumResult>& b, std::vector<MovedResult>& moved) {
        for (const bool stable : {true, false}) {
            auto here = equilibria_of(a, stable), there = equilibria_of(b, stable);
            while (!here.empty() || !there.empty()) {
                auto from = here.end(), to = there.end();
                double nearest = HUGE_VAL;
                for (auto i = here.begin(); i != here.end(); ++i) {
                    for (auto j = there.begin(); j != there.end(); ++j) {
                        if (std::abs((*i)->gap - (*j)->gap) < nearest) {
                            nearest = std::abs((*i)->gap - (*j)->gap);
                            from = i;
                            to = j;
                        }
                    }
                }
                if (from == here.end()) {
                    (here.empty() ? to = there.begin() : from = here.begin());
                }
                compare_equilibrium(result, from != here.end() ? *from : nullptr, to != there.end() ? *to : nullptr,
                                    stable ? "stable gap" : "unstable gap", moved);
                from = from != here.end() ? here.erase(from) : from;
                to = to != there.end() ? there.erase(to) : to;
            }
        }
    }

    /// Its gap; and of one that both sides have, stiffness and frequency.
    static void compare_equilibrium(const std::string& result, const EquilibriumResult* a, const EquilibriumResult* b,
                                    const std::string& name, std::vector<MovedResult>& moved) {
        const auto add = [&](const std::string& what, const char* unit, double EquilibriumResult::*value,
                             double EquilibriumResult::*sigma) {
            const auto of = [](const EquilibriumResult* one, double EquilibriumResult::*member) {
                return one != nullptr ? one->*member : unknown;
            };
            const auto error = [&](const EquilibriumResult* one) {
                return of(one, sigma) > 0 ? of(one, sigma) : unknown;
            };
            Moved one{what, unit, of(a, value), of(b, value), error(a), error(b), 0, {}};
            one.size = std::max(std::isnan(one.a) ? 0 : std::abs(one.a), std::isnan(one.b) ? 0 : std::abs(one.b));
            judge(one);
            moved.push_back({one, result});
        };
        add(name, "m", &EquilibriumResult::gap, &EquilibriumResult::sigma);
        if (a == nullptr || b == nullptr) {
            return;
        }
        add("stiffness at the " + name, "N/m", &EquilibriumResult::stiffness, &EquilibriumResult::stiffness_sigma);
        if (a->stable && a->frequency > 0 && b->frequency > 0) {
            add("frequency at the " + name, "Hz", &EquilibriumResult::frequency, &EquilibriumResult::frequency_sigma);
        }
    }

    static std::vector<const EquilibriumResult*> equilibria_of(const std::vector<EquilibriumResult>& all, bool stable) {
        std::vector<const EquilibriumResult*> found;
        for (const auto& point : all) {
            if (point.stable == stable) {
                found.push_back(&point);
            }
        }
        return found;
    }

    // --- maps

    void compare_maps() {
        for (const auto& spec : a_.study->regions) {
            const auto* a = find_result(a_.results->regions, spec.name);
            const auto* b = find_result(b_.results->regions, spec.name);
            if (a == nullptr || b == nullptr) {
                continue;
            }
            std::map<std::string, Moved> classes;
            for (const auto* side : {a, b}) {
                const double cell = 1.0 / static_cast<double>(std::min(side->columns, side->rows));
                for (const auto& end : side->ends) {
                    const std::string name = "share of " + end.name;
                    Moved& one = classes.try_emplace(name, Moved{name, "1", 0, 0, 0, 0, 1, {}}).first->second;
                    (side == a ? one.a : one.b) = end.fraction;
                    one.sigma_a = std::max(one.sigma_a, cell / 2);  // a boundary that shifts by a cell
                }
            }
            for (auto& [name, one] : classes) {
                judge(one);
                result_.maps.push_back({one, "region/" + spec.name});
            }
            compare_equilibria("region/" + spec.name, a->equilibria, b->equilibria, result_.maps);
        }
    }

    const Campaign& a_;
    const Campaign& b_;
    core::Progress& progress_;
    StudyComparison result_;
    std::map<std::pair<const Campaign*, std::string>, std::optional<std::map<std::string, double>>> errors_;
};

}  // namespace

std::size_t StudyComparison::beyond() const {
    std::size_t count = 0;
    const auto add = [&](const Moved& one) { count += one.shift == Shift::beyond ? 1 : 0; };
    for (const auto& one : loads) {
        add(one.load);
    }
    for (const auto& one : tables) {
        add(one.force);
    }
    for (const auto* list : {&equilibria, &maps}) {
        for (const auto& one : *list) {
            add(one.value);
        }
    }
    return count;
}

StudyComparison compare_studies(const Campaign& a, const Campaign& b, core::Progress& progress) {
    return Comparer(a, b, progress).run();
}

void to_json(json& all, const StudyComparison& c) {
    all = {{"a", c.a},
           {"b", c.b},
           {"cases", c.cases},
           {"only_a", c.only_a},
           {"only_b", c.only_b},
           {"not_settled", {{"a", c.unsettled_a}, {"b", c.unsettled_b}}},
           {"beyond", c.beyond()}};
    for (const char* key : {"apart", "loads", "tables", "equilibria", "maps"}) {
        all[key] = json::array();
    }
    for (const auto& one : c.apart) {
        all["apart"].push_back({{"condition", one.condition}, {"a", one.a}, {"b", one.b}});
    }
    for (const auto& one : c.loads) {
        json row = one.load;
        row.update({{"case_a", one.case_a},
                    {"case_b", one.case_b},
                    {"conditions", one.conditions},
                    {"settled_a", one.settled_a},
                    {"settled_b", one.settled_b}});
        all["loads"].push_back(std::move(row));
    }
    for (const auto& one : c.tables) {
        json row = one.force;
        row.update({{"table", one.table},
                    {"at", json::object()},
                    {"beyond_share", one.beyond_share},
                    {"root_mean_square", one.root_mean_square},
                    {"places", one.places},
                    {"not_settled", {{"a", one.unsettled_a}, {"b", one.unsettled_b}}}});
        for (const auto& [axis, value] : one.at) {
            row["at"][axis] = value;
        }
        if (!one.why_not.empty()) {
            row["why_not"] = one.why_not;
        }
        all["tables"].push_back(std::move(row));
    }
    for (const auto& [list, key] : {std::pair{&c.equilibria, "equilibria"}, {&c.maps, "maps"}}) {
        for (const auto& one : *list) {
            json row = one.value;
            row["result"] = one.result;
            all[key].push_back(std::move(row));
        }
    }
}

}  // namespace underbody::cases
