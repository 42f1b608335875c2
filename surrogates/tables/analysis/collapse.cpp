#include "surrogates/tables/analysis/collapse.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/error.h"
#include "core/no_limit.h"
#include "core/normal.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::tables {

namespace {

const std::vector<std::string>& known_levels() {
    static const std::vector<std::string> names = {"speed", "length", "jet_voltage", "jet_flow"};
    return names;
}

std::string chosen_level(const core::Table& table, const std::string& asked) {
    if (!asked.empty()) {
        if (std::find(known_levels().begin(), known_levels().end(), asked) == known_levels().end()) {
            throw core::UsageError("by", "forces are not collapsed by '" + asked + "'", {},
                                   core::did_you_mean(asked, known_levels()));
        }
        return asked;
    }
    for (const auto& name : known_levels()) {
        const core::Column* column = table.find(name);
        if (column == nullptr || column->is_text()) {
            continue;
        }
        const auto [low, high] = std::minmax_element(column->numbers.begin(), column->numbers.end());
        if (low != column->numbers.end() && *high - *low > 1e-9 * std::abs(*high)) {
            return name;
        }
    }
    throw core::InputError("few",
                           "no column speed, length, jet_voltage or jet_flow varies: there is nothing to collapse",
                           {table.source, {}, {}, {}});
}

/// A row as a point of the collapsed curve.
struct Point {
    double x = 0, y = 0, sigma = 0, level = 0;
    std::size_t row = 0;
};

/// Numbers of a column, or one value for all rows.
struct Source {
    const core::Column* column;
    double constant;

    Source(const core::Table& table, const char* name, double otherwise)
        : column(table.find(name)), constant(otherwise) {
        if (column != nullptr && column->is_text()) {
            column = nullptr;
        }
    }
    [[nodiscard]] bool known() const { return column != nullptr || constant > 0; }
    [[nodiscard]] double operator[](std::size_t row) const {
        return column != nullptr ? column->numbers[row] : constant;
    }
};

std::vector<Point> scaled_points(const core::Table& table, const std::string& quantity, const CollapseOptions& options,
                                 Collapse& result) {
    const auto& level = table.numbers(result.by);
    const auto& gap = table.numbers("gap");
    const auto& force = table.numbers(quantity);
    const core::Column* stated = table.find(quantity + "_sigma");
    const Source length(table, "length", options.length), width(table, "width", options.width),
        speed(table, "speed", 0);
    const bool by_stream = result.by == "speed" || result.by == "length";
    if (by_stream && !speed.known()) {
        throw core::InputError("missing", "C_L needs a column 'speed'", {table.source, {}, {}, {}});
    }
    const bool divided = length.known() && by_stream;
    result.abscissa = divided ? "gap_over_length" : "gap";
    result.coefficient = !by_stream                 ? "force_over_" + result.by + "_squared"
                         : !divided                 ? "force_over_dynamic_pressure"
                         : quantity == "drag_force" ? "C_D"
                         : quantity == "lift_force" ? "C_L"
                                                    : "coefficient";
    result.coefficient_unit = by_stream ? (divided ? "1" : "m^2") : "N/(" + result.by_unit + ")^2";
    std::vector<Point> points;
    for (std::size_t i = 0; i < table.rows(); ++i) {
        if (!std::isfinite(force[i]) || !std::isfinite(gap[i]) || !std::isfinite(level[i])) {
            continue;
        }
        if (!(level[i] > 0)) {
            throw core::InputError("range", result.by + " must be positive to collapse by it",
                                   table.place(i, result.by));
        }
        double scale = level[i] * level[i];
        if (by_stream) {
            if (!(speed[i] > 0) || (divided && !(length[i] > 0))) {
                throw core::InputError("range", "speed and length must be positive to make a coefficient",
                                       table.place(i, "gap"));
            }
            const double area = !divided        ? 1
                                : width.known() ? std::numbers::pi / 4 * length[i] * width[i]
                                                : length[i] * length[i];
            scale = 0.5 * options.density * speed[i] * speed[i] * area;
        }
        const double own = stated != nullptr && !stated->is_text() && std::isfinite(stated->numbers[i])
                               ? stated->numbers[i] / scale
                               : 0;
        points.push_back({divided ? gap[i] / length[i] : gap[i], force[i] / scale, own, level[i], i});
    }
    return points;
}

/// The points of the reference group as a curve; one point alone counts at its own gap only.
struct Reference {
    std::vector<Point> points;
    std::optional<ForceTable> curve;

