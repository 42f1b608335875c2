#include "surrogates/tables/analysis/equilibria.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"
#include "core/quantile.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "surrogates/tables/analysis/balances.h"
#include "surrogates/tables/fit/table_batch.h"

namespace underbody::tables {

namespace {

std::size_t free_axis(const ForceTable& table, const std::string& name) {
    require_lift(table);
    if (!name.empty()) {
        return axis_index(table, name);
    }
    return table.axes().size() == 1 ? 0 : axis_index(table, "gap");
}

Stability stability_of(const Line::Zero& zero, double slope_scale) {
    if (zero.extent > 0 || std::abs(zero.slope) <= 1e-7 * slope_scale) {
        return Stability::marginal;
    }
    return zero.slope < 0 ? Stability::stable : Stability::unstable;
}

/// -integral of the force from `from` to `to`: the work against it.
double climb(const Line& force, double from, double to) { return force.integral(from) - force.integral(to); }

/// Where, going from a stable point toward `end`, the potential first reaches `height`; `end` when it never does.
double turning_point(const Line& force, double start, double end, double height) {
    if (climb(force, start, end) <= height) {
        return end;
    }
    double low = start;  // potential below height
    double high = end;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (climb(force, start, middle) < height ? low : high) = middle;
    }
    return low;
}

/// Barriers and kicks of a stable equilibrium between its neighbours.
void fill_kicks(Equilibrium& e, const Line& force, const std::vector<Equilibrium>& all, std::size_t index,
                double mass) {
    const bool has_above = index + 1 < all.size();
    const bool has_below = index > 0;
    const double above = has_above ? all[index + 1].gap : force.upper();
    const double below = has_below ? all[index - 1].gap : force.lower();
    e.up_to_end = !has_above;
    e.down_to_end = !has_below;
    e.barrier_up = std::max(0.0, climb(force, e.gap, above));
    e.barrier_down = std::max(0.0, climb(force, e.gap, below));
    // At an end of the table the force still drives back: no escape there, unless nothing else limits the kick.
    if (has_above && has_below) {
        e.barrier = std::min(e.barrier_up, e.barrier_down);
    } else if (has_above || has_below) {
        e.barrier = has_above ? e.barrier_up : e.barrier_down;
    } else {
        e.barrier = std::min(e.barrier_up, e.barrier_down);
        e.limited_by_range = true;
    }
    e.kick_gap_up =
        has_above && e.barrier_up <= e.barrier ? above - e.gap : turning_point(force, e.gap, above, e.barrier) - e.gap;
    e.kick_gap_down = has_below && e.barrier_down <= e.barrier ? e.gap - below
                                                               : e.gap - turning_point(force, e.gap, below, e.barrier);
    e.kick_gap = std::min(e.kick_gap_up, e.kick_gap_down);
    if (mass > 0) {
        e.kick_velocity = std::sqrt(2 * e.barrier / mass);
        e.kick_velocity_up = std::sqrt(2 * e.barrier_up / mass);
        e.kick_velocity_down = std::sqrt(2 * e.barrier_down / mass);
        double highest = 0;  // a body on its way down may have to cross other barriers first
        for (std::size_t j = 0; j < index; ++j) {
            highest = std::max(highest, climb(force, e.gap, all[j].gap));
        }
        highest = std::max(highest, climb(force, e.gap, force.lower()));
        e.contact_velocity = std::sqrt(2 * highest / mass);
    }
}

Line line_of(const ForceTable& table, std::size_t axis, const std::vector<double>& point,
             const EquilibriumOptions& options) {
    return Line(table, axis, point).scaled(options.scale, -options.net_weight);
}

std::vector<Equilibrium> find(const Line& force) {
    const double slope_scale = force.size() / (force.upper() - force.lower());
    std::vector<Equilibrium> found;
    for (const auto& zero : force.zeros()) {
        Equilibrium e;
        e.gap = zero.x;
        e.stiffness = 0 - zero.slope;  // no negative zero
        e.stability = stability_of(zero, slope_scale);
        e.extent = zero.extent;
        found.push_back(e);
    }
    return found;
}

/// What a drawn table makes of the stiffness where the equilibrium moves to in it.
double stiffness_in(const Line& drawn, const Equilibrium& e) {
    double slope = 0;
    const double moved = drawn.value(e.gap) / e.stiffness;
    static_cast<void>(drawn.value(std::clamp(e.gap + moved, drawn.lower(), drawn.upper()), &slope));
    return -slope;
}

void set_errors(Equilibrium& e, const std::vector<double>& stiffness, double mass) {
    if (e.stability == Stability::marginal || e.sigma == 0) {
        return;
    }
    e.stiffness_sigma = core::central_deviation(stiffness);
    if (e.frequency > 0) {
        std::vector<double> frequency;
        for (const double k : stiffness) {
            frequency.push_back(std::sqrt(k / mass) / (2 * std::numbers::pi));  // no number where it would be unstable
        }
        e.frequency_sigma = core::central_deviation(std::move(frequency));
    }
}

/// From drawn tables: the errors of stiffness and frequency, and in what share each equilibrium has one of its kind
/// near by.
void fill_from_draws(Equilibria& result, const ForceTable& table, std::size_t axis, const std::vector<double>& point,
                     const EquilibriumOptions& options) {
    std::vector<int> hits(result.all.size(), 0);
    std::vector<std::vector<double>> stiffness(result.all.size());
    for (int draw = 0; draw < options.draws; ++draw) {
        const Line drawn = line_of(table.drawn(static_cast<std::uint64_t>(draw)), axis, point, options);
        const auto found = find(drawn);
        for (std::size_t i = 0; i < result.all.size(); ++i) {
            const Equilibrium& e = result.all[i];
            stiffness[i].push_back(stiffness_in(drawn, e));
            const double reach = reach_of(result, e);
            hits[i] += std::any_of(found.begin(), found.end(), [&](const Equilibrium& f) {
                return f.stability == e.stability && std::abs(f.gap - e.gap) <= reach;
            });
        }
    }
    for (std::size_t i = 0; i < result.all.size(); ++i) {
        result.all[i].probability = static_cast<double>(hits[i]) / options.draws;
        set_errors(result.all[i], stiffness[i], options.virtual_mass);
    }
}

}  // namespace

