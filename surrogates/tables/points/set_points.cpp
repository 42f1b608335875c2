#include "surrogates/tables/points/set_points.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>

#include "core/counted.h"
#include "core/mistyped.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/points/columns.h"
#include "surrogates/tables/points/settled.h"

namespace underbody::tables {

namespace {

constexpr double same_point = 1e-9;  ///< of the span of an axis

using core::InputError;

core::Problem note(std::string message, core::Place place = {}) {
    return {core::Problem::Severity::note, std::move(message), std::move(place)};
}

core::Problem warning(std::string message, core::Place place = {}) {
    return {core::Problem::Severity::warning, std::move(message), std::move(place)};
}

std::string in_written_unit(const core::Table& table, const std::string& name, double value) {
    const core::Column* column = table.find(name);
    const std::string unit = column->written_unit.empty() ? column->unit : column->written_unit;
    return core::format_number(core::convert(value, column->unit, unit), 6) + " " + unit;
}

std::string describe(const core::Table& table, const std::vector<TableAxis>& axes, const std::vector<double>& x) {
    std::string text;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        text += (k == 0 ? "" : ", ") + axes[k].name + " " + in_written_unit(table, axes[k].name, x[k]);
    }
    return text;
}

struct Spread {
    double lower = 0;
    double upper = 0;
    std::size_t distinct = 0;
};

Spread spread_of(const std::vector<double>& values) {
    Spread spread{INFINITY, -INFINITY, 0};
    std::vector<double> sorted;
    for (const double v : values) {
        if (std::isfinite(v)) {
            sorted.push_back(v);
        }
    }
    std::sort(sorted.begin(), sorted.end());
    if (sorted.empty()) {
        return {};
    }
    spread.lower = sorted.front();
    spread.upper = sorted.back();
    const double tolerance = same_point * (spread.upper - spread.lower);
    double last = -INFINITY;
    for (const double v : sorted) {
        if (v > last + tolerance) {
            ++spread.distinct;
            last = v;
        }
    }
    return spread;
}

/// Squares and slopes of values below this are finite in double, the values themselves in float.
constexpr double most_taken = 1e30;

/// Rows that have the quantity, or an error.
core::Table usable_rows(const core::Table& table, const std::string& quantity, core::Problems& remarks) {
    const auto& values = table.numbers(quantity);
    std::vector<std::size_t> rows;
    std::size_t missing = 0;
    for (std::size_t i = 0; i < table.rows(); ++i) {
        if (std::isnan(values[i])) {
            ++missing;
            continue;
        }
        if (!std::isfinite(values[i])) {
            throw InputError("range", quantity + " is not finite", table.place(i, quantity));
        }
        if (std::abs(values[i]) > most_taken) {
            throw InputError(
                "range",
                quantity + " is " + core::format_number(values[i], 4) +
                    " here: no force and no moment is that large, and what is computed with it is not finite",
                table.place(i, quantity), "take the row out, or mend its number or its unit");
        }
        rows.push_back(i);
    }
    if (missing == 0) {
        return table;
    }
    if (rows.empty()) {
        throw InputError("empty", "no row has a value of " + quantity, {table.source, {}, {}, {}});
    }
    remarks.push_back(note(std::to_string(missing) + (missing == 1 ? " row has" : " rows have") + " no " + quantity +
                               " and " + (missing == 1 ? "is" : "are") + " left out",
                           {table.source, {}, {}, {}}));
    return table.selected(rows);
}

std::vector<std::string> named_axes(const core::Table& table, const std::string& quantity, const AxisOptions& options) {
    std::set<std::string> seen;
    for (const auto& name : options.axes) {
        const Spread spread = spread_of(table.numbers(name));
        if (name == quantity) {
            throw InputError("axis", "'" + name + "' cannot be both the quantity and an axis",
                             {table.source, {}, {}, {}});
        }
        if (!seen.insert(name).second) {
            throw InputError("axis", "axis '" + name + "' is named twice", {table.source, {}, {}, {}});
        }
        if (spread.distinct < 2) {
            throw InputError(
                "axis", "axis '" + name + "' has one value only (" + in_written_unit(table, name, spread.lower) + ")",
                table.place(0, name), "an axis needs at least two set points");
        }
    }
    return options.axes;
}

/// A column that was meant for an axis but is called otherwise would vanish, and its set points look like repetitions.
void refuse_misnamed_axis(const core::Table& table) {
    for (const auto& column : table.columns()) {
        const std::string meant = core::meant_quantity(column);
        const auto& names = axis_names();
        const bool varies =
            std::adjacent_find(column.text.begin(), column.text.end(), std::not_equal_to<>()) != column.text.end() ||
            (!column.is_text() && spread_of(column.numbers).distinct > 1);
        if (!meant.empty() && meant != "time" && varies && table.find(meant) == nullptr &&
            std::find(names.begin(), names.end(), meant) != names.end()) {
            throw InputError(
                "name", "the column '" + column.name + "' looks like " + meant + ", which the table lacks",
                table.place(0, column.name),
                "name it " + core::heading_for(column, meant) + "; if it is something else, name the axes to use");
        }
    }
}

[[noreturn]] void refuse_without_axis(const core::Table& table, const std::string& quantity,
                                      const std::vector<std::string>& constant) {
    std::string known;
    for (const auto& name : constant) {
        known += (known.empty() ? "" : ", ") + name;
    }
    std::string all;
    for (const auto& column : table.columns()) {
        all += (all.empty() ? "" : ", ") + column.name;
    }
    throw InputError("axis", "the table has no axis: no set-point column varies", {table.source, {}, {}, {}},
                     !misnamed_columns(table, quantity).empty() ? misnamed_columns(table, quantity)
                     : known.empty() ? "it needs a column such as gap [mm], pitch [deg] or speed [m/s], and has " + all
                                     : "these have one value throughout: " + known);
}

std::vector<std::string> found_axes(const core::Table& table, const std::string& quantity) {
    refuse_misnamed_axis(table);
    std::vector<std::string> axes;
    std::vector<std::string> constant;
    for (const auto& name : axis_names()) {
        const core::Column* column = table.find(name);
        if (column == nullptr || column->is_text() || name == quantity) {
            continue;
        }
        const Spread spread = spread_of(column->numbers);
        if (spread.distinct < 2) {
            constant.push_back(name);
            continue;
        }
        // The time at which a row was taken is no set point; a time that comes again is.
        if (name == "time" && !axes.empty() && spread.distinct == table.rows()) {
            continue;
        }
        axes.push_back(name);
    }
    if (axes.empty()) {
        refuse_without_axis(table, quantity, constant);
    }
    if (axes.size() > max_axes) {
        std::string names;
        for (const auto& name : axes) {
            names += (names.empty() ? "" : ", ") + name;
        }
        throw InputError("axis", "a table has at most " + std::to_string(max_axes) + " axes, here these vary: " + names,
                         {table.source, {}, {}, {}}, "name the axes to use, or select rows");
    }
    return axes;
}

void read_sigma(SetPoints& points) {
    const std::string name = points.quantity + "_sigma";
    const core::Column* column = points.table.find(name);
    if (column == nullptr || column->is_text()) {
        return;
    }
    std::size_t missing = 0;
    for (std::size_t i = 0; i < points.table.rows(); ++i) {
        const double s = column->numbers[i];
        missing += std::isnan(s) ? 1 : 0;
        if (s <= 0) {
            throw InputError("range", name + " is " + core::format_number(s) + "; one standard deviation is positive",
                             points.table.place(i, name), "leave the column out when the error is not known");
        }
    }
    if (missing == points.table.rows()) {
        return;
    }
    points.sigma = column->numbers;
    if (missing > 0) {
        double largest = 0;
        for (const double s : points.sigma) {
            largest = std::isnan(s) ? largest : std::max(largest, s);
        }
        for (double& s : points.sigma) {
            s = std::isnan(s) ? largest : s;
        }
        points.remarks.push_back(warning(core::counted_of(missing, points.sigma.size(), "point", "has", "have") +
                                             " no " + name + (missing == 1 ? ": it takes" : ": they take") +
                                             " the largest one, " +
                                             in_written_unit(points.table, points.quantity, largest),
                                         {points.table.source, {}, {}, {}}));
    }
}

/// Coordinates of an axis that differ by rounding only are one set point.
void snap_axis(SetPoints& points, std::size_t k) {
    TableAxis& axis = points.axes[k];
    std::vector<double> sorted;
    sorted.reserve(points.x.size());
    for (const auto& x : points.x) {
        sorted.push_back(x[k]);
    }
    std::sort(sorted.begin(), sorted.end());
    axis.lower = sorted.front();
    axis.upper = sorted.back();
    const double tolerance = same_point * (axis.upper - axis.lower);
    for (const double v : sorted) {
        if (axis.points.empty() || v > axis.points.back() + tolerance) {
            axis.points.push_back(v);
        }
    }
    for (auto& x : points.x) {
        const auto next = std::upper_bound(axis.points.begin(), axis.points.end(), x[k] + tolerance);
        x[k] = *(next - 1);
    }
    axis.upper = axis.points.back();
}

[[noreturn]] void refuse_repeat(const SetPoints& points, std::size_t a, std::size_t b) {
    const bool errors = points.has_sigma();
    throw InputError(
        "duplicate",
        "the set point " + describe(points.table, points.axes, points.x[a]) + " occurs twice with " + points.quantity +
            " " + in_written_unit(points.table, points.quantity, points.value[a]) +
            (points.table.line_of_row(a) > 0 ? " (line " + std::to_string(points.table.line_of_row(a)) + ")" : "") +
            " and " + in_written_unit(points.table, points.quantity, points.value[b]),
        points.table.place(b, points.quantity),
        !misnamed_columns(points.table, points.quantity).empty() ? misnamed_columns(points.table, points.quantity)
        : errors
            ? "they differ by more than four times their errors: is a column missing that tells them "
              "apart? Select rows"
            : "select rows by a column that tells them apart, or state the error in '" + points.quantity + "_sigma'");
}

/// Repeats of a set point become one point: the mean weighted by 1/sigma^2. They must agree within their errors.
void merge_repeats(SetPoints& points) {
    std::vector<std::size_t> order(points.x.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return points.x[a] < points.x[b]; });
    const bool errors = points.has_sigma();
    double size = 0;
    for (const double v : points.value) {
        size = std::max(size, std::abs(v));
    }
    SetPoints merged;
    std::size_t repeats = 0;
    core::Place first_repeat;
    for (std::size_t begin = 0; begin < order.size();) {
        std::size_t end = begin + 1;
        while (end < order.size() && points.x[order[end]] == points.x[order[begin]]) {
            ++end;
        }
        double weight = 0;
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const double s = errors ? points.sigma[order[i]] : 1;
            weight += 1 / (s * s);
            sum += points.value[order[i]] / (s * s);
        }
        for (std::size_t i = begin + 1; i < end; ++i) {
            const std::size_t a = order[begin];
            const std::size_t b = order[i];
            const double difference = std::abs(points.value[a] - points.value[b]);
            const double allowed = errors ? 4 * std::hypot(points.sigma[a], points.sigma[b]) : same_point * size;
            if (difference > allowed) {
                refuse_repeat(points, a, b);
            }
            if (repeats++ == 0) {
                first_repeat = points.table.place(b, points.quantity);
            }
        }
        merged.x.push_back(points.x[order[begin]]);
        merged.value.push_back(end - begin == 1 ? points.value[order[begin]] : sum / weight);
        merged.row.push_back(order[begin]);
        if (errors) {
            merged.sigma.push_back(end - begin == 1 ? points.sigma[order[begin]] : 1 / std::sqrt(weight));
        }
        begin = end;
    }
    if (repeats > 0) {
        points.remarks.push_back(note(
            std::to_string(repeats) + (repeats == 1 ? " repeated set point agrees" : " repeated set points agree") +
                (errors ? " within the errors" : "") + (repeats == 1 ? " and is merged" : " and are merged"),
            first_repeat));
    }
    points.x = std::move(merged.x);
    points.value = std::move(merged.value);
    points.sigma = std::move(merged.sigma);
    points.row = std::move(merged.row);
}

