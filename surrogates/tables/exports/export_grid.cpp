#include "surrogates/tables/exports/export_grid.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "core/hash.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/fit/exact_points.h"
#include "surrogates/tables/fit/force_table_impl.h"
#include "surrogates/tables/fit/hull.h"
#include "surrogates/tables/fit/line.h"
#include "surrogates/tables/points/select.h"
#include "surrogates/tables/points/settled.h"

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

std::vector<std::vector<double>> chosen_points(const ForceTable& table, const CubicGrid& surface,
                                               const ExportOptions& options) {
    auto points = surface.points();
    for (const auto& [name, count] : options.points) {
        const std::size_t k = axis_index(table, name);
        if (count < 2 || count > 100000) {
            throw core::UsageError("range",
                                   "axis '" + name + "' needs 2 to 100000 points, not " + std::to_string(count));
        }
        const double low = points[k].front();
        const double high = points[k].back();
        points[k].resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            points[k][i] =
                i + 1 == count ? high : low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1);
        }
    }
    return points;
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

/// Columns of one value that are neither axes nor conditions nor forces: the mass and the size of the body, the
/// variant, the mesh ...
std::vector<std::string> other_constants(const ForceTable& table) {
    std::vector<std::string> lines;
    const core::Table& points = table.points();
    const auto forces = force_columns(points);
    for (const auto& column : points.columns()) {
        const bool axis = std::any_of(table.axes().begin(), table.axes().end(),
                                      [&](const TableAxis& a) { return a.name == column.name; });
        const bool condition = std::any_of(table.conditions().begin(), table.conditions().end(),
                                           [&](const auto& c) { return c.first == column.name; });
        const bool force = std::find(forces.begin(), forces.end(), column.name) != forces.end() ||
                           column.name.ends_with("_sigma") || column.name.starts_with(table.quantity());
        if (axis || condition || force || points.rows() == 0 || column.name == "settled") {
            continue;
        }
        if (column.is_text()) {
            const auto& text = column.text;
            if (std::all_of(text.begin(), text.end(), [&](const std::string& t) { return t == text.front(); }) &&
                !text.front().empty()) {
                lines.push_back("Of " + column.name + " " + text.front());
            }
        } else if (std::all_of(column.numbers.begin(), column.numbers.end(),
                               [&](double v) { return v == column.numbers.front(); })) {
            lines.push_back("Of " + column.name + " = " + core::format_number(column.numbers.front(), 9) +
                            (column.unit == "1" ? "" : " " + column.unit));
        }
    }
    return lines;
}

std::string made_from(const ForceTable& table) {
    std::string source = "Made from " + (table.source().empty() ? std::string("points in memory") : table.source());
    std::error_code ignored;
    if (!table.source().empty() && std::filesystem::is_regular_file(table.source(), ignored)) {
        source += " (content " + core::content_hash_of_file(table.source()) + ")";
    }
    return source + (table.sampling_error() > 0 || table.kind() == "force of a model"
                         ? ": the forces of this model at a set point"
                         : ": " + std::to_string(table.points().rows()) + " points, fitted as " + table.kind());
}

/// What a file says of one table, and warns of; `first`: of all in the file; `origins`: further lines on where it comes
/// from.
std::vector<std::string> told_of(const ForceTable& table, const ForceTable& first,
                                 const std::vector<std::string>& origins, ExportQuantity& quantity) {
    quantity.told = {"Which was made" + made_from(table).substr(4)};
    for (std::string line : origins) {
        line.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(line.front())));
        quantity.told.push_back("Which holds " + line);
    }
    std::vector<std::string> said = table.impl().told;
    for (auto&& line : other_constants(first)) {
        said.push_back(std::move(line));
    }
    for (auto&& line : settled_lines(table.points())) {
        said.push_back(std::move(line));
    }
    if (std::string line = unstated_errors(table); !line.empty()) {
        line[0] = 'T';
        if (std::find(said.begin(), said.end(), line) == said.end()) {  // an exported table says it already
            said.push_back(std::move(line));
        }
    }
    quantity.told.insert(quantity.told.end(), said.begin(), said.end());
    if (quantity.difference > 0) {
        quantity.told.push_back("It differed from what it was made from by at most " +
                                core::format_number(quantity.difference, 3) + " " + quantity.unit);
    }
    for (const auto& remark : table.remarks()) {
        if (remark.severity != core::Problem::Severity::note) {
            quantity.warnings.push_back(remark.message);
            said.push_back("WARNING: " + remark.message);
        }
    }
    return said;
}

