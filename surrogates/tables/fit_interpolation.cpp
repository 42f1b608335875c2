// Exact interpolation of a full grid, and the error that it makes between the points.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "surrogates/tables/fit.h"
#include "surrogates/tables/force_table_impl.h"

namespace underbody::tables {

namespace {

/// What the interpolation misses at a point of a line when that point is left out. Smooth data would let the error of the joined cell
/// of width H shrink with its square or faster, points that just resolve the curve only in proportion: a cell of width h
/// beside the point is taken to miss (h/H)^1.5 of it, and no cell less than half of what is usual on its line.
std::vector<double> cell_errors(SlopeRule rule, const std::vector<double>& x, const std::vector<double>& y) {
    const std::size_t n = x.size();
    std::vector<double> error(n - 1, 0.0);
    if (n < 3) {
        // Nothing tells how it bends between two points: as if the slope changed by its own size from end to end.
        error[0] = 0.25 * std::abs(y[1] - y[0]);
        return error;
    }
    double usual = 0;
    for (std::size_t left_out = 1; left_out + 1 < n; ++left_out) {
        std::vector<double> rest_x, rest_y;
        // Nine points around it see all that its neighbours' slopes use.
        const std::size_t begin = left_out >= 5 ? left_out - 5 : 0;
        const std::size_t end = std::min(n, left_out + 6);
        for (std::size_t i = begin; i < end; ++i) {
            if (i != left_out) {
                rest_x.push_back(x[i]);
                rest_y.push_back(y[i]);
            }
        }
        const CubicGrid without({rest_x}, rest_y, rule);
        const double miss = std::abs(without.value(&x[left_out], nullptr) - y[left_out]);
        const double width = x[left_out + 1] - x[left_out - 1];
        for (const std::size_t cell : {left_out - 1, left_out}) {
            error[cell] = std::max(error[cell], miss * std::pow((x[cell + 1] - x[cell]) / width, 1.5));
        }
        usual += miss * miss / static_cast<double>(n - 2);
    }
    // Where few points turn a curve sharply the misses can be small by luck: no cell is surer than a quarter of what its bend
    // (secant differences) would move a straight line twice over; at the ends the bend is known on one side only.
    const auto bend = [&](std::size_t i) { return std::abs((y[i + 1] - y[i]) / (x[i + 1] - x[i]) - (y[i] - y[i - 1]) / (x[i] - x[i - 1])); };
    for (std::size_t cell = 0; cell + 1 < n; ++cell) {
        const double left = cell > 0 ? bend(cell) : 2 * bend(1);
        const double right = cell + 2 < n ? bend(cell + 1) : 2 * bend(n - 2);
        const double from_bend = 0.25 * (x[cell + 1] - x[cell]) * std::max(left, right);
        error[cell] = std::max({error[cell], 0.5 * std::pow(0.5, 1.5) * std::sqrt(usual), from_bend});
    }
    return error;
}

/// Per cell of axis k the largest error over all grid lines along it.
std::vector<double> cell_errors(SlopeRule rule, const CubicGrid& grid, const std::vector<double>& values, std::size_t k) {
    std::size_t stride = 1;
    for (std::size_t j = grid.dimensions(); j-- > k + 1;) {
        stride *= grid.axis(j).size();
    }
    const std::vector<double>& x = grid.axis(k).points();
    std::vector<double> worst(x.size() - 1, 0.0);
    std::vector<double> line(x.size());
    for (std::size_t start = 0; start < values.size(); ++start) {
        if (start / stride % x.size() != 0) {
            continue;
        }
        for (std::size_t i = 0; i < x.size(); ++i) {
            line[i] = values[start + i * stride];
        }
        const auto error = cell_errors(rule, x, line);
        for (std::size_t i = 0; i < error.size(); ++i) {
            worst[i] = std::max(worst[i], error[i]);
        }
    }
    return worst;
}

}  // namespace

std::vector<double> interpolation_misses(const SetPoints& points, std::size_t at_most) {
    const std::size_t n = points.axes.size();
    std::vector<double> misses(points.x.size(), std::nan(""));
    std::size_t inner = 1;
    for (const auto& axis : points.axes) {
        inner *= axis.points.size() - std::min<std::size_t>(axis.points.size(), 2);
    }
    // Steps without a common factor with the grid meet all its lines in turn, not one again and again.
    std::size_t every = inner <= at_most ? 1 : (inner + at_most - 1) / at_most;
    while (inner > 0 && std::gcd(every, inner) > 1) {
        ++every;
    }
    for (std::size_t count = 0; count < inner; count += every) {
        std::size_t index[CubicGrid::max_axes];
        std::size_t rest = count, node = 0, stride = 1;
        for (std::size_t k = n; k-- > 0;) {
            const std::size_t size = points.axes[k].points.size();
            index[k] = 1 + rest % (size - 2);
            rest /= size - 2;
            node += index[k] * stride;
            stride *= size;
        }
        double sum = 0;
        stride = 1;
        for (std::size_t k = n; k-- > 0;) {
            const auto& x = points.axes[k].points;
            const std::size_t i = index[k];
            std::vector<double> rest_x, rest_y;
            for (std::size_t j = i >= 5 ? i - 5 : 0; j < std::min(x.size(), i + 6); ++j) {
                if (j != i) {
                    rest_x.push_back(x[j]);
                    rest_y.push_back(points.value[points.order[node + j * stride - i * stride]]);
                }
            }
            sum += CubicGrid({rest_x}, rest_y, SlopeRule::monotone).value(&x[i], nullptr);
            stride *= x.size();
        }
        misses[points.order[node]] = sum / static_cast<double>(n) - points.value[points.order[node]];
    }
    return misses;
}

ErrorModel::Growth end_growth(const CubicGrid& grid, std::size_t k) {
    const std::size_t n = grid.dimensions();
    std::size_t stride = 1;
    for (std::size_t j = n; j-- > k + 1;) {
        stride *= grid.axis(j).size();
    }
    const auto& x = grid.axis(k).points();
    const double span = x.back() - x.front();
    // Slope over the last tenth of the points, at least one cell.
    const std::size_t m = std::max<std::size_t>(1, (x.size() - 1) / 10);
    double low = INFINITY, high = -INFINITY, below = 0, above = 0;
    for (std::size_t node = 0; node < grid.nodes(); ++node) {
        const auto value = [&](std::size_t i) { return grid.hermite()[i << n]; };
        low = std::min(low, value(node));
        high = std::max(high, value(node));
        if (node / stride % x.size() == 0) {
            below = std::max(below, std::abs(value(node + m * stride) - value(node)) / (x[m] - x[0]));
            const std::size_t last = node + (x.size() - 1) * stride;
            above = std::max(above, std::abs(value(last) - value(last - m * stride)) / (x.back() - x[x.size() - 1 - m]));
        }
    }
    return {std::max(below, (high - low) / span), std::max(above, (high - low) / span)};
}

std::shared_ptr<ForceTable::Impl> fit_interpolation(const SetPoints& points, const FitOptions& options) {
    auto table = std::make_shared<ForceTable::Impl>();
    table->quantity = points.quantity;
    table->unit = points.unit;
    table->source = points.table.source;
    table->axes = points.axes;
    table->remarks = points.remarks;
    table->points = points.table;
    table->constants = points.constants;
    table->rule = options.kind == FitOptions::Kind::spline ? SlopeRule::not_a_knot : SlopeRule::monotone;
    const std::size_t n = points.axes.size();
    table->kind = table->rule == SlopeRule::not_a_knot ? "not-a-knot cubic spline" : "monotone cubic";
    if (n > 1) {
        table->kind += n == 2 ? ", two axes" : n == 3 ? ", three axes" : ", four axes";
    }
    std::vector<std::vector<double>> grid;
    for (const auto& axis : points.axes) {
        grid.push_back(axis.points);
    }
    std::vector<double> values(points.order.size());
    std::vector<double> sigma(points.order.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = points.value[points.order[i]];
        sigma[i] = points.has_sigma() ? points.sigma[points.order[i]] : 0;
    }
    table->surface = CubicGrid(grid, values, table->rule);
    table->error = ErrorModel(grid, std::move(sigma));
    for (std::size_t k = 0; k < n; ++k) {
        table->error.set_cell_error(k, cell_errors(table->rule, table->surface, values, k));
        table->error.set_growth(k, end_growth(table->surface, k));
        if (grid[k].size() == 2) {
            table->remarks.push_back({core::Problem::Severity::note,
                                      "two points along " + points.axes[k].name + " do not tell what lies between them: a quarter of their difference is taken as its error",
                                      {points.table.source, {}, {}, {}}});
        }
    }
    return table;
}

}  // namespace underbody::tables
