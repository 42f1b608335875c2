#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/region_parts.h"

namespace underbody::dynamics {

namespace {

[[noreturn]] void refuse(const std::string& why) {
    throw core::InputError("range", why, {}, "for instance --axes gap=0:0.5,heave_velocity=-0.1:0.1");
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
    if (options.columns < 1 || options.rows < 1 || options.columns * options.rows > 100000000) {
        refuse("a region has between one and 100 million starts");
    }
    if (!(options.duration > 0)) {
        refuse("the time of motion must be positive");
    }
}

std::vector<End> region_grid(const RegionOptions& o, const RegionBatch& batch) {
    std::vector<double> x(o.columns * o.rows), y(x.size());
    for (std::size_t j = 0; j < o.rows; ++j) {
        for (std::size_t i = 0; i < o.columns; ++i) {
            x[j * o.columns + i] = o.axes[0].lower + (o.axes[0].upper - o.axes[0].lower) *
                                                         (static_cast<double>(i) + 0.5) /
                                                         static_cast<double>(o.columns);
            y[j * o.columns + i] = o.axes[1].lower + (o.axes[1].upper - o.axes[1].lower) *
                                                         (static_cast<double>(j) + 0.5) / static_cast<double>(o.rows);
        }
    }
    std::vector<End> ends(x.size());
    batch(x, y, ends);
    return ends;
}

std::vector<double> region_fractions(const RegionOptions& o, const RegionBatch& batch, const std::vector<End>& ends,
                                     std::size_t classes) {
    constexpr std::size_t fine = 4;
    const std::size_t columns = o.columns, rows = o.rows;
    std::vector<double> sums(classes, 0.0);
    std::vector<std::size_t> edge;
    for (std::size_t j = 0; j < rows; ++j) {
        for (std::size_t i = 0; i < columns; ++i) {
            const int own = ends[j * columns + i].index;
            const auto other = [&](std::size_t ii, std::size_t jj) { return ends[jj * columns + ii].index != own; };
            const bool at_edge = o.refine && ((i > 0 && other(i - 1, j)) || (i + 1 < columns && other(i + 1, j)) ||
                                              (j > 0 && other(i, j - 1)) || (j + 1 < rows && other(i, j + 1)));
            if (at_edge) {
                edge.push_back(j * columns + i);
            } else {
                sums[static_cast<std::size_t>(own)] += 1;
            }
        }
    }
    std::vector<double> x(edge.size() * fine * fine), y(x.size());
    const double dx = (o.axes[0].upper - o.axes[0].lower) / static_cast<double>(columns);
    const double dy = (o.axes[1].upper - o.axes[1].lower) / static_cast<double>(rows);
    for (std::size_t k = 0; k < edge.size(); ++k) {
        for (std::size_t f = 0; f < fine * fine; ++f) {
            x[k * fine * fine + f] = o.axes[0].lower + dx * (static_cast<double>(edge[k] % columns) +
                                                             (static_cast<double>(f % fine) + 0.5) / fine);
            y[k * fine * fine + f] = o.axes[1].lower + dy * (static_cast<double>(edge[k] / columns) +
                                                             (static_cast<double>(f / fine) + 0.5) / fine);
        }
    }
    std::vector<End> refined(x.size());
    batch(x, y, refined);
    for (const End& end : refined) {
        sums[static_cast<std::size_t>(end.index)] += 1.0 / (fine * fine);
    }
    for (double& sum : sums) {
        sum /= static_cast<double>(columns * rows);
    }
    return sums;
}

void keep_seen_classes(StabilityRegion& region, const std::vector<EndClass>& all, const std::vector<double>& sums) {
    std::vector<bool> occurs(all.size(), false);
    for (const int index : region.index) {
        occurs[static_cast<std::size_t>(index)] = true;
    }
    std::vector<int> renamed(all.size(), -1);
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (occurs[i] || sums[i] > 0 || all[i].kind == EndKind::attractor) {
            renamed[i] = static_cast<int>(region.classes.size());
            region.classes.push_back(all[i]);
            region.classes.back().fraction = sums[i];
        }
    }
    for (int& index : region.index) {
        index = renamed[static_cast<std::size_t>(index)];
    }
}

void add_cell_boundaries(StabilityRegion& region) {
    const double dx = (region.axes[0].upper - region.axes[0].lower) / static_cast<double>(region.columns);
    const double dy = (region.axes[1].upper - region.axes[1].lower) / static_cast<double>(region.rows);
    RegionBoundary line;
    line.name = "between cells";
    const auto segment = [&](double x0, double y0, double x1, double y1) {
        for (const double x : {x0, x1, std::nan("")}) {
            line.x.push_back(x);
        }
        for (const double y : {y0, y1, std::nan("")}) {
            line.y.push_back(y);
        }
    };
    for (std::size_t j = 0; j < region.rows; ++j) {
        for (std::size_t i = 0; i < region.columns; ++i) {
            const int own = region.index[j * region.columns + i];
            const double x = region.axes[0].lower + dx * static_cast<double>(i),
                         y = region.axes[1].lower + dy * static_cast<double>(j);
            if (i + 1 < region.columns && region.index[j * region.columns + i + 1] != own) {
                segment(x + dx, y, x + dx, y + dy);
            }
            if (j + 1 < region.rows && region.index[(j + 1) * region.columns + i] != own) {
                segment(x, y + dy, x + dx, y + dy);
            }
        }
    }
    if (!line.x.empty()) {
        region.boundaries.push_back(std::move(line));
    }
}

}  // namespace underbody::dynamics