/// The grid, and what it holds for.
void write_axes(ExportGrid& grid) {
    auto& lines = grid.origin;
    for (const auto& axis : grid.axes) {
        lines.push_back("Axis " + axis.name + " [" + axis.unit + "]: " + core::format_number(axis.lower, 9) + " to " +
                        core::format_number(axis.upper, 9) + ", " + std::to_string(axis.points.size()) + " points" +
                        (axis.ends_with_range() ? ""
                                                : " from " + core::format_number(axis.points.front(), 9) + " to " +
                                                      core::format_number(axis.points.back(), 9) +
                                                      ", because some of the tables reach further"));
    }
    for (const auto& [name, value] : grid.conditions) {
        const auto* known = core::find_quantity(name);
        lines.push_back("Holds for " + name + " = " + core::format_number(value, 9) +
                        (known != nullptr ? " " + known->unit : ""));
    }
}

/// How far off the file may be, and what its sigma is.
void write_errors(ExportGrid& grid, const std::vector<ForceTable>& tables) {
    auto& lines = grid.origin;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const auto& q = grid.quantities[i];
        if (q.difference > 0) {
            const std::string what = tables.size() > 1 ? ": " + q.name : "";
            lines.push_back((tables[i].sampling_error() > 0 ? "Differs from the forces of the model by at most "
                                                            : "Differs from the full table by at most ") +
                            core::format_number(q.difference, 3) + " " + q.unit + what);
        }
    }
    const bool thinned =
        std::any_of(grid.quantities.begin(), grid.quantities.end(), [](const auto& q) { return q.difference > 0; });
    lines.push_back(
        std::string("sigma is one standard deviation: errors of the points and of the fit between them; 0 where none "
                    "are known") +
        (thinned ? "; on these lines never less than that of the full table, and more where that changes between them"
                 : ""));
}

void write_origin(ExportGrid& grid, const std::vector<ForceTable>& tables, const ExportOptions& options) {
    auto& lines = grid.origin;
    std::string title = "Force table by Underbody: ";
    for (const auto& q : grid.quantities) {
        title += (&q == &grid.quantities.front() ? "" : "; ") + q.name + " [" + q.unit + "]" +
                 (q.meaning.empty() ? "" : ", " + q.meaning);
    }
    lines.push_back(title);
    std::vector<std::string> sources;
    for (const ForceTable& table : tables) {
        const std::string line = made_from(table);
        if (std::find(sources.begin(), sources.end(), line) == sources.end()) {
            sources.push_back(line);
            lines.push_back(line);
        }
    }
    lines.insert(lines.end(), options.provenance.begin(), options.provenance.end());
    write_axes(grid);
    for (std::size_t i = 0; i < tables.size(); ++i) {
        for (auto& line : told_of(tables[i], tables.front(), options.provenance, grid.quantities[i])) {
            if (std::find(lines.begin(), lines.end(), line) == lines.end()) {
                lines.push_back(std::move(line));
            }
        }
    }
    if (!grid.support.empty()) {
        lines.push_back(
            "The points do not fill the box of the axes: where none lie around, the value is an extrapolation, sigma "
            "says how far to trust it, and no_data is 1");
    }
    lines.push_back(options.frame == Frame::ned
                        ? "Frame: body axes, x forward, y starboard, z down (NED); pitch and pitch_moment nose up"
                        : "Frame: lift positive up, drag positive against the motion; pitch and pitch_moment nose up");
    write_errors(grid, tables);
}

}  // namespace