    explicit Reference(std::vector<Point> of, const std::string& source) : points(std::move(of)) {
        std::vector<double> x, y, s;
        for (const auto& p : points) {
            x.push_back(p.x);
            y.push_back(p.y);
            s.push_back(p.sigma);
        }
        if (x.size() < 2) {
            return;
        }
        core::Table table;
        table.source = source;
        table.add_numbers("gap", "m", x);
        table.add_numbers("coefficient", "1", y);
        if (std::all_of(s.begin(), s.end(), [](double v) { return v > 0; })) {
            table.add_numbers("coefficient_sigma", "1", s);
        }
        FitOptions options;
        options.axes = {"gap"};
        curve = ForceTable::fit(table, "coefficient", options);
    }
    /// Nothing outside its gaps.
    [[nodiscard]] std::optional<std::pair<double, double>> at(double x) const {
        if (curve) {
            const auto e = curve->at({&x, 1});
            return e.outside ? std::nullopt : std::make_optional(std::make_pair(e.value, e.sigma));
        }
        const Point& only = points.front();
        return std::abs(x - only.x) <= 1e-9 * std::abs(x) ? std::make_optional(std::make_pair(only.y, only.sigma))
                                                          : std::nullopt;
    }
};

/// Ranges of neighbours (in order of x) that all lie beyond twice their error.
std::vector<std::pair<double, double>> ranges_beyond(std::vector<std::pair<double, double>> deviations) {
    std::sort(deviations.begin(), deviations.end());
    std::vector<std::pair<double, double>> ranges;
    bool open = false;
    for (const auto& [x, deviation] : deviations) {
        const bool beyond = std::abs(deviation) > core::beyond_sigmas;
        if (beyond && !open) {
            ranges.emplace_back(x, x);
        } else if (beyond) {
            ranges.back().second = x;
        }
        open = beyond;
    }
    return ranges;
}

std::string text_of(const Collapse& c, std::size_t beyond, std::size_t all, bool stated) {
    const std::string curve = c.coefficient + (c.abscissa == "gap" ? "(gap)" : "(h/c)");
    const std::string judged = stated ? "their errors" : "the tolerance (no errors are stated)";
    std::string text = c.holds ? "the points fall on one curve " + curve + " within " + judged
                               : "the points do not fall on one curve " + curve + ": the force grows as " + c.by + "^" +
                                     core::format_number(c.exponent, 3);
    text += ", " + std::to_string(beyond) + " of " + std::to_string(all) + " points beyond twice " +
            (stated ? "their joint error" : "the tolerance");
    const auto worst = std::max_element(c.groups.begin(), c.groups.end(), [](const auto& a, const auto& b) {
        return std::abs(a.worst) < std::abs(b.worst);
    });
    return text + ", worst at " +
           (c.abscissa == "gap" ? "gap " + core::told(worst->worst_gap, "m", 4)
                                : "gap/length " + core::format_number(worst->worst_gap, 4)) +
           ", " + c.by + " " + core::format_number(worst->level, 4) + " " + c.by_unit;
}

void add_curve(Collapse& result, const ForceTable& curve) {
    const auto& axis = curve.axes().front();
    const bool log = spans_decades(axis.lower, axis.upper);
    for (int i = 0; i <= 400; ++i) {
        const double t = i / 400.0;
        const double x = i == 400 ? axis.upper
                         : log    ? axis.lower * std::pow(axis.upper / axis.lower, t)
                                  : axis.lower + (axis.upper - axis.lower) * t;
        result.curve_x.push_back(x);
        result.curve_y.push_back(curve.value(&x));
        result.curve_sigma.push_back(curve.sigma(&x));
    }
}

/// Points of the other levels against the reference, summed over the groups.
struct Against {
    double exponent = 0;
    std::size_t points = 0, beyond = 0, far_beyond = 0;
    std::vector<double> x, y, level, deviation;
};

void count_deviation(double gap, double deviation, CollapseGroup& group, Against& sum) {
    sum.beyond += std::abs(deviation) > core::beyond_sigmas ? 1 : 0;
    sum.far_beyond += std::abs(deviation) > 2 * core::beyond_sigmas ? 1 : 0;
    if (std::abs(deviation) >= std::abs(group.worst)) {
        group.worst = deviation;
        group.worst_gap = gap;
    }
}

/// What the points of one level say; one without points of its own in the range of the reference says nothing.
CollapseGroup compared(double level, const std::vector<Point>& members, const Reference& reference,
                       double reference_level, double least_error, Against& sum) {
    CollapseGroup group;
    group.level = level;
    double ratio = 0, exponent = 0, square = 0;
    std::vector<std::pair<double, double>> deviations;
    for (const auto& p : members) {
        const auto expected = reference.at(p.x);
        const double joint =
            !expected ? 1 : std::max({std::hypot(expected->second, p.sigma), least_error, core::least_divisor});
        const double deviation = expected ? (p.y - expected->first) / joint : std::nan("");
        sum.x.push_back(p.x);
        sum.y.push_back(p.y);
        sum.level.push_back(level);
        sum.deviation.push_back(deviation);
        if (!expected || level == reference_level) {
            continue;
        }
        deviations.emplace_back(p.x, deviation);
        ratio += p.y / expected->first;
        exponent +=
            2 + (p.y / expected->first > 0 ? std::log(p.y / expected->first) / std::log(level / reference_level) : 0);
        square += deviation * deviation;
        count_deviation(p.x, deviation, group, sum);
    }
    group.points = deviations.size();
    if (group.points > 0) {
        const auto count = static_cast<double>(group.points);
        group.mean_ratio = ratio / count;
        group.exponent = exponent / count;
        group.rms = std::sqrt(square / count);
        group.beyond = ranges_beyond(std::move(deviations));
        sum.exponent += exponent;
        sum.points += group.points;
    }
    return group;
}

}  // namespace

