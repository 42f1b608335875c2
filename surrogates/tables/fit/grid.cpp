#include "surrogates/tables/fit/grid.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace underbody::tables {

GridAxis::GridAxis(std::vector<double> points) : x_(std::move(points)) {
    assert(x_.size() >= 2);
    const std::size_t cells = x_.size() - 1;
    lower_ = x_.front();
    upper_ = x_.back();
    const double span = x_.back() - x_.front();
    double shortest = span;
    for (std::size_t i = 0; i < cells; ++i) {
        assert(x_[i] < x_[i + 1]);
        shortest = std::min(shortest, x_[i + 1] - x_[i]);
    }
    // A bucket no wider than the shortest cell needs one step at most; very uneven axes take a few.
    const double wanted = std::min(std::ceil(span / shortest) + 1, 16384.0);
    const auto buckets = static_cast<std::size_t>(std::max(wanted, static_cast<double>(cells)));
    per_unit_ = static_cast<double>(buckets) / span;
    last_bucket_ = static_cast<std::int32_t>(buckets) - 1;
    stop_.assign(x_.begin() + 1, x_.end());
    stop_.back() = std::numeric_limits<double>::infinity();
    first_.resize(buckets);
    std::size_t i = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
        // One ulp early, because the product in cell() may round up.
        const double begin = lower_ + (static_cast<double>(b) / per_unit_) * (1 - 1e-15) - std::abs(lower_) * 1e-15;
        while (begin >= stop_[i]) {
            ++i;
        }
        first_[b] = static_cast<std::uint32_t>(i);
    }
    for (std::size_t b = 0; b < buckets; ++b) {
        // And one ulp late. The last bucket takes all that rounds beyond it.
        const double end = lower_ + (static_cast<double>(b + 1) / per_unit_) * (1 + 1e-15) + std::abs(lower_) * 1e-15;
        std::size_t last = first_[b];
        while (b + 1 == buckets ? last + 1 < cells : end >= stop_[last]) {
            ++last;
        }
        steps_ = std::max(steps_, static_cast<unsigned>(last - first_[b]));
    }
}

void CubicGrid::set_axes(std::vector<std::vector<double>> points) {
    assert(!points.empty() && points.size() <= max_axes);
    std::size_t count = 1;
    for (std::size_t k = points.size(); k-- > 0;) {
        stride_[k] = count;
        count *= points[k].size();
    }
    for (auto& axis : points) {
        axes_.emplace_back(std::move(axis));
    }
    dimensions_ = axes_.size();
    nodes_.resize(count << dimensions_);
}

CubicGrid::CubicGrid(std::vector<std::vector<double>> points, std::vector<double> hermite) {
    set_axes(std::move(points));
    assert(hermite.size() == nodes_.size());
    nodes_ = std::move(hermite);
    build_cells();
}

CubicGrid::CubicGrid(std::vector<std::vector<double>> points, std::span<const double> values, SlopeRule rule) {
    set_axes(std::move(points));
    const std::size_t n = axes_.size();
    const std::size_t count = nodes();
    assert(values.size() == count);
    const std::size_t width = std::size_t{1} << n;
    for (std::size_t i = 0; i < count; ++i) {
        nodes_[i * width] = values[i];
    }
    // Axis by axis: slopes of all that is known so far along every line of the grid.
    std::vector<double> line, slope;
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t size = axes_[k].size();
        line.resize(size);
        slope.resize(size);
        for (std::size_t start = 0; start < count; ++start) {
            if ((start / stride_[k]) % size != 0) {
                continue;
            }
            for (std::size_t mask = 0; mask < (std::size_t{1} << k); ++mask) {
                for (std::size_t i = 0; i < size; ++i) {
                    line[i] = nodes_[(start + i * stride_[k]) * width + mask];
                }
                line_slopes(rule, axes_[k].points(), line, slope);
                for (std::size_t i = 0; i < size; ++i) {
                    nodes_[(start + i * stride_[k]) * width + (mask | std::size_t{1} << k)] = slope[i];
                }
            }
        }
    }
    if (rule == SlopeRule::monotone && n > 1) {
        limit_cross_slopes();
    }
    build_cells();
}

void CubicGrid::limit_cross_slopes() {
    const std::size_t count = nodes();
    std::array<std::size_t, max_axes> index{};
    for (std::size_t node = 0; node < count; ++node) {
        for (std::size_t k = 0; k < axes_.size(); ++k) {
            index[k] = node / stride_[k] % axes_[k].size();
        }
        limit_node(node, {index.data(), axes_.size()});
    }
}