std::string to_string(Stability stability) {
    return stability == Stability::stable ? "stable" : stability == Stability::unstable ? "unstable" : "marginal";
}

std::vector<double> Equilibria::gaps(Stability stability) const {
    std::vector<double> found;
    for (const auto& e : all) {
        if (e.stability == stability) {
            found.push_back(e.gap);
        }
    }
    return found;
}

void require_lift(const ForceTable& table) {
    static const char* const others[] = {"z_force", "x_force", "y_force"};
    const std::string& quantity = table.quantity();
    const bool known = core::find_quantity(quantity) != nullptr ||
                       std::find(std::begin(others), std::end(others), quantity) != std::end(others);
    if (quantity == "lift_force" || (!known && table.unit() == "N")) {
        return;
    }
    throw core::UsageError("quantity", "a net weight is balanced by the lift, and this is a table of " + quantity,
                           {table.source(), {}, {}, {}},
                           quantity == "z_force"
                               ? "z_force = -lift_force, positive down: export the table with up positive"
                               : "choose lift_force where the table has it");
}

Line net_force(const ForceTable& table, const EquilibriumOptions& options) {
    const std::size_t axis = free_axis(table, options.axis);
    return line_of(table, axis, held_point(table, axis, options.held), options);
}

namespace {

/// Error, frequency, damping and kicks of one of the equilibria.
void describe(Equilibria& result, std::size_t i, const Line& force, const AtBalance& at) {
    Equilibrium& e = result.all[i];
    e.sigma = at.error == 0                        ? 0
              : e.stability == Stability::marginal ? std::numeric_limits<double>::infinity()
                                                   : at.error / std::abs(e.stiffness);
    if (at.mass > 0 && e.stability == Stability::stable) {
        e.frequency = std::sqrt(e.stiffness / at.mass) / (2 * std::numbers::pi);
        e.damping_ratio = at.damping / (2 * std::sqrt(e.stiffness * at.mass));
    } else if (at.mass > 0 && e.stability == Stability::unstable) {
        e.growth_rate = std::sqrt(-e.stiffness / at.mass);
    }
    if (e.stability == Stability::stable) {
        fill_kicks(e, force, result.all, i, at.mass);
    }
}

/// A weight in another unit than newton.
void remark_on_weight(Equilibria& result, const Line& force) {
    constexpr double far = 5;  // times what the table can hold up or down
    const double largest = force.scaled(1, result.net_weight).size();
    if (result.all.empty() && std::abs(result.net_weight) > far * largest) {
        result.remarks.push_back({core::Problem::Severity::warning,
                                  "a net weight of " + core::told(result.net_weight, "N") + " is " +
                                      core::format_number(std::abs(result.net_weight) / largest, 3) +
                                      " times the largest force, " + core::told(largest, "N") +
                                      ": nothing balances it (is it in N?)",
                                  {result.source, {}, {}, {}}});
    }
}

}  // namespace

void set_balances(Equilibria& result, const Line& force, const std::function<AtBalance(double gap)>& at) {
    result.lower = force.lower();
    result.upper = force.upper();
    result.force_at_lower = force.value(force.lower());
    result.force_at_upper = force.value(force.upper());
    result.all = find(force);
    result.extremes = force.extremes();
    remark_on_weight(result, force);
    for (std::size_t i = 0; i < result.all.size(); ++i) {
        describe(result, i, force, at(result.all[i].gap));
    }
}

double reach_of(const Equilibria& all, const Equilibrium& one) {
    const double range = all.upper - all.lower;
    return std::max(std::isfinite(one.sigma) ? 4 * one.sigma : range, 1e-9 * range);
}