std::pair<double, double> range_of_points(const ForceTable& table) {
    const auto& values = table.points().numbers(table.quantity());
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {*low, *high};
}

std::string identifier(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 128;
        result += plain ? c : '_';
    }
    if (result.empty() || std::isalpha(static_cast<unsigned char>(result.front())) == 0) {
        result.insert(result.begin(), 't');
    }
    return result;
}

namespace {

std::size_t most_points(std::size_t axes, bool asked) {
    const std::size_t most[] = {asked ? 20000u : 400u, asked ? 1000u : 60u, asked ? 100u : 20u};
    return most[std::min<std::size_t>(axes, 3) - 1];
}

/// For straight lines between the points.
Resampled straight_surface(const ForceTable& table, const CubicGrid& surface, const ExportOptions& options,
                           double allowed, core::Progress& progress) {
    const ForceTable::Impl& full = table.impl();
    const auto [low, high] = range_of_points(table);
    const double range = high - low;
    const std::size_t most = most_points(surface.dimensions(), options.max_error > 0);
    if (options.max_error <= 0) {
        return straight_resampled(full.surface, points_for_straight_lines(surface, 1e-3 * range, most, progress),
                                  progress);
    }
    Resampled thin = thinned_for_straight_lines(full.surface, surface, allowed, most, progress);
    if (thin.difference > allowed) {
        throw core::UsageError("range",
                               "straight lines between the points, as this format draws them, stay within " +
                                   core::format_number(thin.difference, 3) + " " + full.unit +
                                   " of the table on at most " + std::to_string(most) + " points an axis, not within " +
                                   core::format_number(allowed, 3) + " " + full.unit,
                               {}, "allow a larger error, or take a format with cubics, such as c, json or fmu");
    }
    return thin;
}

/// The function on the points that the options ask for.
Resampled chosen_surface(const ForceTable& table, const ExportOptions& options, bool straight, core::Problems& remarks,
                         core::Progress& progress) {
    const ForceTable::Impl& full = table.impl();
    Resampled chosen{full.surface, 0};
    if (!options.points.empty()) {
        auto points = chosen_points(table, full.surface, options);
        chosen = straight && options.max_error <= 0 ? straight_resampled(full.surface, std::move(points), progress)
                                                    : resampled(full.surface, std::move(points), progress);
    }
    if (options.max_error <= 0) {
        return straight && options.points.empty() ? straight_surface(table, chosen.grid, options, 0, progress) : chosen;
    }
    const auto [low, high] = range_of_points(table);
    const double allowed = options.max_error * (high - low);
    if (!options.points.empty() && chosen.difference >= allowed) {
        remarks.push_back({core::Problem::Severity::warning,
                           "the points asked for are too few for the error asked for: their grid is off by " +
                               core::format_number(chosen.difference, 3) + " " + full.unit,
                           {}});
        return straight ? straight_resampled(full.surface, chosen.grid.points(), progress) : chosen;
    }
    return straight ? straight_surface(table, chosen.grid, options, allowed, progress)
                    : thinned(full.surface, chosen.grid, allowed, progress);
}

/// Thinning moves the value: so much more of an error between the lines of each axis. Its parts over the axes make up
/// the whole.
void add_thinning(ErrorModel& error, const CubicGrid& full, const Resampled& thin, core::Progress& progress) {
    const std::size_t n = full.dimensions();
    std::array<double, CubicGrid::max_axes> along{};
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
        along[k] = full.axis(k).points() == thin.grid.axis(k).points()
                       ? 0
                       : largest_difference_along(k, full, thin.grid, progress);
        sum += along[k];
    }
    for (std::size_t k = 0; k < n && sum > 0; ++k) {
        std::vector<double> cells =
            error.cell_error(k).empty() ? std::vector<double>(thin.grid.axis(k).size() - 1, 0.0) : error.cell_error(k);
        for (double& c : cells) {
            c += 1.2 * along[k] *
                 std::max(1.0, thin.difference / sum);  // differences of cubics lean to one side of the parabola
        }
        error.set_cell_error(k, std::move(cells));
    }
}

}  // namespace

