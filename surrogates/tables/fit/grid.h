// Piecewise cubic functions on tensor grids of one to four axes: constant-time look-up of value and slopes.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace underbody::tables {

/// How the slopes at the points are chosen.
enum class SlopeRule {
    monotone,   ///< fourth-order where the data are smooth, limited so that nothing overshoots (Fritsch and Carlson
                ///< 1980; Hyman 1983)
    not_a_knot  ///< of the cubic spline with not-a-knot ends (C2; may overshoot)
};

/// Ascending points with an index of uniform buckets: the cell of a coordinate in constant time.
class GridAxis {
public:
    GridAxis() = default;
    explicit GridAxis(std::vector<double> points);

    [[nodiscard]] const std::vector<double>& points() const { return x_; }
    [[nodiscard]] std::size_t size() const { return x_.size(); }
    [[nodiscard]] double lower() const { return lower_; }
    [[nodiscard]] double upper() const { return upper_; }

    /// Cell of a coordinate inside [lower, upper]; 0 .. size()-2.
    [[nodiscard]] std::size_t cell(double x) const noexcept {
        const auto bucket = static_cast<std::int32_t>((x - lower_) * per_unit_);
        std::size_t i = first_[bucket < last_bucket_ ? bucket : last_bucket_];
        // Always the same number of steps (one unless the axis is very uneven), and no branch that depends on x.
        i += x >= stop_[i] ? 1 : 0;
        for (unsigned step = 1; step < steps_; ++step) {
            i += x >= stop_[i] ? 1 : 0;
        }
        return i;
    }

private:
    std::vector<double> x_;
    std::vector<double> stop_;  ///< upper end of each cell; infinite for the last
    std::vector<std::uint32_t> first_;
    std::int32_t last_bucket_ = 0;
    unsigned steps_ = 0;  ///< largest number of cells that a bucket reaches beyond its first
    double lower_ = 0;
    double upper_ = 0;
    double per_unit_ = 0;
};

/// Slopes at the points of one line of data, d value / d x. At least two points.
void line_slopes(SlopeRule rule, std::span<const double> x, std::span<const double> value, std::span<double> slope);

/// C1 piecewise cubic in each axis (Hermite data at the nodes: value, slopes, cross slopes).
/// With the monotone rule the Bezier net of every cell lies between its smallest and largest corner, so that the
/// function nowhere leaves the range of the corners of its cell.
class CubicGrid {
public:
    static constexpr std::size_t max_axes = 4;

    CubicGrid() = default;
    /// `values` with the last axis fastest.
    CubicGrid(std::vector<std::vector<double>> points, std::span<const double> values, SlopeRule rule);
    /// From Hermite data as hermite() gives them.
    CubicGrid(std::vector<std::vector<double>> points, std::vector<double> hermite);

    /// All 2^dimensions derivatives (order as hermite()) at a point inside the axes.
    void derivatives(const double* point, double* result) const noexcept;
    /// The same function sampled, with its slopes, at other points (each axis inside this one's range).
    [[nodiscard]] CubicGrid resampled(std::vector<std::vector<double>> points) const;
    /// factor * function, and the axes whose bit is set in `mirrored` turned round (x -> -x).
    [[nodiscard]] CubicGrid transformed(double factor, unsigned mirrored) const;
    [[nodiscard]] std::vector<std::vector<double>> points() const;

    [[nodiscard]] std::size_t dimensions() const { return dimensions_; }
    [[nodiscard]] const GridAxis& axis(std::size_t k) const { return axes_[k]; }
    [[nodiscard]] std::size_t nodes() const { return nodes_.size() >> dimensions_; }
    /// Hermite data of all nodes (last axis fastest), 2^dimensions numbers a node: entry m is the derivative once along
    /// every axis k whose bit k is set in m.
    [[nodiscard]] const std::vector<double>& hermite() const { return nodes_; }

    /// Value at a point, held at the ends of each axis (slope 0 beyond); `slope` may be null. NaN in, NaN out.
    double value(const double* point, double* slope) const noexcept;
    /// value() of many points, bit for bit, several times as fast on two axes: `points` [count * dimensions], `value`
    /// [count], `slope` (may be null) [count * dimensions].
    void values(const double* points, std::size_t count, double* value, double* slope) const noexcept;
    /// value() to rounding, but beyond the ends of the axes whose bit is set in `going_on` the function goes on along
    /// its tangent: C1 there, linear in each of these coordinates, with the slopes of that function. A NaN on any axis
    /// gives NaN.
    double continued(const double* point, double* slope, unsigned going_on) const noexcept;

    /// Where a coordinate lies: cell, distance from its lower end, and whether it had to be held.
    struct Spot {
        std::size_t cell = 0;
        double offset = 0;
        bool held = false;
    };
    [[nodiscard]] Spot spot(std::size_t k, double x) const noexcept {
        const GridAxis& a = axes_[k];
        double inside = x > a.lower() ? x : a.lower();  // a NaN goes to the lower end
        inside = inside < a.upper() ? inside : a.upper();
        Spot s;
        s.held = !(x == inside);
        s.cell = a.cell(inside);
        s.offset = std::isnan(x) ? x : inside - a.points()[s.cell];
        return s;
    }

private:
    void set_axes(std::vector<std::vector<double>> points);
    void limit_cross_slopes();
    void limit_node(std::size_t node, std::span<const std::size_t> index);
    void build_cells();
    /// Hermite functions of the cell where a point lies.
    struct CellWeights {
        double of[max_axes][2][2][2];  ///< [axis][differentiated][corner][derivative]
        std::size_t node;              ///< lowest corner of the cell
        bool held[max_axes];           ///< the point lies beyond the axis, the functions are those at its end
    };
    void set_weights(const double* point, CellWeights& weights) const noexcept;
    [[nodiscard]] double sum(const CellWeights& weights, std::size_t differentiated) const noexcept;
    double value_1(double x, double* slope) const noexcept;
    double value_2(const double* point, double* slope) const noexcept;

    std::vector<GridAxis> axes_;
    std::size_t dimensions_ = 0;
    std::size_t bicubic_columns_ = 0;             ///< cells along the second of two axes
    std::array<std::size_t, max_axes> stride_{};  ///< in nodes
    /// Bicubic coefficients of one cell, powers of the first axis side by side; two cache lines.
    struct alignas(64) Bicubic {
        double c[16];
    };
    std::vector<double> nodes_;
    std::vector<double> cells_;      ///< one axis: four polynomial coefficients a cell
    std::vector<Bicubic> bicubics_;  ///< two axes
};

}  // namespace underbody::tables
