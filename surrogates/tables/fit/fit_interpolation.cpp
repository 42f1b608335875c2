// Exact interpolation of a full grid, and the error that it makes between the points.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "surrogates/tables/fit/fit.h"
#include "surrogates/tables/fit/force_table_impl.h"

namespace underbody::tables {

namespace {

/// Gaps that span a factor of four and more act through their logarithm: there the forces are smoother.
std::vector<double> smooth_coordinate(std::vector<double> x) {
    if (x.front() > 0 && x.back() / x.front() >= 4) {
        for (double& v : x) {
            v = std::log(v);
        }
    }
    return x;
}

/// Per cell of a line of four points and more the mean square of how far the interpolation is from the one by the other
/// rule, in the smooth coordinate, as in the middle of the cell: both go through the points, and what they disagree by
/// is about what either misses.
std::vector<double> disagreement(SlopeRule rule, const CubicGrid& own, const std::vector<double>& x,
                                 const std::vector<double>& y) {
    const std::vector<double> t = smooth_coordinate(x);
    const CubicGrid other({t}, y, rule == SlopeRule::monotone ? SlopeRule::not_a_knot : SlopeRule::monotone);
    // Two rules often cross near the middle of a cell and agree there by chance: five places, each over the shape that
    // an error has there.
    constexpr std::array<double, 5> places = {0.15, 0.3, 0.5, 0.7, 0.85};
    std::vector<double> apart;
    for (std::size_t cell = 0; cell + 1 < x.size(); ++cell) {
        double square = 0;
        for (const double place : places) {
            const double at = x[cell] + place * (x[cell + 1] - x[cell]);
            const double there = t.front() == x.front() ? at : std::log(at);
            const double shape = 4 * place * (1 - place);
            square += std::pow((own.value(&at, nullptr) - other.value(&there, nullptr)) / shape, 2);
        }
        apart.push_back(square / static_cast<double>(places.size()));
    }
    return apart;
}

/// What the interpolation misses at the inner points of a line when each is left out; the first and the last entry are
/// 0.
std::vector<double> left_out_misses(SlopeRule rule, const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<double> misses(x.size(), 0.0);
    for (std::size_t out = 1; out + 1 < x.size(); ++out) {
        std::vector<double> rest_x, rest_y;
        // Ten points around it see all that its neighbours' slopes use.
        for (std::size_t i = out >= 5 ? out - 5 : 0; i < std::min(x.size(), out + 6); ++i) {
            if (i != out) {
                rest_x.push_back(x[i]);
                rest_y.push_back(y[i]);
            }
        }
        misses[out] = CubicGrid({rest_x}, rest_y, rule).value(&x[out], nullptr) - y[out];
    }
    return misses;
}

double mean_square(const std::vector<double>& v) {
    return std::inner_product(v.begin(), v.end(), v.begin(), 0.0) / static_cast<double>(v.size());
}

/// With which power of the width of a cell the misses of a line shrink. The rule's own power is 4, at an extremum 2;
/// few points do not resolve the force and show 1 like a kink, each point more 0.6 more. Noise is no smaller in narrow
/// cells: where the scatter found in the points is a tenth of their misses and more, 0.75. The misses of every other
/// point, against those of all, tell it worse: they are too few. Set on seeds 0 to 559 of the simulated forces in
/// November 2026; what other powers and shares give: docs/adr/0009-own-interpolation.md.
double order_of(const std::vector<double>& misses, const std::vector<double>& noise) {
    const double of_points = std::clamp(0.6 * (static_cast<double>(misses.size()) - 3), 1.0, 3.5);
    const double scatter = mean_square(noise), missed = mean_square(misses);
    const double noisy = scatter > 0 ? std::min(1.0, 10 * std::sqrt(scatter / missed)) : 0;
    return of_points + (0.75 - of_points) * noisy;
}

/// The share of the square of what left-out points are missed by that counts beside what the rules disagree by, which
/// has seen a part of it.
constexpr double of_misses = 0.5;

/// The root of a square less what noise makes of it.
double beyond_noise(double square, double of_noise) { return std::sqrt(std::max(0.0, square - of_noise)); }

/// Of two points, whose line nothing tells to bend, and of three.
std::vector<double> cell_errors_of_few(const std::vector<double>& x, const std::vector<double>& y) {
    if (x.size() == 2) {
        // Nothing tells how it bends between two points: as if the slope changed by its own size from end to end.
        return {0.25 * std::abs(y[1] - y[0])};
    }
    // An eighth of the change of slope is what a parabola leaves a straight line.
    const double bend = std::abs((y[2] - y[1]) / (x[2] - x[1]) - (y[1] - y[0]) / (x[1] - x[0]));
    return {0.125 * (x[1] - x[0]) * bend, 0.125 * (x[2] - x[1]) * bend};
}

/// The standard error in the middle of each cell of a line; `noise` of its points is not counted here, for they carry
/// it themselves. Over neighbours and lines sizes are averaged, not squares: a band that holds two thirds follows the
/// usual error, and the square of a few large ones made it too wide for all others.
std::vector<double> cell_errors(SlopeRule rule, const std::vector<double>& x, const std::vector<double>& y,
                                const std::vector<double>& noise) {
    const std::size_t n = x.size();
    if (n < 4) {
        return cell_errors_of_few(x, y);
    }
    const auto apart = disagreement(rule, CubicGrid({x}, y, rule), x, y);
    const auto t = smooth_coordinate(x);
    const auto misses = left_out_misses(rule, x, y);
    const double order = order_of(misses, noise);
    std::vector<double> error;
    for (std::size_t cell = 0; cell + 1 < n; ++cell) {
        // With its neighbours, because one cell may agree by luck; those at the ends are seen from one side only.
        double by_rule = 0, weight = 0;
        for (std::size_t i = cell == 0 ? 0 : cell - 1; i <= std::min(n - 2, cell + 1); ++i) {
            const double w = i == cell ? 2 : 1;
            // Noise makes the two rules differ by a third of it, and a left-out point by a little more than itself.
            by_rule += w * beyond_noise(apart[i], 0.05 * (noise[i] * noise[i] + noise[i + 1] * noise[i + 1]));
            weight += w;
        }
        by_rule /= weight;
        double missed = weight = 0;
        for (std::size_t out = std::max<std::size_t>(2, cell) - 1; out <= std::min(n - 2, cell + 2); ++out) {
            const double share = std::pow((t[cell + 1] - t[cell]) / (t[out + 1] - t[out - 1]), order);
            missed += share * beyond_noise(misses[out] * misses[out], 1.6 * noise[out] * noise[out]);
            weight += 1;
        }
        error.push_back(std::hypot(by_rule, std::sqrt(of_misses) * missed / weight));
    }
    return error;
}

/// Per cell of axis k the mean over all grid lines along it.
std::vector<double> cell_errors(SlopeRule rule, const CubicGrid& grid, const std::vector<double>& values,
                                const std::vector<double>& noise, std::size_t k) {
    std::size_t stride = 1;
    for (std::size_t j = grid.dimensions(); j-- > k + 1;) {
        stride *= grid.axis(j).size();
    }
    const std::vector<double>& x = grid.axis(k).points();
    std::vector<double> mean(x.size() - 1, 0.0);
    double lines = 0;
    std::vector<double> line(x.size()), of_line(x.size());
    for (std::size_t start = 0; start < values.size(); ++start) {
        if (start / stride % x.size() != 0) {
            continue;
        }
        for (std::size_t i = 0; i < x.size(); ++i) {
            line[i] = values[start + i * stride];
            of_line[i] = noise[start + i * stride];
        }
        const auto error = cell_errors(rule, x, line, of_line);
        for (std::size_t i = 0; i < error.size(); ++i) {
            mean[i] += error[i];
        }
        ++lines;
    }
    for (double& v : mean) {
        v /= lines;
    }
    return mean;
}

/// The errors of the axes are independent, but an ErrorModel adds them: all get the factor by which their sum is too
/// large. One over the root of their number where they are alike, one where a single axis makes the error.
void add_in_squares(std::vector<std::vector<double>>& cells) {
    double sum = 0, squares = 0;
    for (const auto& axis : cells) {
        const double square = mean_square(axis);
        sum += std::sqrt(square);
        squares += square;
    }
    for (auto& axis : cells) {
        for (double& v : axis) {
            v *= sum > 0 ? std::sqrt(squares) / sum : 1;
        }
    }
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
            above =
                std::max(above, std::abs(value(last) - value(last - m * stride)) / (x.back() - x[x.size() - 1 - m]));
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
        sigma[i] = points.noise(points.order[i]);
    }
    table->surface = CubicGrid(grid, values, table->rule);
    table->error = ErrorModel(grid, sigma);
    std::vector<std::vector<double>> cells;
    for (std::size_t k = 0; k < n; ++k) {
        cells.push_back(cell_errors(table->rule, table->surface, values, sigma, k));
    }
    add_in_squares(cells);
    for (std::size_t k = 0; k < n; ++k) {
        table->error.set_cell_error(k, std::move(cells[k]));
        table->error.set_growth(k, end_growth(table->surface, k));
        if (grid[k].size() == 2) {
            table->remarks.push_back(
                {core::Problem::Severity::note,
                 "two points along " + points.axes[k].name +
                     " do not tell what lies between them: a quarter of their difference is taken as its error",
                 {points.table.source, {}, {}, {}}});
        }
    }
    return table;
}

}  // namespace underbody::tables
