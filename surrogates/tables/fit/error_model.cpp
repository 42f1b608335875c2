#include "surrogates/tables/fit/error_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

namespace underbody::tables {

ErrorModel::ErrorModel(std::vector<std::vector<double>> points, std::vector<double> node_sigma)
    : sigma_(std::move(node_sigma)) {
    std::size_t count = 1;
    for (auto& axis : points) {
        count *= axis.size();
        axes_.emplace_back(std::move(axis));
    }
    assert(count == sigma_.size());
}

void ErrorModel::set_cell_error(std::size_t k, std::vector<double> error) {
    assert(error.size() + 1 == axes_[k].size());
    cell_error_[k] = std::move(error);
}

double ErrorModel::sigma(const double* point, const double* beyond) const noexcept {
    if (sigma_.empty()) {
        return 0;
    }
    const std::size_t n = axes_.size();
    double fraction[CubicGrid::max_axes] = {};
    std::size_t cell[CubicGrid::max_axes] = {};
    double result = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const GridAxis& axis = axes_[k];
        if (std::isnan(point[k])) {
            return point[k];
        }
        const double x = std::clamp(point[k], axis.lower(), axis.upper());
        cell[k] = axis.cell(x);
        const double start = axis.points()[cell[k]];
        fraction[k] = (x - start) / (axis.points()[cell[k] + 1] - start);
        if (!cell_error_[k].empty()) {
            result += cell_error_[k][cell[k]] * 4 * fraction[k] * (1 - fraction[k]);
        }
        result += beyond != nullptr ? std::abs(beyond[k]) * growth_[k][beyond[k] < 0 ? 0 : 1] : 0;
    }
    return result + between_nodes(cell, fraction);
}

/// Multilinear; fractions of the cell's width.
double ErrorModel::between_nodes(const std::size_t* cell, const double* fraction) const noexcept {
    const std::size_t n = axes_.size();
    double result = 0;
    for (std::size_t corner = 0; corner < std::size_t{1} << n; ++corner) {
        double weight = 1;
        std::size_t node = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const bool upper = (corner >> k & 1) != 0;
            weight *= upper ? fraction[k] : 1 - fraction[k];
            node = node * axes_[k].size() + cell[k] + (upper ? 1 : 0);
        }
        result += weight * sigma_[node];
    }
    return result;
}

namespace {

/// One line of numbers at places `from`, of which `kept` are left: straight lines between the new numbers are nowhere
/// below the old ones. By what the numbers between two that stay rise over the straight line between these, or, where
/// that is less in all, by the largest of those that go.
void cover_line(const std::vector<double>& from, const std::vector<std::size_t>& kept, const std::vector<double>& line,
                std::vector<double>& above) {
    const std::size_t count = kept.size();
    std::vector<double> rise(count + 1, 0.0), largest(count);  // rise[i]: between kept i - 1 and i
    for (std::size_t i = 0; i < count; ++i) {
        largest[i] = line[kept[i]];
    }
    for (std::size_t i = 0; i + 1 < count; ++i) {
        const std::size_t low = kept[i], high = kept[i + 1];
        for (std::size_t j = low + 1; j < high; ++j) {
            const double share = (from[j] - from[low]) / (from[high] - from[low]);
            rise[i + 1] = std::max(rise[i + 1], line[j] - ((1 - share) * line[low] + share * line[high]));
            largest[i] = std::max(largest[i], line[j]);
            largest[i + 1] = std::max(largest[i + 1], line[j]);
        }
    }
    double sum = 0, sum_of_largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        above[i] = line[kept[i]] + std::max(rise[i], rise[i + 1]);
        sum += above[i];
        sum_of_largest += largest[i];
    }
    if (sum_of_largest < sum) {
        above = largest;
    }
}

/// Numbers on a grid whose axis k, `stride` nodes apart, has the lines `from`: of these `to` are left.
std::vector<double> covered_on(const std::vector<double>& numbers, std::size_t stride, const std::vector<double>& from,
                               const std::vector<double>& to) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < from.size() && kept.size() < to.size(); ++i) {
        if (from[i] == to[kept.size()]) {
            kept.push_back(i);
        }
    }
    assert(kept.size() == to.size());
    std::vector<double> result(numbers.size() / from.size() * to.size()), line(from.size()), above(to.size());
    for (std::size_t one = 0; one < numbers.size() / from.size(); ++one) {
        const std::size_t old_begin = one / stride * from.size() * stride + one % stride;
        const std::size_t new_begin = one / stride * to.size() * stride + one % stride;
        for (std::size_t j = 0; j < from.size(); ++j) {
            line[j] = numbers[old_begin + j * stride];
        }
        cover_line(from, kept, line, above);
        for (std::size_t i = 0; i < to.size(); ++i) {
            result[new_begin + i * stride] = above[i];
        }
    }
    return result;
}

