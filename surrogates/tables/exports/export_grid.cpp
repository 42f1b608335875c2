#include "surrogates/tables/exports/export_grid.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "core/hash.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/force_table_impl.h"
#include "surrogates/tables/hull.h"
#include "surrogates/tables/line.h"
#include "surrogates/tables/select.h"

namespace underbody::tables {

namespace {

struct Turned {
    const char* up;
    const char* ned;
    const char* meaning;
};
constexpr Turned turned_quantities[] = {
    {"lift_force", "z_force", "force along body z, down: z_force = -lift_force"},
    {"drag_force", "x_force", "force along body x, forward: x_force = -drag_force"},
    {"side_force", "y_force", "force along body y, to starboard"},
};
constexpr Turned turned_axes[] = {
    {"heave_velocity", "heave_velocity_down", ""},
    {"input_force", "input_force_down", ""},
};

std::vector<std::vector<double>> chosen_points(const ForceTable& table, const CubicGrid& surface, const ExportOptions& options) {
    auto points = surface.points();
    for (const auto& [name, count] : options.points) {
        const std::size_t k = axis_index(table, name);
        if (count < 2 || count > 100000) {
            throw core::UsageError("range", "axis '" + name + "' needs 2 to 100000 points, not " + std::to_string(count));
        }
        const double low = points[k].front();
        const double high = points[k].back();
        points[k].resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            points[k][i] = i + 1 == count ? high : low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1);
        }
    }
    return points;
}

/// Of the points: a grid may reach far beyond the forces that were measured, where no points are.
double range_of_points(const ForceTable::Impl& table) {
    const auto& values = table.points.numbers(table.quantity);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
}

/// The error at the nodes of another grid; cell errors stay with the cells they came from.
ErrorModel resampled_error(const ErrorModel& error, const CubicGrid& to) {
    const std::size_t n = to.dimensions();
    auto points = to.points();
    std::vector<double> sigma(to.nodes());
    double at[CubicGrid::max_axes];
    for (std::size_t node = 0; node < sigma.size(); ++node) {
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            at[k] = points[k][rest % points[k].size()];
            rest /= points[k].size();
        }
        sigma[node] = error.sigma(at, nullptr);
    }
    ErrorModel result(points, std::move(sigma));
    for (std::size_t k = 0; k < n; ++k) {
        result.set_growth(k, error.growth(k));
        const auto& old_cells = error.cell_error(k);
        if (old_cells.empty()) {
            continue;
        }
        const auto& old_points = error.axes()[k].points();
        std::vector<double> cells(points[k].size() - 1, 0.0);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            for (std::size_t j = 0; j < old_cells.size(); ++j) {
                if (old_points[j] < points[k][i + 1] && old_points[j + 1] > points[k][i]) {
                    cells[i] = std::max(cells[i], old_cells[j]);
                }
            }
        }
        result.set_cell_error(k, std::move(cells));
    }
    return result;
}

ErrorModel mirrored_error(const ErrorModel& error, const CubicGrid& to, unsigned mirrored) {
    if (mirrored == 0) {
        return error;
    }
    std::vector<double> hermite(error.node_sigma().size() << to.dimensions(), 0.0);
    std::vector<std::vector<double>> before;
    for (const auto& axis : error.axes()) {
        before.push_back(axis.points());
    }
    for (std::size_t i = 0; i < error.node_sigma().size(); ++i) {
        hermite[i << to.dimensions()] = error.node_sigma()[i];
    }
    const CubicGrid carrier = CubicGrid(std::move(before), std::move(hermite)).transformed(1, mirrored);
    std::vector<double> sigma(carrier.nodes());
    for (std::size_t i = 0; i < sigma.size(); ++i) {
        sigma[i] = carrier.hermite()[i << to.dimensions()];
    }
    ErrorModel result(carrier.points(), std::move(sigma));
    for (std::size_t k = 0; k < to.dimensions(); ++k) {
        const auto& growth = error.growth(k);
        result.set_growth(k, (mirrored >> k & 1) != 0 ? ErrorModel::Growth{growth[1], growth[0]} : growth);
        auto cells = error.cell_error(k);
        if (!cells.empty()) {
            if ((mirrored >> k & 1) != 0) {
                std::reverse(cells.begin(), cells.end());
            }
            result.set_cell_error(k, std::move(cells));
        }
    }
    return result;
}

