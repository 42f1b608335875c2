#include <algorithm>
#include <cmath>

#include "core/angle.h"
#include "core/text.h"
#include "surrogates/dynamics/basin/region.h"

namespace underbody::dynamics {

namespace {

/// Units people read: mm, mm/s, deg, deg/s.
struct Shown {
    std::string label, unit;
    double scale = 1;
};

Shown shown(const std::string& axis) {
    if (axis == "gap") {
        return {"gap", "mm", 1e3};
    }
    if (axis == "heave_velocity") {
        return {"heave velocity", "mm/s", 1e3};
    }
    return axis == "pitch"        ? Shown{"pitch", "deg", 1 / core::degree}
           : axis == "pitch_rate" ? Shown{"pitch rate", "deg/s", 1 / core::degree}
                                  : Shown{axis, "", 1};
}

core::Colour class_colour(const EndClass& end, std::size_t attractor) {
    static const core::Colour attractors[] = {
        {154, 205, 167, 255}, {150, 196, 230, 255}, {214, 197, 232, 255}, {245, 223, 160, 255}};
    switch (end.kind) {
        case EndKind::attractor:
            return attractors[attractor % 4];
        case EndKind::contact:
            return {226, 158, 122, 255};
        case EndKind::escape:
            return {224, 224, 228, 255};
        case EndKind::cycle:
            return {250, 240, 140, 255};
        case EndKind::undecided:
            break;
    }
    return {255, 255, 255, 255};
}

std::string percent(double fraction) { return core::format_number(100 * fraction, 3) + " %"; }

/// Cells of equal ratio are drawn on a logarithmic axis, on which they are of equal width.
void frame(core::Figure& figure, const std::vector<core::NamedRange>& axes, bool gap_by_ratio) {
    const Shown x = shown(axes[0].name), y = shown(axes[1].name);
    figure.x = {x.label, x.unit, axes[0].lower * x.scale, axes[0].upper * x.scale};
    figure.y = {y.label, y.unit, axes[1].lower * y.scale, axes[1].upper * y.scale};
    figure.x.logarithmic = gap_by_ratio && axes[0].name == "gap";
    figure.y.logarithmic = gap_by_ratio && axes[1].name == "gap";
}

/// The parts of a line inside the axes; NaN parts them.
core::FigureCurve clipped(const RegionBoundary& line, const std::vector<core::NamedRange>& axes) {
    const Shown x = shown(axes[0].name), y = shown(axes[1].name);
    core::FigureCurve curve;
    bool inside = false;
    for (std::size_t i = 0; i < line.x.size(); ++i) {
        const bool in = line.x[i] >= axes[0].lower && line.x[i] <= axes[0].upper && line.y[i] >= axes[1].lower &&
                        line.y[i] <= axes[1].upper;
        if (in) {
            curve.x.push_back(line.x[i] * x.scale);
            curve.y.push_back(line.y[i] * y.scale);
        } else if (inside) {
            curve.x.push_back(std::nan(""));
            curve.y.push_back(std::nan(""));
        }
        inside = in;
    }
    return curve;
}

/// A grid (of classes or of values) over the whole frame.
template <typename Grid>
void place(Grid& grid, const core::Figure& figure, std::size_t columns, std::size_t rows) {
    grid.columns = columns;
    grid.rows = rows;
    grid.x_lower = figure.x.lower;
    grid.x_upper = figure.x.upper;
    grid.y_lower = figure.y.lower;
    grid.y_upper = figure.y.upper;
}

void add_equilibria(core::Figure& figure, const StabilityRegion& region) {
    const Shown x = shown(region.axes[0].name), y = shown(region.axes[1].name);
    core::FigurePoints stable{"stable equilibrium", {}, {}, {}, {0, 0, 0, 255}, core::FigurePoints::Shape::disc, 9};
    core::FigurePoints unstable{
        "unstable equilibrium", {}, {}, {}, {0, 0, 0, 255}, core::FigurePoints::Shape::circle, 9};
    for (const HeaveEquilibrium& e : region.equilibria) {
        const auto part = [&](std::size_t axis) {
            const std::string& name = region.axes[axis].name;
            return name == "gap" ? e.gap : name == "pitch" ? e.pitch : 0.0;
        };
        const double px = part(0), py = part(1);
        if (px < region.axes[0].lower || px > region.axes[0].upper || py < region.axes[1].lower ||
            py > region.axes[1].upper) {
            continue;
        }
        core::FigurePoints& points = e.stable ? stable : unstable;
        points.x.push_back(px * x.scale);
        points.y.push_back(py * y.scale);
        figure.notes.push_back({px * x.scale, py * y.scale, e.name});
    }
    for (core::FigurePoints* points : {&stable, &unstable}) {
        if (!points->x.empty()) {
            figure.points.push_back(*points);
        }
    }
}

bool over_gap_and_pitch(const StabilityRegion& region) {
    const std::string &x = region.axes[0].name, &y = region.axes[1].name;
    return (x == "gap" && y == "pitch") || (x == "pitch" && y == "gap");
}

/// Lines where a force table ends within the map.
void add_table_ends(core::Figure& figure, const StabilityRegion& region) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const core::NamedRange& range = region.axes[axis];
        const bool gap = range.name == "gap";
        for (const double edge :
             {gap ? region.table_lower : region.pitch_lower, gap ? region.table_upper : region.pitch_upper}) {
            if ((gap || range.name == "pitch") && edge > range.lower && edge < range.upper) {
                figure.lines.push_back({axis == 0, edge * shown(range.name).scale, "end of the force table"});
            }
        }
    }
}