/// 4 t (1 - t) of a place in a cell.
double bump(double low, double high, double x) { return 4 * (x - low) * (high - x) / ((high - low) * (high - low)); }

/// Errors of the cells of one axis, seen from other lines.
struct CellErrors {
    const std::vector<double>& x;
    const std::vector<double>& error;

    [[nodiscard]] std::size_t cell(double place) const {
        return static_cast<std::size_t>(std::upper_bound(x.begin() + 1, x.end() - 1, place) - x.begin()) - 1;
    }
    [[nodiscard]] double at(double place) const {
        return error[cell(place)] * bump(x[cell(place)], x[cell(place) + 1], place);
    }
    /// f(error, lower end, upper end) of every cell that overlaps with a range; the largest.
    template <class F>
    [[nodiscard]] double largest(double low, double high, F&& f) const {
        double result = 0;
        for (std::size_t j = cell(low); j < error.size() && x[j] < high; ++j) {
            result = std::max(result, f(error[j], x[j], x[j + 1]));
        }
        return result;
    }
    /// Of the function itself.
    [[nodiscard]] double largest_within(double low, double high) const {
        return largest(low, high, [&](double e, double from, double to) {
            return e * bump(from, to, std::clamp(0.5 * (from + to), low, high));
        });
    }
    /// What rises between two lines over the straight line through its ends.
    [[nodiscard]] double rise(double low, double high) const {
        return largest(low, high, [&](double e, double from, double to) {
            const double share = (high - low) / (to - from);
            return from <= low && high <= to ? e * share * share : e;
        });
    }
};

}  // namespace

/// The part between the nodes, and the growth.
ErrorModel ErrorModel::nodes_on(std::vector<std::vector<double>> points) const {
    const std::size_t n = axes_.size();
    std::vector<std::vector<double>> all(n);  // lines of both
    std::size_t count = 1;
    for (std::size_t k = 0; k < n; ++k) {
        const auto& own = axes_[k].points();
        std::set_union(own.begin(), own.end(), points[k].begin(), points[k].end(), std::back_inserter(all[k]));
        count *= all[k].size();
    }
    std::vector<double> sigma(count);
    for (std::size_t node = 0; node < count; ++node) {
        double fraction[CubicGrid::max_axes];
        std::size_t cell[CubicGrid::max_axes];
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            const double x = all[k][rest % all[k].size()];
            rest /= all[k].size();
            cell[k] = axes_[k].cell(x);
            const double start = axes_[k].points()[cell[k]];
            fraction[k] = (x - start) / (axes_[k].points()[cell[k] + 1] - start);
        }
        sigma[node] = between_nodes(cell, fraction);
    }
    std::size_t stride = 1;
    for (std::size_t k = n; k-- > 0;) {
        sigma = covered_on(sigma, stride, all[k], points[k]);
        stride *= points[k].size();
    }
    ErrorModel result(std::move(points), std::move(sigma));
    result.growth_ = growth_;
    return result;
}

/// more[i] to every node of line i of an axis.
void ErrorModel::add_along(std::size_t k, const std::vector<double>& more) {
    std::size_t stride = 1;
    for (std::size_t j = axes_.size(); j-- > k + 1;) {
        stride *= axes_[j].size();
    }
    for (std::size_t node = 0; node < sigma_.size(); ++node) {
        sigma_[node] += more[node / stride % more.size()];
    }
}

ErrorModel ErrorModel::resampled(std::vector<std::vector<double>> points) const {
    ErrorModel result = nodes_on(std::move(points));
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        if (cell_error_[k].empty()) {
            continue;
        }
        const CellErrors own{axes_[k].points(), cell_error_[k]};
        const auto& x = result.axes_[k].points();
        std::vector<double> at_lines, cells;
        for (std::size_t i = 0; i < x.size(); ++i) {
            at_lines.push_back(own.at(x[i]));
            if (i + 1 < x.size()) {
                cells.push_back(own.rise(x[i], x[i + 1]));
            }
        }
        result.add_along(k, at_lines);
        result.set_cell_error(k, std::move(cells));
    }
    return result;
}

ErrorModel ErrorModel::straightened(std::vector<std::vector<double>> points, double more) const {
    ErrorModel result = nodes_on(std::move(points));
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        if (cell_error_[k].empty()) {
            continue;
        }
        const CellErrors own{axes_[k].points(), cell_error_[k]};
        const auto& x = result.axes_[k].points();
        std::vector<double> around(x.size(), 0.0);
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            const double largest = own.largest_within(x[i], x[i + 1]);
            around[i] = std::max(around[i], largest);
            around[i + 1] = std::max(around[i + 1], largest);
        }
        result.add_along(k, around);
    }
    for (double& s : result.sigma_) {
        s += more;
    }
    return result;
}

}  // namespace underbody::tables