Collapse collapse(const core::Table& table, const std::string& quantity, const CollapseOptions& options) {
    if (!(options.density > 0) || !(options.length >= 0) || !(options.width >= 0)) {
        throw core::UsageError("range", "density, length and width must be positive to make a coefficient");
    }
    Collapse result;
    result.quantity = quantity;
    result.by = chosen_level(table, options.by);
    (void)table.numbers(result.by);
    result.by_unit = table.find(result.by)->unit;
    const auto points = scaled_points(table, quantity, options, result);
    std::map<double, std::vector<Point>> groups;
    double largest = 0;
    for (const auto& p : points) {
        groups[p.level].push_back(p);
        largest = std::max(largest, std::abs(p.y));
    }
    if (groups.size() < 2) {
        throw core::InputError("few", "all points have the same " + result.by + ": there is nothing to collapse",
                               {table.source, {}, {}, {}});
    }
    const auto most = std::max_element(groups.begin(), groups.end(),
                                       [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    result.reference = most->first;
    const Reference reference(most->second, table.source);
    const bool stated = std::any_of(points.begin(), points.end(), [](const Point& p) { return p.sigma > 0; });
    const double least_error = stated ? 0 : 0.5 * options.tolerance * largest;
    Against sum;
    for (const auto& [level, members] : groups) {
        CollapseGroup group = compared(level, members, reference, result.reference, least_error, sum);
        if (group.points > 0) {
            result.groups.push_back(std::move(group));
        }
    }
    if (result.groups.empty()) {
        throw core::InputError("range", "no gap of another " + result.by + " lies within the gaps of the reference",
                               {table.source, {}, {}, {}});
    }
    result.exponent = sum.exponent / static_cast<double>(sum.points);
    result.holds = sum.beyond <= std::max<std::size_t>(1, sum.points / 20) && sum.far_beyond == 0 &&
                   (sum.points > 4 || sum.beyond == 0);
    result.verdict = text_of(result, sum.beyond, sum.points, stated);
    result.points.add_numbers(result.abscissa, result.abscissa == "gap" ? "m" : "1", sum.x);
    result.points.add_numbers(result.coefficient, result.coefficient_unit, sum.y);
    result.points.add_numbers(result.by, result.by_unit, sum.level);
    result.points.add_numbers("deviation", "1", sum.deviation);
    if (reference.curve) {
        add_curve(result, *reference.curve);
    }
    return result;
}

core::Figure collapse_figure(const Collapse& c) {
    core::Figure figure;
    figure.title = c.quantity + " collapsed by " + c.by;
    figure.caption = c.verdict + ".";
    figure.x = {c.abscissa, c.abscissa == "gap" ? "m" : "1", 0, 0,
                !c.curve_x.empty() && spans_decades(c.curve_x.front(), c.curve_x.back())};
    figure.y = {c.coefficient, c.coefficient_unit, 0, 0, false};
    core::FigureCurve curve;
    curve.name = c.by + " " + core::format_number(c.reference, 4) + " " + c.by_unit + " (curve)";
    curve.colour = core::palette(0);
    curve.x = c.curve_x;
    curve.y = c.curve_y;
    core::FigureBand band;
    band.name = "95 % band";
    band.colour = core::palette(0);
    band.colour.alpha = 50;
    band.x = c.curve_x;
    for (std::size_t i = 0; i < c.curve_x.size(); ++i) {
        band.lower.push_back(c.curve_y[i] - 2 * c.curve_sigma[i]);
        band.upper.push_back(c.curve_y[i] + 2 * c.curve_sigma[i]);
    }
    if (!c.curve_x.empty()) {
        figure.curves.push_back(std::move(curve));
        figure.bands.push_back(std::move(band));
    }
    std::map<double, core::FigurePoints> groups;
    const auto& level = c.points.numbers(c.by);
    for (std::size_t i = 0; i < level.size(); ++i) {
        auto& group = groups[level[i]];
        group.x.push_back(c.points.numbers(c.abscissa)[i]);
        group.y.push_back(c.points.numbers(c.coefficient)[i]);
    }
    std::size_t colour = 0;
    for (auto& [at, group] : groups) {
        group.name = c.by + " " + core::format_number(at, 4) + " " + c.by_unit;
        group.colour = at == c.reference ? core::palette(0) : core::palette(++colour);
        figure.points.push_back(std::move(group));
    }
    return figure;
}

void to_json(nlohmann::json& json, const Collapse& c) {
    json = nlohmann::json{{"quantity", c.quantity},
                          {"by", c.by},
                          {"by_unit", c.by_unit},
                          {"abscissa", c.abscissa},
                          {"coefficient", c.coefficient},
                          {"reference", c.reference},
                          {"holds", c.holds},
                          {"exponent", c.exponent},
                          {"verdict", c.verdict}};
    for (const auto& g : c.groups) {
        json["groups"].push_back({{"level", g.level},
                                  {"points", g.points},
                                  {"mean_ratio", g.mean_ratio},
                                  {"exponent", g.exponent},
                                  {"rms", g.rms},
                                  {"worst", g.worst},
                                  {"worst_gap", g.worst_gap},
                                  {"beyond", g.beyond}});
    }
}

}  // namespace underbody::tables
