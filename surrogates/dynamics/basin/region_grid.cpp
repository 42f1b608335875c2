#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/no_limit.h"
#include "core/text.h"
#include "core/told.h"
#include "surrogates/dynamics/basin/region_parts.h"
#include "surrogates/dynamics/plant/environment.h"

namespace underbody::dynamics {

namespace {

constexpr double same_place = 1e-9;   ///< of an axis
constexpr double all_inside = 1e-12;  ///< share of the map

[[noreturn]] void refuse(const std::string& why) {
    throw core::InputError("range", why, {}, "for instance option 'axes gap=0:0.5,heave_velocity=-0.1:0.1'");
}

}  // namespace

void check_region_options(const RegionOptions& options) {
    if (options.axes.size() != 2 || options.axes[0].name == options.axes[1].name) {
        refuse("a region needs two different axes");
    }
    for (const core::NamedRange& axis : options.axes) {
        if (axis.name != "gap" && axis.name != "heave_velocity" && axis.name != "pitch" && axis.name != "pitch_rate") {
            refuse("'" + axis.name + "' cannot be an axis of a region: gap, heave_velocity, pitch, pitch_rate can");
        }
        if (!(axis.upper > axis.lower) || !std::isfinite(axis.lower) || !std::isfinite(axis.upper)) {
            refuse("axis " + axis.name + " needs a lower and a higher bound");
        }
    }
    for (const core::NamedRange& axis : options.axes) {
        if (options.gap_by_ratio && axis.name == "gap" && !(axis.lower > 0)) {
            refuse("cells of equal ratio need an axis of gaps that begins above nought");
        }
    }
    if (options.columns < 1 || options.rows < 1 || options.columns * options.rows > 100000000) {
        refuse("a region has between one and 100 million starts");
    }
    if (!(options.duration > 0)) {
        refuse("the time of motion must be positive");
    }
}

void check_gap_axis(const RegionOptions& options, double contact_gap) {
    for (const core::NamedRange& axis : options.axes) {
        if (axis.name == "gap" && axis.lower < contact_gap - same_place * (axis.upper - axis.lower)) {
            throw core::InputError("range",
                                   "the axis of gaps begins at " + core::format_number(1e3 * axis.lower, 6) +
                                       " mm, in the ground: the body touches it at " +
                                       core::format_number(1e3 * contact_gap, 6) + " mm",
                                   {},
                                   "begin there, or set [contact] gap in the model where the gap is counted from "
                                   "another height");
        }
    }
}

double place_along(const core::NamedRange& axis, bool gap_by_ratio, double share) {
    return gap_by_ratio && axis.name == "gap" ? axis.lower * std::pow(axis.upper / axis.lower, share)
                                              : axis.lower + (axis.upper - axis.lower) * share;
}

namespace {

/// Where cell `i` of `count` is at a part of its width.
double in_cell(const RegionOptions& o, std::size_t axis, std::size_t i, double part) {
    const std::size_t count = axis == 0 ? o.columns : o.rows;
    return place_along(o.axes[axis], o.gap_by_ratio, (static_cast<double>(i) + part) / static_cast<double>(count));
}

/// Width of part `k` of `parts` of cell `i`, in mean widths of a cell.
double width_of(const RegionOptions& o, std::size_t axis, std::size_t i, std::size_t k = 0, std::size_t parts = 1) {
    const double fine = static_cast<double>(parts);
    if (!o.gap_by_ratio || o.axes[axis].name != "gap") {
        return 1 / fine;
    }
    const double width =
        in_cell(o, axis, i, static_cast<double>(k + 1) / fine) - in_cell(o, axis, i, static_cast<double>(k) / fine);
    return width * static_cast<double>(axis == 0 ? o.columns : o.rows) / (o.axes[axis].upper - o.axes[axis].lower);
}

}  // namespace

std::vector<End> region_grid(const RegionOptions& o, const RegionBatch& batch, const core::Progress& progress) {
    std::vector<double> x, y;
    x.reserve(o.columns * o.rows);
    y.reserve(o.columns * o.rows);
    for (std::size_t j = 0; j < o.rows; ++j) {
        progress.check();
        for (std::size_t i = 0; i < o.columns; ++i) {
            x.push_back(in_cell(o, 0, i, 0.5));
            y.push_back(in_cell(o, 1, j, 0.5));
        }
    }
    std::vector<End> ends;
    ends.reserve(x.size());
    for (std::size_t j = 0; j < o.rows; ++j) {
        progress.check();
        ends.resize((j + 1) * o.columns);
    }
    batch(x, y, ends);
    return ends;
}

namespace {

/// Starts of a finer grid within cells.
struct FineStarts {
    std::vector<double> x, y;
};

FineStarts fine_starts(const RegionOptions& o, const std::vector<std::size_t>& edge, std::size_t fine,
                       const core::Progress& progress) {
    const std::size_t columns = o.columns;
    std::vector<double> x(edge.size() * fine * fine), y(x.size());
    const auto middle = [fine](std::size_t part) {
        return (static_cast<double>(part) + 0.5) / static_cast<double>(fine);
    };
    for (std::size_t k = 0; k < edge.size(); ++k) {
        if (k % 4096 == 0) {
            progress.check();
        }
        for (std::size_t f = 0; f < fine * fine; ++f) {
            x[k * fine * fine + f] = in_cell(o, 0, edge[k] % columns, middle(f % fine));
            y[k * fine * fine + f] = in_cell(o, 1, edge[k] / columns, middle(f / fine));
        }
    }
    return {std::move(x), std::move(y)};
}

/// Fractions of the area: cells beside another class count by a finer grid of starts within them. The second list:
/// of those whose motion leaves the range of a force table.
std::array<std::vector<double>, 2> region_fractions(const RegionOptions& o, const RegionBatch& batch,
                                                    const std::vector<End>& ends, std::size_t classes,
                                                    const core::Progress& progress) {
    constexpr std::size_t fine = 4;
    const std::size_t columns = o.columns, rows = o.rows;
    std::array<std::vector<double>, 2> sums{std::vector<double>(classes, 0.0), std::vector<double>(classes, 0.0)};
    const auto count = [&](const End& end, double weight) {
        sums[0][static_cast<std::size_t>(end.index)] += weight;
        sums[1][static_cast<std::size_t>(end.index)] += end.outside ? weight : 0;
    };
    std::vector<std::size_t> edge;
    for (std::size_t j = 0; j < rows; ++j) {
        progress.check();
        for (std::size_t i = 0; i < columns; ++i) {
            const int own = ends[j * columns + i].index;
            const auto other = [&](std::size_t ii, std::size_t jj) { return ends[jj * columns + ii].index != own; };
            const bool at_edge = o.refine && ((i > 0 && other(i - 1, j)) || (i + 1 < columns && other(i + 1, j)) ||
                                              (j > 0 && other(i, j - 1)) || (j + 1 < rows && other(i, j + 1)));
            if (at_edge) {
                edge.push_back(j * columns + i);
            } else {
                count(ends[j * columns + i], width_of(o, 0, i) * width_of(o, 1, j));
            }
        }
    }
    const FineStarts starts = fine_starts(o, edge, fine, progress);
    std::vector<End> refined(starts.x.size());
    batch(starts.x, starts.y, refined);
    for (std::size_t k = 0; k < refined.size(); ++k) {
        const std::size_t cell = edge[k / (fine * fine)], f = k % (fine * fine);
        count(refined[k],
              width_of(o, 0, cell % columns, f % fine, fine) * width_of(o, 1, cell / columns, f / fine, fine));
    }
    for (std::vector<double>& list : sums) {
        for (double& sum : list) {
            sum /= static_cast<double>(columns * rows);
        }
    }
    return sums;
}

}  // namespace

StabilityRegion region_map(const RegionOptions& options, const RegionBatch& batch, const std::vector<End>& ends,
                           const std::vector<EndClass>& classes, const core::Progress& progress) {
    StabilityRegion region;
    region.axes = options.axes;
    region.columns = options.columns;
    region.rows = options.rows;
    region.gap_by_ratio = options.gap_by_ratio;
    region.duration = options.duration;
    const auto [sums, outside] = region_fractions(options, batch, ends, classes.size(), progress);
    std::vector<bool> occurs(classes.size(), false);
    for (const End& end : ends) {
        occurs[static_cast<std::size_t>(end.index)] = true;
    }
    std::vector<int> renamed(classes.size(), -1);
    for (std::size_t i = 0; i < classes.size(); ++i) {
        if (occurs[i] || sums[i] > 0 || classes[i].kind == EndKind::attractor) {
            renamed[i] = static_cast<int>(region.classes.size());
            region.classes.push_back(classes[i]);
            region.classes.back().fraction = sums[i];
            region.classes.back().outside = outside[i];
            region.path_outside_fraction += outside[i];
        }
    }
    progress.check();
    region.index.reserve(ends.size());
    region.time.reserve(ends.size());
    for (const End& end : ends) {
        region.index.push_back(renamed[static_cast<std::size_t>(end.index)]);
        region.time.push_back(static_cast<float>(end.time));
    }
    return region;
}

namespace {

/// A pair of neighbouring starts of different classes, and the point between them where the class changes.
struct Crossing {
    std::size_t low, high;  ///< of the grid
    double from = 0, to = 1;
};

void bisect(std::vector<Crossing>& crossings, const RegionOptions& o, const RegionBatch& batch,
            const std::vector<End>& ends, const std::function<double(std::size_t)>& x_of,
            const std::function<double(std::size_t)>& y_of) {
    if (!o.refine || crossings.empty()) {
        return;
    }
    std::vector<double> x(crossings.size()), y(crossings.size());
    std::vector<End> middle(crossings.size());
    for (int round = 0; round < 7; ++round) {
        for (std::size_t k = 0; k < crossings.size(); ++k) {
            const Crossing& c = crossings[k];
            const double part = (c.from + c.to) / 2;
            x[k] = x_of(c.low) + part * (x_of(c.high) - x_of(c.low));
            y[k] = y_of(c.low) + part * (y_of(c.high) - y_of(c.low));
        }
        batch(x, y, middle);
        for (std::size_t k = 0; k < crossings.size(); ++k) {
            Crossing& c = crossings[k];
            (middle[k].index == ends[c.low].index ? c.from : c.to) = (c.from + c.to) / 2;
        }
    }
}

/// Crossings between neighbouring starts, and which of them belongs to each: number 2 s is that of start s toward the
/// next column, 2 s + 1 toward the next row; -1 where both starts end alike.
struct Crossings {
    std::vector<Crossing> list;
    std::vector<std::ptrdiff_t> of;
};

Crossings crossings_between(const RegionOptions& o, const std::vector<End>& ends, const core::Progress& progress) {
    const std::size_t columns = o.columns, rows = o.rows;
    std::vector<Crossing> crossings;
    std::vector<std::ptrdiff_t> of;
    of.reserve(2 * columns * rows);
    for (std::size_t s = 0; s < columns * rows; ++s) {
        if (s % 65536 == 0) {
            progress.check();
        }
        for (const std::size_t way : {0, 1}) {
            const bool inside = way == 0 ? s % columns + 1 < columns : s / columns + 1 < rows;
            const std::size_t next = s + (way == 0 ? 1 : columns);
            const bool crosses = inside && ends[s].index != ends[next].index;
            of.push_back(crosses ? static_cast<std::ptrdiff_t>(crossings.size()) : -1);
            if (crosses) {
                crossings.push_back({s, next});
            }
        }
    }
    return {std::move(crossings), std::move(of)};
}

/// Adds the lines of one cell: between two crossings, or from each of several to their mean.
void add_lines(RegionBoundary& line, const std::vector<std::array<double, 2>>& points) {
    std::array<double, 2> middle{};
    for (const std::array<double, 2>& p : points) {
        middle[0] += p[0] / static_cast<double>(points.size());
        middle[1] += p[1] / static_cast<double>(points.size());
    }
    const auto segment = [&](const std::array<double, 2>& a, const std::array<double, 2>& b) {
        for (const double v : {a[0], b[0], std::nan("")}) {
            line.x.push_back(v);
        }
        for (const double v : {a[1], b[1], std::nan("")}) {
            line.y.push_back(v);
        }
    };
    if (points.size() == 2) {
        segment(points[0], points[1]);
    } else {
        for (const std::array<double, 2>& p : points) {
            segment(p, middle);
        }
    }
}

}  // namespace

void add_traced_boundaries(StabilityRegion& region, const RegionOptions& o, const RegionBatch& batch,
                           const std::vector<End>& ends, const core::Progress& progress) {
    const std::size_t columns = o.columns, rows = o.rows;
    const auto x_of = [&](std::size_t k) { return in_cell(o, 0, k % columns, 0.5); };
    const auto y_of = [&](std::size_t k) { return in_cell(o, 1, k / columns, 0.5); };
    auto [crossings, of] = crossings_between(o, ends, progress);
    bisect(crossings, o, batch, ends, x_of, y_of);
    RegionBoundary line;
    line.name = "between classes";
    for (std::size_t j = 0; j + 1 < rows; ++j) {
        progress.check();
        for (std::size_t i = 0; i + 1 < columns; ++i) {
            const std::size_t s = j * columns + i;
            std::vector<std::array<double, 2>> points;
            for (const std::size_t edge : {2 * s, 2 * s + 1, 2 * (s + 1) + 1, 2 * (s + columns)}) {
                if (of[edge] >= 0) {
                    const Crossing& c = crossings[static_cast<std::size_t>(of[edge])];
                    const double part = (c.from + c.to) / 2;
                    points.push_back({x_of(c.low) + part * (x_of(c.high) - x_of(c.low)),
                                      y_of(c.low) + part * (y_of(c.high) - y_of(c.low))});
                }
            }
            if (points.size() < 2) {
                continue;
            }
            add_lines(line, points);
        }
    }
    if (!line.x.empty()) {
        region.boundaries.push_back(std::move(line));
    }
}

double outside_share(const StabilityRegion& region) {
    double inside = 1;
    for (const core::NamedRange& axis : region.axes) {
        const bool gap = axis.name == "gap";
        if (!gap && axis.name != "pitch") {
            continue;
        }
        const double lower = gap ? region.table_lower : region.pitch_lower,
                     upper = gap ? region.table_upper : region.pitch_upper;
        const double covered = std::min(axis.upper, upper) - std::max(axis.lower, lower);
        inside *= std::clamp(covered / (axis.upper - axis.lower), 0.0, 1.0);
    }
    return inside > 1 - all_inside ? 0 : 1 - inside;
}

void add_outside_remarks(StabilityRegion& region) {
    const std::string range =
        table_range_text(region.table_lower, region.table_upper, region.pitch_lower, region.pitch_upper);
    if (region.outside_fraction > 0) {
        region.remarks.push_back({core::Problem::Severity::warning,
                                  core::format_number(100 * region.outside_fraction, 3) +
                                      " % of the starts lie outside the range of a force table (" + range +
                                      "), where it holds its end value",
                                  {}});
    }
    add_path_remark(region.remarks, region.path_outside_fraction, range);
}

std::string table_range_text(double gap_lower, double gap_upper, double pitch_lower, double pitch_upper) {
    std::string range;
    const auto add = [&](const char* name, double lower, double upper, const char* unit) {
        if (core::is_limit(lower) || core::is_limit(upper)) {
            range += std::string(range.empty() ? "" : "; ") + name + " " + core::told_range(lower, upper, unit);
        }
    };
    add("gap", gap_lower, gap_upper, "m");
    add("pitch", pitch_lower, pitch_upper, "rad");
    return range;
}

void add_path_remark(core::Problems& remarks, double share, const std::string& range) {
    if (share > 0) {
        remarks.push_back({core::Problem::Severity::warning,
                           core::format_number(100 * share, 3) +
                               " % of the motions are at some time outside the range of a force table (" + range +
                               "), where it holds its end value: how they end rests on forces that no table gives",
                           {}});
    }
}

void add_model_remarks(StabilityRegion& region, const Model& model, const Conditions& held) {
    region.remarks = motion_remarks(model, held);
    add_outside_remarks(region);
}

bool in_heave_and_pitch(const RegionOptions& options, const core::Table* starts) {
    if (options.motion != RegionOptions::Motion::automatic) {
        return options.motion == RegionOptions::Motion::heave_pitch;
    }
    const auto turns = [](const core::NamedRange& axis) { return axis.name == "pitch" || axis.name == "pitch_rate"; };
    if (starts) {
        return starts->find("pitch") || starts->find("pitch_rate") || options.pitch_feedback;
    }
    return options.pitch_feedback || std::any_of(options.axes.begin(), options.axes.end(), turns);
}

}  // namespace underbody::dynamics