/// Points are sorted by now, so a full grid lies in grid order.
void find_grid(SetPoints& points) {
    std::size_t product = 1;
    for (const auto& axis : points.axes) {
        product *= axis.points.size();
        if (product > 100 * points.x.size()) {
            return;
        }
    }
    points.full_grid = product == points.x.size();
    if (points.full_grid) {
        points.order.resize(product);
        std::iota(points.order.begin(), points.order.end(), std::size_t{0});
        return;
    }
    // Nearly a grid: the user will want to know what lacks.
    if (points.axes.size() > 1 && points.x.size() * 10 >= product * 6) {
        const std::set<std::vector<double>> known(points.x.begin(), points.x.end());
        std::string missing;
        std::size_t named = 0;
        for (std::size_t i = 0; i < product && named < 4; ++i) {
            std::vector<double> x(points.axes.size());
            std::size_t rest = i;
            for (std::size_t k = points.axes.size(); k-- > 0;) {
                x[k] = points.axes[k].points[rest % points.axes[k].points.size()];
                rest /= points.axes[k].points.size();
            }
            if (!known.contains(x)) {
                missing += (named++ == 0 ? "(" : "; (") + describe(points.table, points.axes, x) + ")";
            }
        }
        const std::size_t lacking = product - points.x.size();
        points.missing = "the grid lacks " + std::to_string(lacking) + " of " + std::to_string(product) +
                         " set points: " + missing + (lacking > named ? " ..." : "");
        points.remarks.push_back(warning(points.missing, {points.table.source, {}, {}, {}}));
    }
}