/// Columns of one value that are neither axes nor conditions nor forces: the mass and the size of the body, the variant, the mesh ...
std::vector<std::string> other_constants(const ForceTable& table) {
    std::vector<std::string> lines;
    const core::Table& points = table.points();
    const auto forces = force_columns(points);
    for (const auto& column : points.columns()) {
        const bool axis = std::any_of(table.axes().begin(), table.axes().end(), [&](const TableAxis& a) { return a.name == column.name; });
        const bool condition = std::any_of(table.conditions().begin(), table.conditions().end(), [&](const auto& c) { return c.first == column.name; });
        const bool force = std::find(forces.begin(), forces.end(), column.name) != forces.end() || column.name.ends_with("_sigma") || column.name.starts_with(table.quantity());
        if (axis || condition || force || points.rows() == 0) {
            continue;
        }
        if (column.is_text()) {
            const auto& text = column.text;
            if (std::all_of(text.begin(), text.end(), [&](const std::string& t) { return t == text.front(); }) && !text.front().empty()) {
                lines.push_back("Of " + column.name + " " + text.front());
            }
        } else if (std::all_of(column.numbers.begin(), column.numbers.end(), [&](double v) { return v == column.numbers.front(); })) {
            lines.push_back("Of " + column.name + " = " + core::format_number(column.numbers.front(), 9) + (column.unit == "1" ? "" : " " + column.unit));
        }
    }
    return lines;
}

void write_origin(ExportGrid& grid, const ForceTable& table, const ExportOptions& options) {
    auto& lines = grid.origin;
    lines.push_back("Force table by Underbody: " + grid.quantity + " [" + grid.unit + "]" + (grid.meaning.empty() ? "" : ", " + grid.meaning));
    std::string source = "Made from " + (table.source().empty() ? std::string("points in memory") : table.source());
    std::error_code ignored;
    if (!table.source().empty() && std::filesystem::is_regular_file(table.source(), ignored)) {
        source += " (content " + core::content_hash_of_file(table.source()) + ")";
    }
    lines.push_back(source + ": " + std::to_string(table.points().rows()) + " points, fitted as " + table.kind());
    for (const auto& axis : grid.axes) {
        lines.push_back("Axis " + axis.name + " [" + axis.unit + "]: " + core::format_number(axis.points.front(), 9) + " to " +
                        core::format_number(axis.points.back(), 9) + ", " + std::to_string(axis.points.size()) + " points");
    }
    for (const auto& [name, value] : grid.conditions) {
        const auto* known = core::find_quantity(name);
        lines.push_back("Holds for " + name + " = " + core::format_number(value, 9) + (known != nullptr ? " " + known->unit : ""));
    }
    for (const auto& line : other_constants(table)) {
        lines.push_back(line);
    }
    if (!grid.hull.empty()) {
        lines.push_back("The points do not fill the box of the axes: where none lie around, the value is an extrapolation, and sigma says how far to trust it");
    }
    lines.push_back(options.frame == Frame::ned ? "Frame: body axes, x forward, y starboard, z down (NED); pitch and pitch_moment nose up"
                                                : "Frame: lift positive up, drag positive against the motion; pitch and pitch_moment nose up");
    if (grid.thinning_error > 0) {
        lines.push_back("Differs from the full table by at most " + core::format_number(grid.thinning_error, 3) + " " + grid.unit);
    }
    lines.push_back("sigma is one standard deviation: errors of the points and of the fit between them; 0 where none are known");
}

}  // namespace

std::string identifier(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 128;
        result += plain ? c : '_';
    }
    if (result.empty() || std::isdigit(static_cast<unsigned char>(result.front())) != 0) {
        result.insert(result.begin(), 't');
    }
    return result;
}