std::string caption_of(const StabilityRegion& region) {
    return std::to_string(region.columns) + " x " + std::to_string(region.rows) + " starts, " +
           core::format_number(region.duration, 4) + " s of motion each; " + region.rule + ". Contact at " +
           core::format_number(1e3 * region.contact_gap, 4) + " mm, escape above " +
           core::format_number(1e3 * region.escape_gap, 5) + " mm." +
           (over_gap_and_pitch(region) ? " Arrows: where a start at rest sets off." : "") +
           (region.outside_fraction > 0 ? " Beyond the dashed line the force table holds its end value." : "") +
           (region.path_outside_fraction > 0
                ? " " + percent(region.path_outside_fraction) + " of the motions are beyond a force table at some time."
                : "");
}

}  // namespace

core::Figure region_figure(const StabilityRegion& region) {
    core::Figure figure;
    figure.title = "Where each start ends";
    frame(figure, region.axes, region.gap_by_ratio);
    core::FigureClasses map;
    place(map, figure, region.columns, region.rows);
    map.index = region.index;
    std::size_t attractor = 0;
    for (const EndClass& end : region.classes) {
        std::string name = end.name;
        if (end.kind == EndKind::attractor) {
            name += " (" + core::format_number(1e3 * end.gap, 4) + " mm)";
        }
        map.names.push_back(name + ", " + percent(end.fraction));
        map.colours.push_back(class_colour(end, attractor));
        attractor += end.kind == EndKind::attractor ? 1 : 0;
    }
    figure.classes.push_back(std::move(map));
    const Shown x = shown(region.axes[0].name), y = shown(region.axes[1].name);
    core::FigureArrows arrows;
    for (std::size_t i = 0; i < region.flow_x.size(); ++i) {
        arrows.x.push_back(region.flow_x[i] * x.scale);
        arrows.y.push_back(region.flow_y[i] * y.scale);
        arrows.dx.push_back(region.flow_dx[i] * x.scale);
        arrows.dy.push_back(region.flow_dy[i] * y.scale);
    }
    figure.arrows.push_back(std::move(arrows));
    for (const RegionBoundary& line : region.boundaries) {
        core::FigureCurve curve = clipped(line, region.axes);
        curve.colour = {30, 30, 30, 255};
        curve.width = 1.6;
        if (!curve.x.empty()) {
            figure.curves.push_back(std::move(curve));
        }
    }
    add_table_ends(figure, region);
    add_equilibria(figure, region);
    figure.caption = caption_of(region);
    return figure;
}