namespace {

/// What the Bezier points of one node ask of its slopes: the room of the cross slope where there are two axes, and the
/// shares of cross slopes and of slopes that keep every point within its cell.
struct SlopeRoom {
    double cross_lower = -std::numeric_limits<double>::infinity();
    double cross_upper = std::numeric_limits<double>::infinity();
    double cross_share = 1;  ///< of the cross slopes, when they give way together
    double slope_share = 1;  ///< of the slopes, without cross slopes
    bool cross_fits = true, slopes_fit = true;
};

/// The Bezier point that goes `step` from the node along the axes of `set`, whose value may lie from `down` to `up`
/// away from the node's.
void keep_within(SlopeRoom& room, const double* data, std::size_t set, std::span<const double> step, double down,
                 double up) {
    double linear = 0;
    double cross = 0;
    double factor_of_full = 0;
    for (std::size_t part = 1; part <= set; ++part) {
        if ((part & set) != part) {
            continue;
        }
        double product = 1;
        for (std::size_t k = 0; k < step.size(); ++k) {
            product *= (part >> k & 1) != 0 ? step[k] : 1;
        }
        ((part & (part - 1)) == 0 ? linear : cross) += product * data[part];
        factor_of_full = product;
    }
    if (linear > up || linear < down) {
        room.slopes_fit = false;
        room.slope_share = std::min(room.slope_share, std::max(0.0, (linear > up ? up : down) / linear));
    }
    if (linear + cross > up || linear + cross < down) {
        room.cross_fits = false;
        const double left = (linear + cross > up ? up : down) - linear;
        room.cross_share = std::min(room.cross_share, std::max(0.0, left / cross));
    }
    if (step.size() == 2) {
        const double a = (down - linear) / factor_of_full;
        const double b = (up - linear) / factor_of_full;
        room.cross_lower = std::max(room.cross_lower, std::min(a, b));
        room.cross_upper = std::min(room.cross_upper, std::max(a, b));
    }
}

void make_room(const SlopeRoom& room, double* data, std::size_t axes) {
    if (room.cross_fits) {
        return;
    }
    if (axes == 2 && room.cross_lower <= room.cross_upper) {
        data[3] = std::clamp(data[3], room.cross_lower, room.cross_upper);
        return;
    }
    const double share = room.slopes_fit ? 1 : room.slope_share;
    for (std::size_t part = 1; part < std::size_t{1} << axes; ++part) {
        const bool single = (part & (part - 1)) == 0;
        data[part] *= single ? share : (room.slopes_fit ? room.cross_share : 0);
    }
}

}  // namespace

/// Every Bezier point of a cell belongs to one of its corners; here those of one node, over all cells around it, are
/// kept between the smallest and the largest corner of their cell: first the cross slopes give way, then all slopes.
void CubicGrid::limit_node(std::size_t node, std::span<const std::size_t> index) {
    const std::size_t n = axes_.size();
    const std::size_t width = std::size_t{1} << n;
    double* data = &nodes_[node * width];
    const double f = data[0];
    SlopeRoom slopes;
    for (std::size_t side = 0; side < width; ++side) {  // bit k: the cell above the node along axis k
        std::array<double, max_axes> step{};
        bool exists = true;
        for (std::size_t k = 0; k < n && exists; ++k) {
            const bool above = (side >> k & 1) != 0;
            exists = above ? index[k] + 1 < axes_[k].size() : index[k] > 0;
            if (exists) {
                const auto& x = axes_[k].points();
                step[k] = (above ? x[index[k] + 1] - x[index[k]] : x[index[k] - 1] - x[index[k]]) / 3;
            }
        }
        if (!exists) {
            continue;
        }
        double lowest = f;
        double highest = f;
        for (std::size_t corner = 1; corner < width; ++corner) {
            std::size_t other = node;
            for (std::size_t k = 0; k < n; ++k) {
                if ((corner >> k & 1) != 0) {
                    other = (side >> k & 1) != 0 ? other + stride_[k] : other - stride_[k];
                }
            }
            lowest = std::min(lowest, nodes_[other * width]);
            highest = std::max(highest, nodes_[other * width]);
        }
        const double room = 1e-14 * (std::abs(lowest) + std::abs(highest));
        for (std::size_t set = 1; set < width; ++set) {
            if ((set & (set - 1)) == 0) {
                continue;  // along one axis the slopes are limited already
            }
            keep_within(slopes, data, set, {step.data(), n}, lowest - f - room, highest - f + room);
        }
    }
    make_room(slopes, data, n);
}

