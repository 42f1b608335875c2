#include "surrogates/tables/error_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
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

}  // namespace underbody::tables