core::Figure region_overlay_figure(const std::vector<StabilityRegion>& regions, const std::vector<std::string>& names) {
    core::Figure figure;
    figure.title = "Stability boundaries of variants";
    if (regions.empty()) {
        return figure;
    }
    frame(figure, regions.front().axes, regions.front().gap_by_ratio);
    for (std::size_t k = 0; k < regions.size(); ++k) {
        if (regions[k].axes.size() != 2 || regions[k].axes[0].name != regions[0].axes[0].name ||
            regions[k].axes[1].name != regions[0].axes[1].name) {
            throw core::InputError("range", "variants on one plot need the same axes");
        }
        bool named = false;
        for (const RegionBoundary& line : regions[k].boundaries) {
            core::FigureCurve curve = clipped(line, regions[0].axes);
            if (curve.x.empty()) {
                continue;
            }
            double safe = 0;
            for (const EndClass& end : regions[k].classes) {
                safe += end.kind == EndKind::attractor ? end.fraction : 0.0;
            }
            curve.name = named ? "" : (k < names.size() ? names[k] : std::to_string(k + 1)) + ", safe " + percent(safe);
            curve.colour = core::palette(k);
            curve.dashed = k % 2 == 1;
            named = true;
            figure.curves.push_back(std::move(curve));
        }
    }
    figure.caption = "Each line parts the starts that end at an attractor from those that do not.";
    return figure;
}

core::Figure sweep_figure(const RegionSweep& sweep) {
    core::Figure figure;
    figure.title = "Where the starts end";
    const Shown x = shown(sweep.name);
    Channel channel{};
    find_channel(sweep.name, channel);
    figure.x = {x.label, x.unit.empty() ? channel_unit(channel) : x.unit};
    figure.y = {"share of the starts", "%", 0, 100};
    std::vector<std::string> names;
    for (const StabilityRegion& region : sweep.regions) {
        for (const EndClass& end : region.classes) {
            if (std::find(names.begin(), names.end(), end.name) == names.end()) {
                names.push_back(end.name);
            }
        }
    }
    for (const std::string& name : names) {
        core::FigureCurve curve{name, {}, {}, core::palette(figure.curves.size())};
        for (std::size_t i = 0; i < sweep.value.size(); ++i) {
            curve.x.push_back(sweep.value[i] * x.scale);
            curve.y.push_back(100 * sweep.regions[i].fraction(name));
        }
        figure.curves.push_back(std::move(curve));
    }
    if (!sweep.regions.empty()) {
        figure.caption = "Share of the area of starts over " + sweep.regions[0].axes[0].name + " and " +
                         sweep.regions[0].axes[1].name + " that ends in each way.";
    }
    return figure;
}

core::Figure probability_figure(const ProbabilityMap& map) {
    core::Figure figure;
    figure.title = "Chance that a start is safe";
    frame(figure, map.axes, map.gap_by_ratio);
    core::FigureMap values;
    place(values, figure, map.columns, map.rows);
    values.x_by_ratio = figure.x.logarithmic;
    values.y_by_ratio = figure.y.logarithmic;
    values.values.assign(map.safe.begin(), map.safe.end());
    values.label = "probability";
    values.unit = "1";
    values.lower = 0;
    values.upper = 1;
    figure.maps.push_back(std::move(values));
    figure.caption =
        "Share of " + std::to_string(map.draws) +
        " draws of the force tables from their error after which the start ends at an attractor; safe area " +
        percent(map.area_mean) + " +- " + percent(map.area_sigma) + " (one standard deviation).";
    return figure;
}

}  // namespace underbody::dynamics
