// How far a function on other grid lines is from the one it was taken of.
#include <algorithm>
#include <cmath>

#include "surrogates/tables/exports/export_grid.h"
#include "surrogates/tables/fit/error_model.h"

namespace underbody::tables {

namespace {

/// Differences are sampled, between the samples they may be a little larger.
constexpr double margin = 1.02;

/// Ends, middles and quarters of the cells between the lines; fewer a cell for many axes.
std::vector<double> sample_points(const std::vector<double>& lines, std::size_t axes) {
    const std::size_t a_cell = axes == 1 ? 8 : axes == 2 ? 4 : 2;
    std::vector<double> result;
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
        for (std::size_t j = 0; j < a_cell; ++j) {
            result.push_back(lines[i] +
                             (lines[i + 1] - lines[i]) * static_cast<double>(j) / static_cast<double>(a_cell));
        }
    }
    result.push_back(lines.back());
    return result;
}

/// The point of the grid that the coordinates span, last fastest.
void point_of(const std::vector<std::vector<double>>& coordinates, std::size_t index, double* point) {
    for (std::size_t k = coordinates.size(); k-- > 0;) {
        point[k] = coordinates[k][index % coordinates[k].size()];
        index /= coordinates[k].size();
    }
}

/// margin times the largest size of f over all points of the grid that these coordinates span, and around the worst of
/// them.
template <class F>
double largest(const std::vector<std::vector<double>>& coordinates, core::Progress& progress, F&& f) {
    std::size_t count = 1;
    for (const auto& x : coordinates) {
        count *= x.size();
    }
    double worst = -1;
    std::size_t where = 0;
    double at[CubicGrid::max_axes];
    for (std::size_t i = 0; i < count; ++i) {
        if (i % 4096 == 0) {
            progress.check();
        }
        point_of(coordinates, i, at);
        if (const double size = std::abs(f(at)); size > worst) {
            worst = size;
            where = i;
        }
    }
    point_of(coordinates, where, at);
    for (double share = 0.5; share > 1e-3; share /= 2) {
        for (std::size_t k = 0; k < coordinates.size(); ++k) {
            const auto& x = coordinates[k];
            const auto above =
                static_cast<std::size_t>(std::upper_bound(x.begin() + 1, x.end() - 1, at[k]) - x.begin());
            for (const double step : {share * (x[above - 1] - x[above]), share * (x[above] - x[above - 1])}) {
                const double here = at[k];
                at[k] = std::clamp(here + step, x.front(), x.back());
                const double size = std::abs(f(at));
                at[k] = size > worst ? at[k] : here;
                worst = std::max(worst, size);
            }
        }
    }
    return margin * worst;
}

}  // namespace

double largest_difference_along(std::size_t axis, const CubicGrid& fine, const CubicGrid& coarse,
                                core::Progress& progress) {
    auto coordinates = coarse.points();
    coordinates[axis] = sample_points(fine.axis(axis).points(), fine.dimensions());
    return largest(coordinates, progress,
                   [&](const double* at) { return fine.value(at, nullptr) - coarse.value(at, nullptr); });
}

Resampled resampled(const CubicGrid& fine, std::vector<std::vector<double>> points, core::Progress& progress) {
    auto coordinates = fine.points();
    if (points == coordinates) {
        return {fine, 0};
    }
    CubicGrid coarse = fine.resampled(std::move(points));
    for (auto& x : coordinates) {
        x = sample_points(x, coordinates.size());
    }
    const double difference = largest(
        coordinates, progress, [&](const double* at) { return fine.value(at, nullptr) - coarse.value(at, nullptr); });
    return {std::move(coarse), difference};
}

Resampled straight_resampled(const CubicGrid& fine, std::vector<std::vector<double>> points, core::Progress& progress) {
    const std::size_t n = fine.dimensions();
    auto coordinates = fine.points();
    for (std::size_t k = 0; k < n; ++k) {
        std::vector<double> lines;
        std::set_union(coordinates[k].begin(), coordinates[k].end(), points[k].begin(), points[k].end(),
                       std::back_inserter(lines));
        coordinates[k] = sample_points(lines, n);
    }
    CubicGrid coarse = fine.resampled(points);
    std::vector<double> values;
    for (std::size_t i = 0; i < coarse.nodes(); ++i) {
        values.push_back(coarse.hermite()[i << n]);
    }
    const ErrorModel straight(std::move(points), std::move(values));  // multilinear between the nodes
    const double difference = largest(
        coordinates, progress, [&](const double* at) { return straight.sigma(at, nullptr) - fine.value(at, nullptr); });
    return {std::move(coarse), difference};
}

}  // namespace underbody::tables