namespace {

/// Coefficients of the cubic on a cell of width h with values a, b and slopes c, d at its ends.
std::array<double, 4> cubic(double h, double a, double b, double c, double d) {
    const double secant = (b - a) / h;
    return {a, c, (3 * secant - 2 * c - d) / h, (c + d - 2 * secant) / (h * h)};
}

}  // namespace

void CubicGrid::build_cells() {
    if (axes_.size() == 1) {
        const auto& x = axes_[0].points();
        cells_.resize((x.size() - 1) * 4);
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            const double* p = &nodes_[2 * i];
            const auto c = cubic(x[i + 1] - x[i], p[0], p[2], p[1], p[3]);
            std::copy(c.begin(), c.end(), &cells_[4 * i]);
        }
    } else if (axes_.size() == 2) {
        const auto& x = axes_[0].points();
        const auto& y = axes_[1].points();
        const std::size_t columns = y.size() - 1;
        bicubic_columns_ = columns;
        bicubics_.resize((x.size() - 1) * columns);
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            for (std::size_t j = 0; j < columns; ++j) {
                const double* p00 = &nodes_[4 * (i * y.size() + j)];
                const double* p10 = p00 + 4 * y.size();
                const double hx = x[i + 1] - x[i];
                const double hy = y[j + 1] - y[j];
                // Along x for each of value and y-slope at both ends of y, then along y for each power of x.
                const auto v0 = cubic(hx, p00[0], p10[0], p00[1], p10[1]);
                const auto v1 = cubic(hx, p00[4], p10[4], p00[5], p10[5]);
                const auto s0 = cubic(hx, p00[2], p10[2], p00[3], p10[3]);
                const auto s1 = cubic(hx, p00[6], p10[6], p00[7], p10[7]);
                double* cell = bicubics_[i * columns + j].c;
                for (std::size_t power = 0; power < 4; ++power) {
                    const auto c = cubic(hy, v0[power], v1[power], s0[power], s1[power]);
                    for (std::size_t q = 0; q < 4; ++q) {
                        cell[4 * q + power] = c[q];  // powers of x side by side, for the vector unit
                    }
                }
            }
        }
    }
}

std::vector<std::vector<double>> CubicGrid::points() const {
    std::vector<std::vector<double>> result;
    for (const auto& axis : axes_) {
        result.push_back(axis.points());
    }
    return result;
}

CubicGrid CubicGrid::resampled(std::vector<std::vector<double>> points) const {
    const std::size_t n = axes_.size();
    std::size_t count = 1;
    for (const auto& axis : points) {
        count *= axis.size();
    }
    std::vector<double> hermite(count << n);
    double at[max_axes];
    for (std::size_t node = 0; node < count; ++node) {
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            at[k] = points[k][rest % points[k].size()];
            rest /= points[k].size();
        }
        derivatives(at, &hermite[node << n]);
    }
    return {std::move(points), std::move(hermite)};
}

CubicGrid CubicGrid::transformed(double factor, unsigned mirrored) const {
    const std::size_t n = axes_.size();
    auto turned = points();
    for (std::size_t k = 0; k < n; ++k) {
        if ((mirrored >> k & 1) != 0) {
            std::reverse(turned[k].begin(), turned[k].end());
            for (double& x : turned[k]) {
                x = -x;
            }
        }
    }
    std::vector<double> hermite(nodes_.size());
    for (std::size_t node = 0; node < nodes(); ++node) {
        std::size_t from = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const std::size_t i = node / stride_[k] % axes_[k].size();
            from += ((mirrored >> k & 1) != 0 ? axes_[k].size() - 1 - i : i) * stride_[k];
        }
        for (std::size_t mask = 0; mask < std::size_t{1} << n; ++mask) {
            const bool odd = (std::popcount(static_cast<unsigned>(mask) & mirrored) & 1) != 0;
            hermite[(node << n) + mask] = (odd ? -factor : factor) * nodes_[(from << n) + mask];
        }
    }
    return {std::move(turned), std::move(hermite)};
}

}  // namespace underbody::tables