namespace {

/// One table on the grid that the options ask for, in the frame of the table.
struct Chosen {
    Resampled surface;
    ErrorModel error;
};

Chosen chosen(const ForceTable& table, const ExportOptions& options, bool straight, core::Problems& remarks,
              core::Progress& progress) {
    const ForceTable::Impl& full = table.impl();
    Resampled surface = chosen_surface(table, options, straight, remarks, progress);
    ErrorModel error = straight ? full.error.straightened(surface.grid.points(), surface.difference)
                                : full.error.resampled(surface.grid.points());
    if (!straight) {
        add_thinning(error, full.surface, surface, progress);
    }
    return {std::move(surface), std::move(error)};
}

/// All on the lines of all.
void bring_together(std::vector<Chosen>& all, const std::vector<ForceTable>& tables) {
    std::vector<std::vector<double>> lines = all.front().surface.grid.points();
    for (std::size_t i = 1; i < all.size(); ++i) {
        const auto points = all[i].surface.grid.points();
        bool same = points.size() == lines.size();
        for (std::size_t k = 0; same && k < lines.size(); ++k) {
            const double span = lines[k].back() - lines[k].front();
            same = tables[i].axes()[k].name == tables[0].axes()[k].name &&
                   std::abs(points[k].front() - lines[k].front()) < 1e-9 * span &&
                   std::abs(points[k].back() - lines[k].back()) < 1e-9 * span;
            std::vector<double> both;
            std::merge(lines[k].begin(), lines[k].end(), points[k].begin(), points[k].end(), std::back_inserter(both));
            std::vector<double> apart{both.front()};
            for (const double x : both) {
                if (x > apart.back() + 1e-9 * span) {
                    apart.push_back(x);
                }
            }
            apart.back() = lines[k].back();
            lines[k] = std::move(apart);
        }
        if (!same) {
            throw core::UsageError("axis",
                                   tables[0].quantity() + " and " + tables[i].quantity() +
                                       " have not the same axes and ranges: they cannot share a grid",
                                   {}, "name the axes and hold the others, or export them one by one");
        }
    }
    for (auto& one : all) {
        if (all.size() > 1 && one.surface.grid.points() != lines) {
            one.surface.grid = one.surface.grid.resampled(lines);
            one.error = one.error.resampled(lines);
        }
    }
}

/// What the frame does to names and signs.
struct Turn {
    std::vector<std::string> axis_names;
    unsigned mirrored = 0;
};

Turn turn_of(const ForceTable& table, Frame frame) {
    Turn turn;
    for (const auto& axis : table.axes()) {
        const auto turned = std::find_if(std::begin(turned_axes), std::end(turned_axes),
                                         [&](const Turned& t) { return axis.name == t.up; });
        const bool turns = frame == Frame::ned && turned != std::end(turned_axes);
        turn.mirrored |= turns ? 1U << turn.axis_names.size() : 0;
        turn.axis_names.push_back(turns ? turned->ned : axis.name);
    }
    return turn;
}

ExportQuantity quantity_of(const ForceTable& table, Chosen chosen, const ExportOptions& options, unsigned mirrored) {
    ExportQuantity quantity{
        table.quantity(), table.unit(), "", {}, {}, {}, {}, chosen.surface.difference + table.sampling_error()};
    if (const auto* known = core::find_quantity(table.quantity())) {
        quantity.meaning = known->meaning;
    }
    double factor = 1;
    for (const auto& t : turned_quantities) {
        if (options.frame == Frame::ned && quantity.name == t.up) {
            factor = t.ned == std::string("y_force") ? 1 : -1;
            quantity.name = t.ned;
            quantity.meaning = t.meaning;
            break;
        }
    }
    quantity.surface = factor == 1 && mirrored == 0 ? std::move(chosen.surface.grid)
                                                    : chosen.surface.grid.transformed(factor, mirrored);
    quantity.error = mirrored_error(chosen.error, quantity.surface, mirrored);
    return quantity;
}

void add_axes(ExportGrid& grid, const std::vector<ForceTable>& tables, const Turn& turn) {
    for (std::size_t k = 0; k < turn.axis_names.size(); ++k) {
        ExportAxis axis{turn.axis_names[k],
                        tables[0].axes()[k].unit,
                        grid.first().surface.axis(k).points(),
                        tables[0].axes()[k].range,
                        -INFINITY,
                        INFINITY};
        for (const ForceTable& table : tables) {
            const TableAxis& own = table.axes()[k];
            const bool turns = (turn.mirrored >> k & 1) != 0;
            axis.lower = std::max(axis.lower, turns ? -own.upper : own.lower);
            axis.upper = std::min(axis.upper, turns ? -own.lower : own.upper);
        }
        grid.axes.push_back(std::move(axis));
    }
}

void add_data_support(ExportGrid& grid, const std::vector<ForceTable>& tables, unsigned mirrored) {
    for (const ForceTable& table : tables) {
        if (const Support* support = table.impl().data_support()) {
            grid.support = grid.support.both(support->mirrored(mirrored));
        }
    }
    if (tables.size() == 1 && tables[0].impl().hull) {
        grid.hull = tables[0].impl().hull->points();
        for (auto& point : grid.hull) {
            for (std::size_t k = 0; k < point.size(); ++k) {
                point[k] = (mirrored >> k & 1) != 0 ? -point[k] : point[k];
            }
        }
    }
}

}  // namespace

