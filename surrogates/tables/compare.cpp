#include "surrogates/tables/compare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::tables {

namespace {

constexpr int samples = 400;

const char* name_of(Measure measure) {
    switch (measure) {
        case Measure::lowest: return "lowest mean";
        case Measure::highest: return "highest mean";
        case Measure::restoring_slope: return "largest restoring slope";
        case Measure::restoring_width: return "widest restoring range";
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
        const double v = table->value(point.data(), s.data());
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
    for (int i = 0; i < samples; ++i) {
        double slope = 0;
        mean += slice.at(low + (high - low) * (i + 0.5) / samples, &slope, nullptr) / samples;
        steepest = std::max(steepest, -slope);
        width += slope < 0 ? (high - low) / samples : 0;
    }
    return measure == Measure::restoring_slope ? steepest : measure == Measure::restoring_width ? width : mean;
}

Difference difference(const std::string& a_name, Slice a, const std::string& b_name, Slice b, double low, double high) {
    Difference d{a_name, b_name, {}, 0, low, 0};
    bool open = false;
    for (int i = 0; i <= samples; ++i) {
        const double x = low + (high - low) * i / samples;
        double sa = 0, sb = 0;
        const double gap = b.at(x, nullptr, &sb) - a.at(x, nullptr, &sa);
        const double joint = std::hypot(sa, sb);
        if (std::abs(gap) > std::abs(d.largest)) {
            d.largest = gap;
            d.at = x;
            d.sigma = joint;
        }
        const bool beyond = std::abs(gap) > 2 * joint && gap != 0;
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

Comparison compare_tables(const std::vector<std::pair<std::string, ForceTable>>& tables, const ComparisonOptions& options) {
    if (tables.size() < 2) {
        throw core::UsageError("few", "a comparison needs at least two tables");
    }
    Comparison result;
    result.quantity = tables.front().second.quantity();
    result.measure = name_of(options.measure);
    result.lower = -INFINITY;
    result.upper = INFINITY;
    std::vector<Slice> slices;
    for (const auto& [name, table] : tables) {
        if (table.quantity() != result.quantity) {
            throw core::UsageError("quantity", "tables of " + result.quantity + " and " + table.quantity() + " cannot be compared");
        }
        const bool has_gap = std::any_of(table.axes().begin(), table.axes().end(), [](const auto& a) { return a.name == "gap"; });
        const std::string axis = !options.axis.empty() ? options.axis : has_gap ? "gap" : table.axes().front().name;
        const std::size_t k = axis_index(table, axis);
        result.axis = axis;
        slices.push_back({&table, k, held_point(table, k, options.held)});
        result.lower = std::max(result.lower, table.axes()[k].lower);
        result.upper = std::min(result.upper, table.axes()[k].upper);
        result.names.push_back(name);
    }
    if (!(result.lower < result.upper)) {
        throw core::UsageError("range", "the tables have no common range of " + result.axis);
    }
    for (std::size_t i = 0; i < slices.size(); ++i) {
        result.values.push_back(measured(slices[i], options.measure, result.lower, result.upper));
        double square = 0;
        constexpr int draws = 40;
        for (int draw = 0; draw < draws; ++draw) {
            const ForceTable drawn = tables[i].second.drawn(static_cast<std::uint64_t>(draw) * 131 + i);
            Slice slice = slices[i];
            slice.table = &drawn;
            square += std::pow(measured(slice, options.measure, result.lower, result.upper) - result.values[i], 2) / draws;
        }
        result.errors.push_back(std::sqrt(square));
        for (std::size_t j = 0; j < i; ++j) {
            result.differences.push_back(difference(result.names[j], slices[j], result.names[i], slices[i], result.lower, result.upper));
        }
    }
    const bool low_wins = options.measure == Measure::lowest;
    std::vector<std::size_t> order(slices.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        order[i] = i;
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return low_wins ? result.values[a] < result.values[b] : result.values[a] > result.values[b]; });
    result.winner = result.names[order[0]];
    result.beyond_error = std::abs(result.values[order[0]] - result.values[order[1]]) > 2 * std::hypot(result.errors[order[0]], result.errors[order[1]]);
    return result;
}

void to_json(nlohmann::json& json, const Comparison& c) {
    json = nlohmann::json{{"quantity", c.quantity}, {"axis", c.axis}, {"measure", c.measure}, {"range", {c.lower, c.upper}}, {"winner", c.winner}, {"beyond_error", c.beyond_error}};
    for (std::size_t i = 0; i < c.names.size(); ++i) {
        json["variants"].push_back({{"name", c.names[i]}, {"value", c.values[i]}, {"sigma", c.errors[i]}});
    }
    for (const auto& d : c.differences) {
        json["differences"].push_back(
            {{"first", d.first}, {"second", d.second}, {"largest", d.largest}, {"at", d.at}, {"sigma", d.sigma}, {"beyond_error", d.beyond_error}});
    }
}

Collapse collapse(const core::Table& table, const std::string& quantity, const CollapseOptions& options) {
    Collapse result;
    result.quantity = quantity;
    result.by = options.by;
    const auto& level = table.numbers(options.by);
    const auto& gap = table.numbers("gap");
    const auto& force = table.numbers(quantity);
    const core::Column* stated = table.find(quantity + "_sigma");
    result.by_unit = table.find(options.by)->unit;
    const double area = options.area > 0 ? options.area : options.length > 0 && options.width > 0 ? std::numbers::pi / 4 * options.length * options.width : 1;
    const double length = options.length > 0 ? options.length : 1;
    const bool speed = options.by == "speed";
    std::map<double, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < table.rows(); ++i) {
        if (std::isfinite(force[i]) && std::isfinite(gap[i]) && std::isfinite(level[i])) {
            if (!(level[i] > 0)) {
                throw core::InputError("range", options.by + " must be positive to collapse by it", table.place(i, options.by));
            }
            groups[level[i]].push_back(i);
        }
    }
    if (groups.size() < 2) {
        throw core::InputError("few", "all points have the same " + options.by + ": there is nothing to collapse", {table.source, {}, {}, {}});
    }
    const auto reference = std::max_element(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    result.reference = reference->first;
    const auto factor = [&](double l) { return speed ? 2 / (options.density * l * l * area) : 1 / (l * l); };
    core::Table base;
    base.source = table.source;
    std::vector<double> x, y, s;
    for (const std::size_t i : reference->second) {
        x.push_back(gap[i]);
        y.push_back(force[i] * factor(level[i]));
        s.push_back(stated != nullptr && !stated->is_text() ? stated->numbers[i] * factor(level[i]) : 0);
    }
    std::optional<ForceTable> curve;
    if (x.size() > 1) {
        base.add_numbers("gap", "m", x);
        base.add_numbers("lift_force", "N", y);
        if (std::all_of(s.begin(), s.end(), [](double v) { return v > 0; })) {
            base.add_numbers("lift_force_sigma", "N", s);
        }
        FitOptions fit;
        fit.axes = {"gap"};
        curve = ForceTable::fit(base, "lift_force", fit);
    }
    const auto at_reference = [&](double h, double& sigma, bool& inside) {
        if (curve) {
            const auto e = curve->at({&h, 1});
            inside = !e.outside;
            sigma = e.sigma;
            return e.value;
        }
        inside = std::abs(h - x.front()) <= 1e-9 * std::abs(h);
        sigma = s.front();
        return y.front();
    };
    std::vector<double> out_x, out_y, out_level, out_deviation;
    double sum_exponent = 0, sum_weight = 0;
    result.holds = true;
    for (const auto& [l, rows] : groups) {
        CollapseGroup group;
        group.level = l;
        double ratio = 0, exponent = 0;
        for (const std::size_t i : rows) {
            double sigma = 0;
            bool inside = false;
            const double c = force[i] * factor(l);
            const double expected = at_reference(gap[i], sigma, inside);
            const double own = stated != nullptr && !stated->is_text() && std::isfinite(stated->numbers[i]) ? stated->numbers[i] * factor(l) : 0;
            const double joint = std::max(std::hypot(sigma, own), 1e-12 * std::abs(expected) + 1e-300);
            const double deviation = (c - expected) / joint;
            out_x.push_back(gap[i] / length);
            out_y.push_back(c);
            out_level.push_back(l);
            out_deviation.push_back(inside ? deviation : std::nan(""));
            if (!inside || l == result.reference) {
                continue;
            }
            ++group.points;
            ratio += c / expected;
            if (c / expected > 0) {
                exponent += 2 + std::log(c / expected) / std::log(l / result.reference);
            }
            if (std::abs(deviation) > std::abs(group.worst)) {
                group.worst = deviation;
                group.worst_gap = gap[i];
            }
        }
        if (group.points == 0) {
            continue;
        }
        const auto count = static_cast<double>(group.points);
        group.mean_ratio = ratio / count;
        group.exponent = exponent / count;
        sum_exponent += exponent;
        sum_weight += count;
        result.holds = result.holds && std::abs(group.worst) <= 2;
        result.groups.push_back(group);
    }
    if (result.groups.empty()) {
        throw core::InputError("range", "no gap of another " + options.by + " lies within the gaps of the reference", {table.source, {}, {}, {}});
    }
    result.exponent = sum_exponent / sum_weight;
    result.verdict = result.holds ? "the points fall on one curve within their errors" : "the points do not fall on one curve: the force grows as " + options.by + "^" + core::format_number(result.exponent, 3);
    if (!result.holds) {
        const auto worst = std::max_element(result.groups.begin(), result.groups.end(), [](const auto& a, const auto& b) { return std::abs(a.worst) < std::abs(b.worst); });
        result.verdict += ", worst at gap " + core::format_number(worst->worst_gap, 4) + " m, " + options.by + " " + core::format_number(worst->level, 4) + " " + result.by_unit;
    }
    result.points.add_numbers(options.length > 0 ? "gap_over_length" : "gap", options.length > 0 ? "1" : "m", out_x);
    result.points.add_numbers(speed ? "coefficient" : "force_over_square", speed ? "1" : "N/V^2", out_y);
    result.points.add_numbers(options.by, result.by_unit, out_level);
    result.points.add_numbers("deviation", "1", out_deviation);
    return result;
}

void to_json(nlohmann::json& json, const Collapse& c) {
    json = nlohmann::json{{"quantity", c.quantity}, {"by", c.by}, {"reference", c.reference}, {"holds", c.holds}, {"exponent", c.exponent}, {"verdict", c.verdict}};
    for (const auto& g : c.groups) {
        json["groups"].push_back({{"level", g.level}, {"points", g.points}, {"mean_ratio", g.mean_ratio}, {"exponent", g.exponent}, {"worst", g.worst}, {"worst_gap", g.worst_gap}});
    }
}

}  // namespace underbody::tables
