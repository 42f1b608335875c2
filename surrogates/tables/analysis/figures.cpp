#include "surrogates/tables/analysis/figures.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "surrogates/tables/fit/table_batch.h"

namespace underbody::tables {

namespace {

core::FigureAxis axis_of(const ForceTable& table, const std::string& quantity) {
    return {quantity, shown_unit(table, quantity), 0, 0, false};
}

core::Conversion to_shown(const ForceTable& table, const std::string& quantity, const std::string& si) {
    return core::conversion(si, shown_unit(table, quantity));
}

std::size_t chosen_axis(const ForceTable& table, const std::string& name) {
    if (!name.empty()) {
        return axis_index(table, name);
    }
    for (std::size_t k = 0; k < table.axes().size(); ++k) {
        if (table.axes()[k].name == "gap") {
            return k;
        }
    }
    return 0;
}

/// A picture needs no exact set point: what is not held takes 0 (pitch) or the middle.
std::vector<double> base_point(const ForceTable& table, const Held& held) {
    Held all = held;
    for (const auto& axis : table.axes()) {
        const bool given = std::any_of(held.begin(), held.end(), [&](const auto& h) { return h.first == axis.name; });
        if (!given) {
            const bool level = axis.name == "pitch" && axis.lower <= 0 && axis.upper >= 0;
            all.emplace_back(axis.name, level ? 0 : 0.5 * (axis.lower + axis.upper));
        }
    }
    return held_point(table, {}, all);
}

bool is_logarithmic(const ForceTable& table, std::size_t axis, const FigureOptions& options) {
    const auto& a = table.axes()[axis];
    return a.lower > 0 && options.logarithmic.value_or(a.name == "gap" && spans_decades(a.lower, a.upper));
}

/// Samples that hold the grid lines, so that no corner is cut.
std::vector<double> samples_of(const ForceTable& table, std::size_t axis, const FigureOptions& options) {
    std::vector<double> x = table.knots(axis).size() <= 200 ? table.knots(axis) : std::vector<double>{};
    const double low = table.axes()[axis].lower;
    const double high = table.axes()[axis].upper;
    const bool log = is_logarithmic(table, axis, options);
    for (int i = 0; i <= options.samples; ++i) {
        const double t = static_cast<double>(i) / options.samples;
        x.push_back(i == options.samples ? high : log ? low * std::pow(high / low, t) : low + (high - low) * t);
    }
    std::sort(x.begin(), x.end());
    x.erase(std::unique(x.begin(), x.end()), x.end());
    return x;
}

/// Points of the table that lie on the line: the other axes within 1e-6 of their range.
core::FigurePoints points_on(const ForceTable& table, std::size_t axis, const std::vector<double>& at) {
    core::FigurePoints found;
    found.name = "points";
    const core::Table& points = table.points();
    const auto& x = points.numbers(table.axes()[axis].name);
    const auto& y = points.numbers(table.quantity());
    const core::Column* sigma = points.find(table.quantity() + "_sigma");
    const auto x_shown = to_shown(table, table.axes()[axis].name, table.axes()[axis].unit);
    const auto y_shown = to_shown(table, table.quantity(), table.unit());
    for (std::size_t i = 0; i < points.rows(); ++i) {
        bool on = true;
        for (std::size_t k = 0; k < at.size() && on; ++k) {
            const auto& a = table.axes()[k];
            on = k == axis || std::abs(points.numbers(a.name)[i] - at[k]) <= 1e-6 * (a.upper - a.lower);
        }
        if (on) {
            found.x.push_back(x_shown(x[i]));
            found.y.push_back(y_shown(y[i]));
            if (sigma != nullptr && !sigma->is_text()) {
                found.y_error.push_back(std::isnan(sigma->numbers[i]) ? 0 : y_shown.scale * sigma->numbers[i]);
            }
        }
    }
    if (std::any_of(found.y_error.begin(), found.y_error.end(), [](double error) { return error > 0; })) {
        found.name = "points +- one standard deviation";
    }
    return found;
}

void add_curve(core::Figure& figure, const ForceTable& table, std::size_t axis, std::vector<double> at,
               const FigureOptions& options, const std::string& name, core::Colour colour, bool band) {
    core::FigureCurve curve;
    curve.name = name;
    curve.colour = colour;
    core::FigureBand error;
    error.name = band ? "95 % band" : "";
    error.colour = colour;
    error.colour.alpha = 50;
    const auto x_shown = to_shown(table, table.axes()[axis].name, table.axes()[axis].unit);
    const auto y_shown = to_shown(table, table.quantity(), table.unit());
    double widest = 0;
    for (const double x : samples_of(table, axis, options)) {
        at[axis] = x;
        const double value = table.value_by_policy(at.data(), nullptr, 1U << axis);
        const double sigma = table.sigma(at.data());
        widest = std::max(widest, sigma);
        curve.x.push_back(x_shown(x));
        curve.y.push_back(y_shown(value));
        error.x.push_back(x_shown(x));
        error.lower.push_back(y_shown(value - 2 * sigma));
        error.upper.push_back(y_shown(value + 2 * sigma));
    }
    figure.curves.push_back(std::move(curve));
    if (widest > 0) {
        figure.bands.push_back(std::move(error));
    }
}

void add_curve_with_points(core::Figure& figure, const ForceTable& table, std::size_t axis,
                           const std::vector<double>& at, const FigureOptions& options, const std::string& name,
                           core::Colour colour) {
    add_curve(figure, table, axis, at, options, name, colour, false);
    auto points = points_on(table, axis, at);
    points.name.clear();
    points.colour = colour;
    if (!points.x.empty()) {
        figure.points.push_back(std::move(points));
    }
}

/// Values of the axes that are held: of all but one or two.
std::string described(const ForceTable& table, std::size_t axis, const std::vector<double>& at,
                      std::size_t other = max_axes) {
    std::string text;
    for (std::size_t k = 0; k < at.size(); ++k) {
        if (k != axis && k != other) {
            const auto& a = table.axes()[k];
            text += (text.empty() ? "" : ", ") + a.name + " " +
                    core::format_number(to_shown(table, a.name, a.unit)(at[k]), 4) + " " + shown_unit(table, a.name);
        }
    }
    return text;
}

void add_equilibria(core::Figure& figure, const ForceTable& table, std::size_t axis, const std::vector<double>& at,
                    const FigureOptions& options) {
    EquilibriumOptions wanted = *options.equilibria;
    wanted.axis = table.axes()[axis].name;
    wanted.draws = 0;
    wanted.held.clear();
    for (std::size_t k = 0; k < at.size(); ++k) {
        if (k != axis) {
            wanted.held.emplace_back(table.axes()[k].name, at[k]);
        }
    }
    const auto found = equilibria(table, wanted);
    const double level = wanted.net_weight / wanted.scale;
    const auto x_shown = to_shown(table, table.axes()[axis].name, table.axes()[axis].unit);
    const auto y_shown = to_shown(table, table.quantity(), table.unit());
    core::FigureLine line;
    line.at = y_shown(level);
    line.label = "net weight";
    figure.lines.push_back(line);
    for (const auto kind : {Stability::stable, Stability::unstable, Stability::marginal}) {
        core::FigurePoints marks;
        marks.name = to_string(kind);
        marks.shape = kind == Stability::stable     ? core::FigurePoints::Shape::disc
                      : kind == Stability::unstable ? core::FigurePoints::Shape::circle
                                                    : core::FigurePoints::Shape::diamond;
        marks.colour = core::palette(kind == Stability::stable ? 2 : kind == Stability::unstable ? 5 : 0);
        marks.size = 11;
        for (const double gap : found.gaps(kind)) {
            marks.x.push_back(x_shown(gap));
            marks.y.push_back(line.at);
        }
        if (!marks.x.empty()) {
            figure.points.push_back(std::move(marks));
        }
    }
}

std::string caption_of(const ForceTable& table) {
    std::string text = table.kind() + " of " + core::counted(table.points().rows(), "point");
    if (!table.source().empty()) {
        text += " of " + table.source();
    }
    for (const auto& [name, value] : table.conditions()) {
        text += ", " + core::told_condition(name, value, 4);
    }
    return text + ".";
}

}  // namespace

std::string unit_per(const std::string& unit, const std::string& of) {
    return unit + "/" + (of.find_first_of("/ ") == std::string::npos ? of : "(" + of + ")");
}

core::Figure curve_figure(const ForceTable& table, const FigureOptions& options) {
    const std::size_t axis = chosen_axis(table, options.axis);
    const auto at = base_point(table, options.held);
    core::Figure figure;
    figure.x = axis_of(table, table.axes()[axis].name);
    figure.x.logarithmic = is_logarithmic(table, axis, options);
    figure.y = axis_of(table, table.quantity());
    figure.title = options.title.empty() ? table.quantity() + " against " + table.axes()[axis].name : options.title;
    const std::string held = described(table, axis, at);
    figure.title += held.empty() ? "" : " at " + held;
    figure.caption = caption_of(table) + (held.empty() ? "" : " At " + held + ".");
    add_curve(figure, table, axis, at, options, table.kind(), core::palette(0), true);
    auto points = points_on(table, axis, at);
    if (!points.x.empty() && points.x.size() <= 2000) {
        points.colour = {40, 40, 40, 255};
        figure.points.push_back(std::move(points));
    }
    if (options.equilibria) {
        add_equilibria(figure, table, axis, at, options);
    }
    return figure;
}

core::Figure family_figure(const ForceTable& table, const std::string& axis_name, const std::string& family,
                           const FigureOptions& options) {
    const std::size_t axis = axis_index(table, axis_name);
    const std::size_t other = axis_index(table, family);
    auto at = base_point(table, options.held);
    core::Figure figure;
    figure.x = axis_of(table, axis_name);
    figure.x.logarithmic = is_logarithmic(table, axis, options);
    figure.y = axis_of(table, table.quantity());
    figure.title = options.title.empty() ? table.quantity() + " against " + axis_name : options.title;
    figure.caption = caption_of(table);
    const auto& values = table.axes()[other].points;
    const std::size_t step = (values.size() + 8) / 9;
    const auto shown = to_shown(table, family, table.axes()[other].unit);
    std::size_t colour = 0;
    for (std::size_t i = 0; i < values.size(); i += step) {
        at[other] = values[i];
        const std::string name =
            family + " " + core::format_number(shown(values[i]), 4) + " " + shown_unit(table, family);
        add_curve_with_points(figure, table, axis, at, options, name, core::palette(colour++));
    }
    return figure;
}

namespace {

/// Fills a map of a table over two axes; what lies outside the points is left blank. Whether anything is blank.
bool fill(core::FigureMap& map, const ForceTable& table, std::size_t kx, std::size_t ky, std::vector<double> at) {
    const auto &ax = table.axes()[kx], &ay = table.axes()[ky];
    const auto v_shown = to_shown(table, table.quantity(), table.unit());
    const auto middle_of = [](std::size_t cell, std::size_t cells, double lower, double upper, bool by_ratio) {
        const double part = (static_cast<double>(cell) + 0.5) / static_cast<double>(cells);
        return by_ratio ? lower * std::pow(upper / lower, part) : lower + (upper - lower) * part;
    };
    double low = INFINITY;
    double high = -INFINITY;
    bool blank = false;
    for (std::size_t j = 0; j < map.rows; ++j) {
        at[ky] = middle_of(j, map.rows, ay.lower, ay.upper, map.y_by_ratio);
        for (std::size_t i = 0; i < map.columns; ++i) {
            at[kx] = middle_of(i, map.columns, ax.lower, ax.upper, map.x_by_ratio);
            if (beyond_points(table, at.data()) > 0.02) {
                map.values.push_back(std::nan(""));
                blank = true;
                continue;
            }
            map.values.push_back(v_shown(table.value_by_policy(at.data(), nullptr, 1U << kx | 1U << ky)));
            low = std::min(low, map.values.back());
            high = std::max(high, map.values.back());
        }
    }
    map.diverging = low < 0 && high > 0;
    return blank;
}

/// The points of the table, unless they are too many to see anything else.
template <class Shown>
void add_points(core::Figure& figure, const ForceTable& table, const std::string& x_axis, const std::string& y_axis,
                const Shown& x_shown, const Shown& y_shown) {
    core::FigurePoints points;
    points.name = "points";
    points.shape = core::FigurePoints::Shape::circle;
    points.colour = {40, 40, 40, 200};
    points.size = 5;
    const auto& px = table.points().numbers(x_axis);
    const auto& py = table.points().numbers(y_axis);
    for (std::size_t i = 0; i < px.size() && px.size() <= 2000; ++i) {
        points.x.push_back(x_shown(px[i]));
        points.y.push_back(y_shown(py[i]));
    }
    if (!points.x.empty()) {
        figure.points.push_back(std::move(points));
    }
}

}  // namespace

core::Figure map_figure(const ForceTable& table, const std::string& x_axis, const std::string& y_axis,
                        const FigureOptions& options) {
    const std::size_t kx = axis_index(table, x_axis);
    const std::size_t ky = axis_index(table, y_axis);
    const auto at = base_point(table, options.held);
    const auto& ax = table.axes()[kx];
    const auto& ay = table.axes()[ky];
    const auto x_shown = to_shown(table, ax.name, ax.unit);
    const auto y_shown = to_shown(table, ay.name, ay.unit);
    core::Figure figure;
    figure.x = axis_of(table, ax.name);
    figure.y = axis_of(table, ay.name);
    figure.title = options.title.empty() ? table.quantity() + " over " + ax.name + " and " + ay.name : options.title;
    const std::string held = described(table, kx, at, ky);
    figure.title += held.empty() ? "" : " at " + held;
    figure.caption = caption_of(table) + (held.empty() ? "" : " At " + held + ".");
    core::FigureMap map;
    map.columns = map.rows = static_cast<std::size_t>(std::clamp(options.samples / 2, 20, 400));
    // Along a logarithmic axis cells of one ratio look alike on the picture.
    figure.x.logarithmic = map.x_by_ratio = is_logarithmic(table, kx, options);
    figure.y.logarithmic = map.y_by_ratio = is_logarithmic(table, ky, options);
    map.columns *= map.x_by_ratio ? 2 : 1;
    map.rows *= map.y_by_ratio ? 2 : 1;
    map.x_lower = x_shown(ax.lower);
    map.x_upper = x_shown(ax.upper);
    map.y_lower = y_shown(ay.lower);
    map.y_upper = y_shown(ay.upper);
    map.label = table.quantity();
    map.unit = shown_unit(table, table.quantity());
    const bool blank = fill(map, table, kx, ky, at);
    if (blank) {
        figure.caption += " Blank: outside the points, where the table only extrapolates.";
        figure.title += " (blank: outside the points)";
    }
    figure.maps.push_back(std::move(map));
    add_points(figure, table, ax.name, ay.name, x_shown, y_shown);
    return figure;
}

namespace {

/// A wide band of one table would flatten the curves of all: the axis shows them, and of the bands as much again.
void keep_curves_in_view(core::Figure& figure) {
    double low = INFINITY, high = -INFINITY, band_low = INFINITY, band_high = -INFINITY;
    for (const auto& curve : figure.curves) {
        for (const double y : curve.y) {
            low = std::min(low, y);
            high = std::max(high, y);
        }
    }
    for (const auto& band : figure.bands) {
        for (const double y : band.lower) {
            band_low = std::min(band_low, y);
        }
        for (const double y : band.upper) {
            band_high = std::max(band_high, y);
        }
    }
    for (const auto& points : figure.points) {
        for (const double y : points.y) {
            low = std::min(low, y);
            high = std::max(high, y);
        }
    }
    const double size = high - low;
    if (size > 0 && std::isfinite(size) && (band_low < low - size / 2 || band_high > high + size / 2)) {
        figure.y.lower = std::max(band_low, low - size / 2);
        figure.y.upper = std::min(band_high, high + size / 2);
        figure.caption += " Bands that are wider than the picture are cut.";
    }
}

}  // namespace

core::Figure comparison_figure(const std::vector<std::pair<std::string, ForceTable>>& tables,
                               const FigureOptions& options) {
    core::Figure figure;
    std::size_t colour = 0;
    for (const auto& [name, table] : tables) {
        const std::size_t axis = chosen_axis(table, options.axis);
        const auto at = base_point(table, options.held);
        if (colour == 0) {
            figure.x = axis_of(table, table.axes()[axis].name);
            figure.x.logarithmic =
                std::all_of(tables.begin(), tables.end(),
                            [&](const auto& each) {
                                return each.second.axes()[chosen_axis(each.second, options.axis)].lower > 0;
                            }) &&
                is_logarithmic(table, axis, options);
            figure.y = axis_of(table, table.quantity());
            figure.title = options.title.empty() ? table.quantity() + " of " + std::to_string(tables.size()) + " tables"
                                                 : options.title;
            figure.caption = "Bands: two standard deviations.";
        }
        add_curve_with_points(figure, table, axis, at, options, name, core::palette(colour++));
    }
    keep_curves_in_view(figure);
    return figure;
}

core::Figure figure(const ForceTable& table, const FigureOptions& options) {
    if (table.axes().size() == 1 || options.equilibria || !options.axis.empty()) {
        return curve_figure(table, options);
    }
    return map_figure(table, table.axes()[0].name, table.axes()[1].name, options);
}

}  // namespace underbody::tables