void find_constants(SetPoints& points) {
    for (const auto& column : points.table.columns()) {
        const auto& names = axis_names();
        if (column.is_text() || std::find(names.begin(), names.end(), column.name) == names.end()) {
            continue;
        }
        const Spread spread = spread_of(column.numbers);
        if (spread.distinct == 1) {
            points.constants.emplace_back(column.name, spread.lower);
        }
    }
}

}  // namespace

std::string described(const SetPoints& points, std::size_t point) {
    return describe(points.table, points.axes, points.x[point]);
}

const std::vector<std::string>& axis_names() {
    static const std::vector<std::string> names = {
        "gap",         "pitch",       "speed", "jet_voltage",        "jet_flow",   "heave_velocity",
        "input_force", "temperature", "depth", "approach_direction", "pitch_rate", "time"};
    return names;
}

namespace {

void check_policies(const RangePolicies& policies, const std::vector<std::string>& axes, const std::string& source) {
    for (const auto& [name, policy] : policies.named) {
        if (std::find(axes.begin(), axes.end(), name) == axes.end()) {
            throw core::UsageError("axis", "the table has no axis '" + name + "' to " + to_string(policy),
                                   {source, {}, {}, {}}, core::did_you_mean(name, axes));
        }
    }
}

/// No body is below the ground; a gap that counts from elsewhere than the base is, and a sign turned.
void doubt_negative_gaps(SetPoints& points) {
    const core::Column* gap = points.table.find("gap");
    if (gap == nullptr || gap->is_text()) {
        return;
    }
    std::size_t below = 0, first = 0;
    for (std::size_t i = gap->numbers.size(); i-- > 0;) {
        if (gap->numbers[i] < 0) {
            ++below;
            first = i;
        }
    }
    if (below > 0) {
        points.remarks.push_back(warning(
            core::counted_of(below, points.table.rows(), "point", "is", "are") + " at a gap below 0" +
                (below > 1 ? ", the first at " : ", ") + in_written_unit(points.table, "gap", gap->numbers[first]) +
                ": there the base is below the ground; a sign that is turned, or a gap that is not that of the "
                "base?",
            points.table.place(first, "gap")));
    }
}

/// Axes and coordinates of the points.
void take_axes(SetPoints& points, const std::vector<std::string>& names, const AxisOptions& options) {
    points.x.assign(points.table.rows(), std::vector<double>(names.size()));
    for (std::size_t k = 0; k < names.size(); ++k) {
        const auto& values = points.table.numbers(names[k]);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!std::isfinite(values[i])) {
                throw InputError("missing", "axis '" + names[k] + "' has no value here",
                                 points.table.place(i, names[k]));
            }
            points.x[i][k] = values[i];
        }
        points.axes.push_back({names[k], points.table.find(names[k])->unit, 0, 0, {}, options.range.of(names[k])});
    }
}

}  // namespace