namespace {

/// Differences are sampled, between the samples they may be a little larger.
constexpr double margin = 1.02;

std::size_t most_points(std::size_t axes, bool asked) {
    const std::size_t most[] = {asked ? 20000u : 400u, asked ? 1000u : 60u, asked ? 100u : 20u};
    return most[std::min<std::size_t>(axes, 3) - 1];
}

/// Points for straight lines between them.
std::vector<std::vector<double>> straight_points(const ForceTable::Impl& full, const CubicGrid& surface, const ExportOptions& options, double allowed,
                                                 core::Progress& progress) {
    const std::size_t most = most_points(surface.dimensions(), options.max_error > 0);
    if (options.max_error <= 0) {
        return points_for_straight_lines(surface, 1e-3 * range_of_points(full), most, progress);
    }
    auto points = thinned_for_straight_lines(surface, allowed, most, progress);
    if (const double reached = largest_straight_difference(surface, points); reached > allowed) {
        throw core::UsageError("range",
                               "straight lines between the points, as this format draws them, stay within " + core::format_number(reached, 3) + " " + full.unit +
                                   " of the table on at most " + std::to_string(most) + " points an axis, not within " + core::format_number(allowed, 3) + " " + full.unit,
                               {}, "allow a larger error, or take a format with cubics, such as c, json or fmu");
    }
    return points;
}

/// The function on the points that the options ask for.
CubicGrid chosen_surface(const ForceTable& table, const ExportOptions& options, bool straight, ExportGrid& grid, core::Progress& progress) {
    const ForceTable::Impl& full = table.impl();
    CubicGrid surface = full.surface;
    if (!options.points.empty()) {
        surface = surface.resampled(chosen_points(table, surface, options));
    }
    const double asked = options.max_error * range_of_points(full);
    const double spent = options.points.empty() ? 0 : margin * largest_difference(full.surface, surface);
    if (options.max_error > 0 && spent >= asked) {
        grid.remarks.push_back({core::Problem::Severity::warning,
                                "the points asked for are too few for the error asked for: they alone differ from the table by up to " +
                                    core::format_number(spent, 3) + " " + full.unit,
                                {}});
        return surface;
    }
    const double allowed = (asked - spent) / margin;
    if (straight && (options.points.empty() || options.max_error > 0)) {
        return surface.resampled(straight_points(full, surface, options, allowed, progress));
    }
    return options.max_error > 0 ? surface.resampled(thinned_points(surface, allowed, progress)) : surface;
}

/// With straight lines between the nodes never less than the error at the nodes and half way to their neighbours.
ErrorModel straight_error(const ErrorModel& error, const CubicGrid& to) {
    const std::size_t n = to.dimensions();
    auto points = to.points();
    std::vector<double> sigma(to.nodes());
    for (std::size_t node = 0; node < sigma.size(); ++node) {
        double at[CubicGrid::max_axes];
        std::size_t index[CubicGrid::max_axes];
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            index[k] = rest % points[k].size();
            at[k] = points[k][index[k]];
            rest /= points[k].size();
        }
        sigma[node] = error.sigma(at, nullptr);
        for (std::size_t k = 0; k < n; ++k) {
            const double here = at[k];
            for (const std::size_t next : {index[k] - 1, index[k] + 1}) {  // below the first: wraps to a large number
                if (next < points[k].size()) {
                    at[k] = 0.5 * (here + points[k][next]);
                    sigma[node] = std::max(sigma[node], error.sigma(at, nullptr));
                }
            }
            at[k] = here;
        }
    }
    ErrorModel result(std::move(points), std::move(sigma));
    for (std::size_t k = 0; k < n; ++k) {
        result.set_growth(k, error.growth(k));
    }
    return result;
}

}  // namespace

ExportGrid export_grid(const ForceTable& table, const ExportOptions& options, bool straight, core::Progress& progress) {
    if (!(options.max_error >= 0) || options.max_error >= 1) {
        throw core::UsageError("range", "the largest error is a share of the force's range between 0 and 1, such as 0.5%");
    }
    const ForceTable::Impl& full = table.impl();
    ExportGrid grid;
    grid.single_precision = options.single_precision;
    grid.quantity = full.quantity;
    grid.unit = full.unit;
    if (const auto* known = core::find_quantity(full.quantity)) {
        grid.meaning = known->meaning;
    }
    CubicGrid surface = chosen_surface(table, options, straight, grid, progress);
    const bool same = !straight && surface.points() == full.surface.points();
    grid.thinning_error = same ? 0 : margin * (straight ? largest_straight_difference(full.surface, surface.points()) : largest_difference(full.surface, surface));
    ErrorModel error = same ? full.error : straight ? straight_error(full.error, surface) : resampled_error(full.error, surface);
    // Thinning moves the value by up to thinning_error: the error says so everywhere between the points.
    if (!same && !error.empty()) {
        std::vector<double> cells = error.cell_error(0).empty() ? std::vector<double>(surface.axis(0).size() - 1, 0.0) : error.cell_error(0);
        for (double& c : cells) {
            c += grid.thinning_error;
        }
        error.set_cell_error(0, std::move(cells));
    }
    unsigned mirrored = 0;
    double factor = 1;
    std::vector<std::string> names;
    for (const auto& axis : full.axes) {
        names.push_back(axis.name);
    }
    if (options.frame == Frame::ned) {
        for (const auto& t : turned_quantities) {
            if (grid.quantity == t.up) {
                factor = t.ned == std::string("y_force") ? 1 : -1;
                grid.quantity = t.ned;
                grid.meaning = t.meaning;
                break;
            }
        }
        for (std::size_t k = 0; k < names.size(); ++k) {
            for (const auto& t : turned_axes) {
                if (names[k] == t.up) {
                    names[k] = t.ned;
                    mirrored |= 1U << k;
                    break;
                }
            }
        }
    }
    grid.surface = factor == 1 && mirrored == 0 ? std::move(surface) : surface.transformed(factor, mirrored);
    grid.error = mirrored_error(error, grid.surface, mirrored);
    for (std::size_t k = 0; k < names.size(); ++k) {
        grid.axes.push_back({names[k], full.axes[k].unit, grid.surface.axis(k).points(), full.axes[k].range});
    }
    for (const auto& [name, value] : table.conditions()) {
        const auto turned = std::find_if(std::begin(turned_axes), std::end(turned_axes), [&](const Turned& t) { return name == t.up; });
        const bool turns = options.frame == Frame::ned && turned != std::end(turned_axes);
        grid.conditions.emplace_back(turns ? turned->ned : name, turns ? -value : value);
    }
    if (full.hull) {
        grid.hull = full.hull->points();
        for (auto& point : grid.hull) {
            for (std::size_t k = 0; k < point.size(); ++k) {
                point[k] = (mirrored >> k & 1) != 0 ? -point[k] : point[k];
            }
        }
    }
    grid.name = identifier(options.name.empty() ? grid.quantity : options.name);
    write_origin(grid, table, options);
    return grid;
}