Equilibria equilibria(const ForceTable& table, const EquilibriumOptions& options) {
    if (!(options.virtual_mass >= 0) || !(options.damping >= 0) || !std::isfinite(options.net_weight) ||
        !std::isfinite(options.scale)) {
        throw core::UsageError("range", "mass and damping must not be negative, weight and scale must be finite");
    }
    const std::size_t axis = free_axis(table, options.axis);
    Equilibria result;
    std::vector<double> point = held_point(table, axis, options.held, &result.remarks);
    const Line force = line_of(table, axis, point, options);
    result.axis = table.axes()[axis].name;
    result.axis_unit = table.axes()[axis].unit;
    result.net_weight = options.net_weight;
    result.virtual_mass = options.virtual_mass;
    result.scale = options.scale;
    for (std::size_t k = 0; k < point.size(); ++k) {
        if (k == axis) {
            continue;
        }
        result.held.emplace_back(table.axes()[k].name, point[k]);
    }
    for (auto& remark : outside_remarks(table, result.held)) {
        result.remarks.push_back(std::move(remark));
    }
    result.quantity = table.quantity();
    result.source = table.source();
    set_balances(result, force, [&](double gap) {
        point[axis] = gap;
        return AtBalance{std::abs(options.scale) * table.sigma(point.data()), options.virtual_mass, options.damping};
    });
    if (options.draws > 0 && table.kind() == "exported grid" && !result.all.empty() && result.all.front().sigma > 0) {
        result.remarks.push_back(
            {core::Problem::Severity::warning,
             "an exported table keeps the error of each value, not which errors go together: those of "
             "stiffness and frequency come out too small here; take them from its points",
             {table.source(), {}, {}, {}}});
    }
    if (options.draws > 0) {
        fill_from_draws(result, table, axis, point, options);
    }
    return result;
}

namespace {
nlohmann::json finite_or_null(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json or_null(const std::optional<double>& value) { return value ? finite_or_null(*value) : nlohmann::json(); }
}  // namespace

void to_json(nlohmann::json& json, const Equilibrium& e) {
    json = nlohmann::json{{"gap", e.gap},
                          {"stable", e.stability == Stability::stable},
                          {"stability", to_string(e.stability)},
                          {"stiffness", e.stiffness},
                          {"stiffness_sigma", or_null(e.stiffness_sigma)},
                          {"sigma", finite_or_null(e.sigma)},
                          {"frequency", e.frequency},
                          {"frequency_sigma", or_null(e.frequency_sigma)},
                          {"angular_frequency", 2 * std::numbers::pi * e.frequency},
                          {"growth_rate", e.growth_rate},
                          {"damping_ratio", e.damping_ratio},
                          {"barrier", e.barrier},
                          {"barrier_up", e.barrier_up},
                          {"barrier_down", e.barrier_down},
                          {"limited_by_range", e.limited_by_range},
                          {"up_to_end", e.up_to_end},
                          {"down_to_end", e.down_to_end},
                          {"kick_velocity", e.kick_velocity},
                          {"kick_velocity_up", e.kick_velocity_up},
                          {"kick_velocity_down", e.kick_velocity_down},
                          {"kick_gap", e.kick_gap},
                          {"kick_gap_up", e.kick_gap_up},
                          {"kick_gap_down", e.kick_gap_down},
                          {"contact_velocity", e.contact_velocity}};
    if (e.extent > 0) {
        json["extent"] = e.extent;
    }
    if (e.probability) {
        json["probability"] = *e.probability;
    }
}

void to_json(nlohmann::json& json, const Equilibria& equilibria) {
    json = nlohmann::json{{"equilibria", equilibria.all},
                          {"axis", equilibria.axis},
                          {"axis_unit", equilibria.axis_unit},
                          {"quantity", equilibria.quantity},
                          {"source", equilibria.source},
                          {"net_weight", equilibria.net_weight},
                          {"virtual_mass", equilibria.virtual_mass},
                          {"scale", equilibria.scale},
                          {"range", {equilibria.lower, equilibria.upper}},
                          {"force_at_ends", {equilibria.force_at_lower, equilibria.force_at_upper}},
                          {"frequency_unit", "Hz"}};
    if (!(equilibria.virtual_mass > 0)) {  // nobody said how heavy it is: not known, which is not nought
        for (auto& one : json["equilibria"]) {
            for (const char* name : {"frequency", "angular_frequency", "growth_rate", "damping_ratio", "kick_velocity",
                                     "kick_velocity_up", "kick_velocity_down", "contact_velocity"}) {
                one[name] = nullptr;
            }
        }
    }
    json["extremes"] = nlohmann::json::array();
    for (const auto& extreme : equilibria.extremes) {
        json["extremes"].push_back(
            {{"gap", extreme.x}, {"force", extreme.value}, {"kind", extreme.highest ? "highest" : "lowest"}});
    }
    json["held"] = nlohmann::json::object();
    for (const auto& [name, value] : equilibria.held) {
        json["held"][name] = value;
    }
    json["remarks"] = nlohmann::json::array();
    for (const auto& remark : equilibria.remarks) {
        json["remarks"].push_back(remark.message);
    }
}

}  // namespace underbody::tables
