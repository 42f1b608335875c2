#include "surrogates/tables/analysis/compare.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.h"
#include "core/normal.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/force_table_impl.h"

namespace underbody::tables {

namespace {

constexpr int samples = 400;

const char* name_of(Measure measure) {
    switch (measure) {
        case Measure::lowest:
            return "lowest mean";
        case Measure::highest:
            return "highest mean";
        case Measure::restoring_slope:
            return "largest restoring slope";
        case Measure::restoring_width:
            return "widest restoring range";
        case Measure::largest:
            return "largest value";
        case Measure::smallest:
            return "smallest value";
    }
    return "";
}

struct Slice {
    const ForceTable* table;
    std::size_t axis;
    std::vector<double> point;

    double at(double x, double* slope, double* sigma) {
        point[axis] = x;
        std::array<double, max_axes> s{};
        const double v = table->value_by_policy(point.data(), s.data(), 1U << axis);
        if (slope != nullptr) {
            *slope = s[axis];
        }
        if (sigma != nullptr) {
            *sigma = table->sigma(point.data());
        }
        return v;
    }
};

double measured(Slice slice, Measure measure, double low, double high) {
    double mean = 0, steepest = -INFINITY, width = 0;
    double least = std::min(slice.at(low, nullptr, nullptr), slice.at(high, nullptr, nullptr));
    double most = std::max(slice.at(low, nullptr, nullptr), slice.at(high, nullptr, nullptr));
    for (int i = 0; i < samples; ++i) {
        double slope = 0;
        const double value = slice.at(low + (high - low) * (i + 0.5) / samples, &slope, nullptr);
        mean += value / samples;
        least = std::min(least, value);
        most = std::max(most, value);
        steepest = std::max(steepest, -slope);
        width += slope < 0 ? (high - low) / samples : 0;
    }
    switch (measure) {
        case Measure::restoring_slope:
            return steepest;
        case Measure::restoring_width:
            return width;
        case Measure::largest:
            return most;
        case Measure::smallest:
            return least;
        default:
            return mean;
    }
}

bool is_restoring(Measure measure) {
    return measure == Measure::restoring_slope || measure == Measure::restoring_width;
}

/// What was asked for, or what suits the force; refuses a restoring measure where nothing restores.
Measure chosen(const std::optional<Measure>& asked, const std::string& quantity, const std::string& axis) {
    const bool restores = restores_along(quantity, axis);
    if (asked && is_restoring(*asked) && !restores) {
        throw core::UsageError(
            "measure", "the " + noun_of(quantity) + " restores nothing along the " + axis, {},
            "lift restores along the gap and a moment along its own angle; for others: lowest, highest, "
            "largest or smallest");
    }
    return asked.value_or(restores                   ? Measure::restoring_slope
                          : quantity == "drag_force" ? Measure::lowest
                                                     : Measure::highest);
}

/// Without an error of its points nothing can be said of a table: that of the interpolation vanishes at them.
bool states_errors(const ForceTable& table) {
    const auto& sigma = table.impl().error.node_sigma();
    return std::any_of(sigma.begin(), sigma.end(), [](double s) { return s > 0; });
}

Difference difference(const std::string& a_name, Slice a, const std::string& b_name, Slice b, double low, double high) {
    Difference d{a_name, b_name, {}, 0, low, 0};
    bool open = false;
    const bool known = states_errors(*a.table) && states_errors(*b.table);
    for (int i = 0; i <= samples; ++i) {
        const double x = low + (high - low) * i / samples;
        double sa = 0, sb = 0;
        const double gap = b.at(x, nullptr, &sb) - a.at(x, nullptr, &sa);
        const double joint = std::hypot(sa, sb);
        if (std::abs(gap) > std::abs(d.largest)) {
            d.largest = gap;
            d.at = x;
            d.sigma = known ? joint : std::nan("");
        }
        const bool beyond = known && core::beyond_joint_error(gap, sa, sb);
        if (beyond && !open) {
            d.beyond_error.emplace_back(x, x);
        } else if (beyond) {
            d.beyond_error.back().second = x;
        }
        open = beyond;
    }
    return d;
}

}  // namespace

const std::vector<std::string>& measure_names() {
    static const std::vector<std::string> names = {"lowest",          "highest", "restoring_slope",
                                                   "restoring_width", "largest", "smallest"};
    return names;
}

bool restores_along(const std::string& quantity, const std::string& axis) {
    return (quantity == "lift_force" && axis == "gap") || quantity == axis + "_moment";
}

std::string noun_of(const std::string& quantity) {
    std::string noun = quantity.ends_with("_force") ? quantity.substr(0, quantity.size() - 6) : quantity;
    std::replace(noun.begin(), noun.end(), '_', ' ');
    return noun;
}

namespace {

/// Where each table is cut; they share the range from `lower` to `upper` of the result.
std::vector<Slice> slices_of(const std::vector<std::pair<std::string, ForceTable>>& tables,
                             const ComparisonOptions& options, Comparison& result) {
    std::vector<Slice> slices;
    for (const auto& [name, table] : tables) {
        if (table.quantity() != result.quantity) {
            throw core::UsageError("quantity",
                                   "tables of " + result.quantity + " and " + table.quantity() + " cannot be compared");
        }
        const bool has_gap =
            std::any_of(table.axes().begin(), table.axes().end(), [](const auto& a) { return a.name == "gap"; });
        const std::string axis = !options.axis.empty() ? options.axis : has_gap ? "gap" : table.axes().front().name;
        const std::size_t k = axis_index(table, axis);
        result.axis = axis;
        slices.push_back({&table, k, held_point(table, k, options.held)});
        result.lower = std::max(result.lower, table.axes()[k].lower);
        result.upper = std::min(result.upper, table.axes()[k].upper);
        result.names.push_back(name);
    }
    return slices;
}

/// Of the measure of table `number`: the root mean square over draws of the table from its error.
double error_of(const ForceTable& table, Slice slice, std::size_t number, Measure measure, const Comparison& result) {
    double square = 0;
    constexpr int draws = 40;
    for (int draw = 0; draw < draws; ++draw) {
        const ForceTable drawn = table.drawn(static_cast<std::uint64_t>(draw) * 131 + number);
        slice.table = &drawn;
        square += std::pow(measured(slice, measure, result.lower, result.upper) - result.values[number], 2) / draws;
    }
    return std::sqrt(square);
}

/// The best by the measure, unless none restores; whether it is so beyond the errors.
void choose_winner(Comparison& result, Measure measure, const std::vector<std::pair<std::string, ForceTable>>& tables) {
    const bool low_wins = measure == Measure::lowest || measure == Measure::smallest;
    std::vector<std::size_t> order(tables.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return low_wins ? result.values[a] < result.values[b] : result.values[a] > result.values[b];
    });
    const bool none = is_restoring(measure) && !(result.values[order[0]] > 0);
    if (order.size() > 1 && !none) {
        result.winner = result.names[order[0]];
        result.errors_known =
            std::all_of(tables.begin(), tables.end(), [](const auto& table) { return states_errors(table.second); });
        result.beyond_error =
            result.errors_known && core::beyond_joint_error(result.values[order[0]] - result.values[order[1]],
                                                            result.errors[order[0]], result.errors[order[1]]);
    }
}

}  // namespace