SetPoints set_points(const core::Table& table, const std::string& quantity, const AxisOptions& options) {
    SetPoints points;
    points.quantity = quantity;
    points.table = usable_rows(table, quantity, points.remarks);
    points.unit = points.table.find(quantity)->unit;
    if (points.table.rows() < 2) {
        throw InputError("few", "the table has one point only; a table needs at least two",
                         points.table.place(0, quantity));
    }
    const auto names =
        options.axes.empty() ? found_axes(points.table, quantity) : named_axes(points.table, quantity, options);
    if (names.size() > max_axes) {
        throw InputError("axis", "a table has at most " + std::to_string(max_axes) + " axes",
                         {points.table.source, {}, {}, {}});
    }
    check_policies(options.range, names, points.table.source);
    for (auto& unused : unused_columns(points.table, quantity)) {
        if (std::none_of(names.begin(), names.end(), [&](const auto& name) {
                return unused.message.find("'" + name + "'") != std::string::npos;
            })) {
            points.remarks.push_back(std::move(unused));
        }
    }
    for (const std::string& comment : table.comments) {
        if (comment.starts_with(warning_comment)) {
            points.remarks.push_back({core::Problem::Severity::warning,
                                      comment.substr(warning_comment.size()),
                                      {points.table.source, {}, {}, {}}});
        }
    }
    for (auto& unsettled : unsettled_points(points.table)) {
        points.remarks.push_back(std::move(unsettled));
    }
    doubt_negative_gaps(points);
    take_axes(points, names, options);
    points.value = points.table.numbers(quantity);
    read_sigma(points);
    for (std::size_t k = 0; k < names.size(); ++k) {
        snap_axis(points, k);
    }
    merge_repeats(points);
    find_grid(points);
    find_constants(points);
    return points;
}

}  // namespace underbody::tables
