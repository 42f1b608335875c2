#include "surrogates/tables/exports/export_grid.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "core/hash.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/force_table_impl.h"
#include "surrogates/tables/line.h"

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
    for (const auto& [name, value] : table.conditions()) {
        const auto* known = core::find_quantity(name);
        lines.push_back("Holds for " + name + " = " + core::format_number(value, 9) + (known != nullptr ? " " + known->unit : ""));
    }
    lines.push_back(options.frame == Frame::ned ? "Frame: body axes, x forward, y starboard, z down (NED); pitch and pitch_moment nose up"
                                                : "Frame: lift positive up, drag positive against the motion; pitch and pitch_moment nose up");
    lines.push_back(grid.range == RangePolicy::extrapolate ? "Outside its range it goes on with its end slopes, and says so"
                                                           : "Outside its range it holds its end value with slope zero, and says so");
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

ExportGrid export_grid(const ForceTable& table, const ExportOptions& options, core::Progress& progress) {
    if (!(options.max_error >= 0) || options.max_error >= 1) {
        throw core::UsageError("range", "the largest error is a share of the force's range between 0 and 1, such as 0.5%");
    }
    const ForceTable::Impl& full = table.impl();
    ExportGrid grid;
    grid.single_precision = options.single_precision;
    grid.range = full.range;
    grid.quantity = full.quantity;
    grid.unit = full.unit;
    if (const auto* known = core::find_quantity(full.quantity)) {
        grid.meaning = known->meaning;
    }
    CubicGrid surface = full.surface;
    if (!options.points.empty()) {
        surface = surface.resampled(chosen_points(table, surface, options));
    }
    if (options.max_error > 0) {
        const double allowed = options.max_error * range_of_points(full);
        const double spent = options.points.empty() ? 0 : largest_difference(full.surface, surface);
        if (spent < allowed) {
            surface = surface.resampled(thinned_points(surface, allowed - spent, progress));
        }
    }
    const bool same = surface.points() == full.surface.points();
    grid.thinning_error = same ? 0 : largest_difference(full.surface, surface);
    ErrorModel error = same ? full.error : resampled_error(full.error, surface);
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
        grid.axes.push_back({names[k], full.axes[k].unit, grid.surface.axis(k).points()});
    }
    grid.name = identifier(options.name.empty() ? grid.quantity : options.name);
    write_origin(grid, table, options);
    return grid;
}

double largest_difference(const CubicGrid& fine, const CubicGrid& coarse) {
    const std::size_t n = fine.dimensions();
    // Corners, middles and quarters of the cells of the fine grid; fewer a cell for many axes.
    const std::size_t a_cell = n == 1 ? 8 : n == 2 ? 4 : 2;
    std::vector<std::vector<double>> samples(n);
    std::size_t count = 1;
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = fine.axis(k).points();
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            for (std::size_t j = 0; j < a_cell; ++j) {
                samples[k].push_back(x[i] + (x[i + 1] - x[i]) * static_cast<double>(j) / static_cast<double>(a_cell));
            }
        }
        samples[k].push_back(x.back());
        count *= samples[k].size();
    }
    double worst = 0;
    double at[CubicGrid::max_axes];
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i;
        for (std::size_t k = n; k-- > 0;) {
            at[k] = samples[k][rest % samples[k].size()];
            rest /= samples[k].size();
        }
        worst = std::max(worst, std::abs(fine.value(at, nullptr) - coarse.value(at, nullptr)));
    }
    return worst;
}

}  // namespace underbody::tables