Comparison compare_tables(const std::vector<std::pair<std::string, ForceTable>>& tables,
                          const ComparisonOptions& options) {
    if (tables.empty()) {
        throw core::UsageError("few", "a comparison needs tables");
    }
    Comparison result;
    result.quantity = tables.front().second.quantity();
    result.lower = -INFINITY;
    result.upper = INFINITY;
    const std::vector<Slice> slices = slices_of(tables, options, result);
    if (!(result.lower < result.upper)) {
        throw core::UsageError("range", "the tables have no common range of " + result.axis);
    }
    const Measure measure = chosen(options.measure, result.quantity, result.axis);
    result.measure = name_of(measure);
    const std::string& force_unit = tables.front().second.unit();
    const std::string& axis_unit = tables.front().second.axes()[slices.front().axis].unit;
    result.unit = measure == Measure::restoring_slope   ? unit_per(force_unit, axis_unit)
                  : measure == Measure::restoring_width ? axis_unit
                                                        : force_unit;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        result.values.push_back(measured(slices[i], measure, result.lower, result.upper));
        result.errors.push_back(error_of(tables[i].second, slices[i], i, measure, result));
        for (std::size_t j = 0; j < i; ++j) {
            result.differences.push_back(
                difference(result.names[j], slices[j], result.names[i], slices[i], result.lower, result.upper));
        }
    }
    choose_winner(result, measure, tables);
    return result;
}

void to_json(nlohmann::json& json, const Comparison& c) {
    json = nlohmann::json{
        {"quantity", c.quantity},         {"axis", c.axis},
        {"measure", c.measure},           {"unit", c.unit},
        {"range", {c.lower, c.upper}},    {"winner", c.winner.empty() ? nlohmann::json() : nlohmann::json(c.winner)},
        {"beyond_error", c.beyond_error}, {"errors_known", c.errors_known}};
    for (std::size_t i = 0; i < c.names.size(); ++i) {
        json["variants"].push_back({{"name", c.names[i]}, {"value", c.values[i]}, {"sigma", c.errors[i]}});
    }
    for (const auto& d : c.differences) {
        json["differences"].push_back({{"first", d.first},
                                       {"second", d.second},
                                       {"largest", d.largest},
                                       {"at", d.at},
                                       {"sigma", std::isfinite(d.sigma) ? nlohmann::json(d.sigma) : nlohmann::json()},
                                       {"beyond_error", d.beyond_error}});
    }
}

}  // namespace underbody::tables
