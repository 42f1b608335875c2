// Force against gap, pitch, speed, jet: a table that knows its range and its error.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"

namespace underbody::tables {

inline constexpr std::size_t max_axes = 4;

struct TableAxis {
    std::string name;  ///< a quantity name: gap, pitch, speed, jet_voltage, ...
    std::string unit;  ///< SI
    double lower = 0;
    double upper = 0;
    std::vector<double> points;  ///< distinct set points, ascending
};

/// What happens outside the points of an axis.
enum class RangePolicy {
    clamp,        ///< hold the end value, slope zero, flagged (default)
    refuse,       ///< throw core::InputError
    extrapolate,  ///< go on with the end slope, with growing error, flagged
};

struct Evaluation {
    double value = 0;
    double sigma = 0;                          ///< one standard deviation; 0 when the table has none
    std::array<double, max_axes> slope{};      ///< d value / d axis, SI
    std::array<double, max_axes> beyond{};     ///< how far outside each axis, SI, signed; 0 inside
    bool outside = false;
};

struct FitOptions {
    enum class Kind {
        automatic,         ///< the better of the two below by leave-one-out score, said in remarks()
        interpolation,     ///< monotone: exact at the points, C1, never leaves the range of the points around it; full grids only
        gaussian_process,  ///< scattered or gridded points with errors
        spline,            ///< not-a-knot cubic spline: exact, C2, may overshoot; full grids only
    } kind = Kind::automatic;
    RangePolicy range = RangePolicy::clamp;
    std::vector<std::string> axes;  ///< columns to use as axes; empty: every known set-point column that varies
};

/// A fitted surrogate of one quantity. Immutable, cheap to copy, safe to use from many threads.
class ForceTable {
public:
    /// Fits the column `quantity` (SI; its errors from `quantity`_sigma when present).
    /// Throws core::InputError with line and column: unknown quantity, one row, duplicate set points that disagree,
    /// points on a line in two axes, non-positive sigma, ...
    static ForceTable fit(const core::Table& table, const std::string& quantity, const FitOptions& options = {});
    static ForceTable read(const std::filesystem::path& path, const std::string& quantity, const FitOptions& options = {});

    [[nodiscard]] const std::string& quantity() const;
    [[nodiscard]] const std::string& unit() const;
    [[nodiscard]] const std::vector<TableAxis>& axes() const;
    [[nodiscard]] const std::string& kind() const;    ///< "monotone cubic", "bicubic", "gaussian process", ...
    [[nodiscard]] const std::string& source() const;  ///< the file it came from
    /// Remarks of the fit for the user: choices made, kinks, duplicates merged.
    [[nodiscard]] const core::Problems& remarks() const;
    /// The points it was fitted to (SI).
    [[nodiscard]] const core::Table& points() const;

    /// `point` in SI, one value per axis, in the order of axes().
    [[nodiscard]] Evaluation at(std::span<const double> point) const;
    /// The hot path: clamped value and slopes (`slope` has one entry per axis), no error, no allocation, never throws.
    [[nodiscard]] double value(const double* point, double* slope = nullptr) const noexcept;

    /// One standard deviation at a point; grows beyond the range whatever the policy. Never throws.
    [[nodiscard]] double sigma(const double* point) const noexcept;
    /// Grid lines of the piecewise cubic that value() evaluates along an axis: between two of them it is one cubic. For
    /// interpolated tables these are the axis's points.
    [[nodiscard]] const std::vector<double>& knots(std::size_t axis) const;
    /// Columns of the points that held one value throughout (name, SI value): the conditions the table was made under.
    [[nodiscard]] const std::vector<std::pair<std::string, double>>& conditions() const;
    [[nodiscard]] RangePolicy range() const;

    /// Another table whose values are drawn from this one's error (correlated along the axes), for probability maps.
    [[nodiscard]] ForceTable drawn(std::uint64_t seed) const;

    struct Impl;
    explicit ForceTable(std::shared_ptr<const Impl> impl);
    [[nodiscard]] const Impl& impl() const { return *impl_; }

private:
    std::shared_ptr<const Impl> impl_;
};

}  // namespace underbody::tables
