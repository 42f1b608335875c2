// Exact interpolation of a full grid, and the error that it makes between the points.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "surrogates/tables/fit.h"
#include "surrogates/tables/force_table_impl.h"

namespace underbody::tables {

namespace {

/// What the interpolation misses at a point of a line when that point is left out. The error in the joined cell of
/// width H shrinks at least as the square of the width, so a cell of width h beside the point misses (h/H)^2 of it.
std::vector<double> cell_errors(SlopeRule rule, const std::vector<double>& x, const std::vector<double>& y) {
    const std::size_t n = x.size();
    std::vector<double> error(n - 1, 0.0);
    if (n < 3) {
        return error;
    }
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
            const double share = (x[cell + 1] - x[cell]) / width;
            error[cell] = std::max(error[cell], miss * share * share);
        }
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

std::shared_ptr<ForceTable::Impl> fit_interpolation(const SetPoints& points, const FitOptions& options) {
    auto table = std::make_shared<ForceTable::Impl>();
    table->quantity = points.quantity;
    table->unit = points.unit;
    table->source = points.table.source;
    table->axes = points.axes;
    table->remarks = points.remarks;
    table->points = points.table;
    table->constants = points.constants;
    table->range = options.range;
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
        // Beyond the ends the table knows nothing but that the force may go on as steeply as it did on average.
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        table->error.set_growth(k, (*high - *low) / (points.axes[k].upper - points.axes[k].lower));
    }
    return table;
}

}  // namespace underbody::tables
