// The error of a table between and beyond its points.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "surrogates/tables/fit/grid.h"

namespace underbody::tables {

/// Standard deviation on a tensor grid: multilinear between the nodes, plus, for interpolated tables, the interpolation
/// error that rises from zero at the points to its cell's value in the middle (cell * 4 t (1 - t), every axis), plus a
/// linear growth beyond the ends. The parts are added, not squared: errors of one table are not independent, and a
/// controller can evaluate it without a square root.
class ErrorModel {
public:
    ErrorModel() = default;
    /// `node_sigma` on the grid `points`, last axis fastest.
    ErrorModel(std::vector<std::vector<double>> points, std::vector<double> node_sigma);

    /// One number a cell along axis k: the standard error of the interpolation in the middle of the cell.
    void set_cell_error(std::size_t k, std::vector<double> error);
    /// How fast the standard deviation grows below and above the ends of axis k, per SI unit of the axis.
    using Growth = std::array<double, 2>;
    void set_growth(std::size_t k, Growth per_unit) { growth_[k] = per_unit; }

    /// Zero everywhere?
    [[nodiscard]] bool empty() const { return sigma_.empty(); }
    /// Standard deviation at a point; `beyond` (one entry per axis) is how far it lies outside.
    [[nodiscard]] double sigma(const double* point, const double* beyond) const noexcept;

    /// On other grid lines inside the axes, never less than this one: a node is raised by what the nodes that went rise
    /// over the straight line between it and its neighbours, a cell that joins several has the largest error of theirs.
    [[nodiscard]] ErrorModel resampled(std::vector<std::vector<double>> points) const;
    /// Likewise for a consumer that knows nodes only: they carry the cells' errors too, and `more` for all that
    /// straight lines between them miss.
    [[nodiscard]] ErrorModel straightened(std::vector<std::vector<double>> points, double more) const;

    [[nodiscard]] const std::vector<GridAxis>& axes() const { return axes_; }
    [[nodiscard]] const std::vector<double>& node_sigma() const { return sigma_; }
    [[nodiscard]] const std::vector<double>& cell_error(std::size_t k) const { return cell_error_[k]; }
    [[nodiscard]] const Growth& growth(std::size_t k) const { return growth_[k]; }

private:
    [[nodiscard]] double between_nodes(const std::size_t* cell, const double* fraction) const noexcept;
    [[nodiscard]] ErrorModel nodes_on(std::vector<std::vector<double>> points) const;
    void add_along(std::size_t k, const std::vector<double>& more);
    std::vector<GridAxis> axes_;
    std::vector<double> sigma_;
    std::array<std::vector<double>, CubicGrid::max_axes> cell_error_;
    std::array<Growth, CubicGrid::max_axes> growth_{};
};

}  // namespace underbody::tables