ExportGrid export_grid(const std::vector<ForceTable>& tables, const ExportOptions& options, bool straight,
                       core::Progress& progress) {
    if (!(options.max_error >= 0) || options.max_error >= 1) {
        throw core::UsageError("range",
                               "the largest error is a share of the force's range between 0 and 1, such as 0.5%");
    }
    ExportGrid grid;
    grid.name = options.name;
    grid.frame = options.frame;
    grid.lever = options.lever;
    grid.single_precision = options.single_precision;
    grid.fixed_point = options.fixed_point;
    grid.self_test_points = options.self_test ? options.self_test_points : 0;
    std::vector<Chosen> all;
    for (const ForceTable& table : tables) {
        all.push_back(chosen(table, options, straight, grid.remarks, progress));
    }
    bring_together(all, tables);
    const Turn turn = turn_of(tables[0], options.frame);
    for (std::size_t i = 0; i < tables.size(); ++i) {
        grid.quantities.push_back(quantity_of(tables[i], std::move(all[i]), options, turn.mirrored));
    }
    add_axes(grid, tables, turn);
    for (const auto& [name, value] : tables[0].conditions()) {
        const auto turned = std::find_if(std::begin(turned_axes), std::end(turned_axes),
                                         [&n = name](const Turned& t) { return n == t.up; });
        const bool turns = options.frame == Frame::ned && turned != std::end(turned_axes);
        grid.conditions.emplace_back(turns ? turned->ned : name, turns ? -value : value);
    }
    add_data_support(grid, tables, turn.mirrored);
    write_origin(grid, tables, options);
    return grid;
}

std::vector<std::string> outside_lines(const ExportGrid& grid) {
    std::vector<std::string> lines;
    for (const auto& axis : grid.axes) {
        lines.push_back("Outside the range of " + axis.name + " " +
                        (axis.range == RangePolicy::clamp ? "it holds its end value with slope zero, and says so"
                         : axis.range == RangePolicy::refuse
                             ? "it refuses: value and slopes are not numbers there"
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

}  // namespace underbody::tables
