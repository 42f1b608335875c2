#include "surrogates/tables/fit.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/random.h"
#include "surrogates/tables/force_table_impl.h"

namespace underbody::tables {

using core::InputError;

std::shared_ptr<const ForceTable::Impl> fit_points(const SetPoints& points, const FitOptions& options) {
    if (!points.full_grid) {
        throw InputError("grid", "the points do not fill a grid, which interpolation needs" + (points.missing.empty() ? "" : ": " + points.missing),
                         {points.table.source, {}, {}, {}}, "fit a Gaussian process, or add the missing set points");
    }
    return fit_interpolation(points, options);
}

namespace {

/// Lower Cholesky factor of a correlation matrix along one axis: exp(-(distance/length)^2/2), length a quarter of the span.
std::vector<double> correlation_factor(const std::vector<double>& x) {
    const std::size_t n = x.size();
    const double length = 0.25 * (x.back() - x.front());
    std::vector<double> factor(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const double d = (x[i] - x[j]) / length;
            double sum = i == j ? 1.0 + 1e-8 : std::exp(-0.5 * d * d);
            for (std::size_t k = 0; k < j; ++k) {
                sum -= factor[i * n + k] * factor[j * n + k];
            }
            factor[i * n + j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / factor[j * n + j];
        }
    }
    return factor;
}

}  // namespace

std::shared_ptr<const ForceTable::Impl> drawn_from(const ForceTable::Impl& table, std::uint64_t seed) {
    auto drawn = std::make_shared<ForceTable::Impl>(table);
    const CubicGrid& grid = table.surface;
    const std::size_t n = grid.dimensions();
    const std::size_t count = grid.nodes();
    core::Random random(seed);
    std::vector<double> field(count);
    for (double& z : field) {
        z = random.normal();
    }
    std::vector<std::vector<double>> points;
    std::size_t stride = count;
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = grid.axis(k).points();
        points.push_back(x);
        stride /= x.size();
        const auto factor = correlation_factor(x);
        std::vector<double> line(x.size());
        for (std::size_t start = 0; start < count; ++start) {
            if (start / stride % x.size() != 0) {
                continue;
            }
            for (std::size_t i = 0; i < x.size(); ++i) {
                line[i] = 0;
                for (std::size_t j = 0; j <= i; ++j) {
                    line[i] += factor[i * x.size() + j] * field[start + j * stride];
                }
            }
            for (std::size_t i = 0; i < x.size(); ++i) {
                field[start + i * stride] = line[i];
            }
        }
    }
    std::vector<double> values(count);
    std::vector<double> at(n);
    for (std::size_t node = 0; node < count; ++node) {
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            at[k] = points[k][rest % points[k].size()];
            rest /= points[k].size();
        }
        values[node] = grid.hermite()[node << n] + field[node] * table.error.sigma(at.data(), nullptr);
    }
    drawn->surface = CubicGrid(std::move(points), values, table.rule);
    drawn->kind += ", drawn";
    return drawn;
}

}  // namespace underbody::tables