std::vector<std::string> outside_lines(const ExportGrid& grid) {
    std::vector<std::string> lines;
    for (const auto& axis : grid.axes) {
        lines.push_back("Outside the range of " + axis.name + " " +
                        (axis.range == RangePolicy::clamp    ? "it holds its end value with slope zero, and says so"
                         : axis.range == RangePolicy::refuse ? "it refuses: value and slopes are not numbers there"
                                                             : "it goes on along its tangent with growing sigma, and says so"));
    }
    return lines;
}

std::vector<std::string> header_lines(const ExportGrid& grid) {
    auto lines = grid.origin;
    for (auto& line : outside_lines(grid)) {
        lines.push_back(std::move(line));
    }
    return lines;
}

namespace {

/// Corners, middles and quarters of the cells between the lines; fewer a cell for many axes.
template <class Visit>
void for_samples(const std::vector<std::vector<double>>& lines, Visit&& visit) {
    const std::size_t n = lines.size();
    const std::size_t a_cell = n == 1 ? 8 : n == 2 ? 4 : 2;
    std::vector<std::vector<double>> samples(n);
    std::size_t count = 1;
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = lines[k];
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            for (std::size_t j = 0; j < a_cell; ++j) {
                samples[k].push_back(x[i] + (x[i + 1] - x[i]) * static_cast<double>(j) / static_cast<double>(a_cell));
            }
        }
        samples[k].push_back(x.back());
        count *= samples[k].size();
    }
    double at[CubicGrid::max_axes];
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i;
        for (std::size_t k = n; k-- > 0;) {
            at[k] = samples[k][rest % samples[k].size()];
            rest /= samples[k].size();
        }
        visit(at);
    }
}

}  // namespace

double largest_difference(const CubicGrid& fine, const CubicGrid& coarse) {
    double worst = 0;
    for_samples(fine.points(), [&](const double* at) { worst = std::max(worst, std::abs(fine.value(at, nullptr) - coarse.value(at, nullptr))); });
    return worst;
}

double largest_straight_difference(const CubicGrid& fine, const std::vector<std::vector<double>>& points) {
    const std::size_t n = fine.dimensions();
    std::vector<double> values;
    const CubicGrid sampled = fine.resampled(points);
    for (std::size_t i = 0; i < sampled.nodes(); ++i) {
        values.push_back(sampled.hermite()[i << n]);
    }
    const ErrorModel straight(points, std::move(values));  // multilinear between the nodes
    std::vector<std::vector<double>> lines = fine.points();
    for (std::size_t k = 0; k < n; ++k) {
        lines[k].insert(lines[k].end(), points[k].begin(), points[k].end());
        std::sort(lines[k].begin(), lines[k].end());
        lines[k].erase(std::unique(lines[k].begin(), lines[k].end()), lines[k].end());
    }
    double worst = 0;
    for_samples(lines, [&](const double* at) { worst = std::max(worst, std::abs(straight.sigma(at, nullptr) - fine.value(at, nullptr))); });
    return worst;
}

}  // namespace underbody::tables
