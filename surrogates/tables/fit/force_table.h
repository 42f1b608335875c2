// Force against gap, pitch, speed, jet: a table that knows its range and its error.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"
#include "surrogates/tables/points/table_axis.h"

namespace underbody::tables {

struct Evaluation {
    double value = 0;
    double sigma = 0;                       ///< one standard deviation; 0 when the table has none
    std::array<double, max_axes> slope{};   ///< d value / d axis, SI
    std::array<double, max_axes> beyond{};  ///< how far outside each axis, SI, signed; 0 inside
    bool outside = false;
    /// No points lie around: outside, or in a corner of the axes' box that has none (see Support). The value is an
    /// extrapolation, its error a guess.
    bool no_data = false;
};

struct FitOptions : AxisOptions {
    enum class Kind {
        automatic,  ///< full grids interpolated, unless points with errors scatter and a process meets left-out ones
                    ///< better; said in remarks()
        interpolation,     ///< monotone: exact at the points, C1, never leaves the range of the points around it; full
                           ///< grids only
        gaussian_process,  ///< scattered or gridded points with errors
        spline,            ///< not-a-knot cubic spline: exact, C2, may overshoot; full grids only
    } kind = Kind::automatic;
};

/// How a table is fitted, by its word: "automatic" ("auto"), "interpolation", "gaussian_process" ("gp"), "spline"; the
/// words in brackets are older ones. The way back gives nothing for any other word.
std::string to_string(FitOptions::Kind kind);
std::optional<FitOptions::Kind> fit_kind(const std::string& word);
/// The words without the older ones.
const std::vector<std::string>& fit_kinds();

/// A fitted surrogate of one quantity. Immutable, cheap to copy, safe to use from many threads.
class ForceTable {
public:
    /// Fits the column `quantity` (SI; its errors from `quantity`_sigma when present).
    /// Throws core::InputError with line and column: unknown quantity, one row, duplicate set points that disagree,
    /// points on a line in two axes, non-positive sigma, ...
    static ForceTable fit(const core::Table& table, const std::string& quantity, const FitOptions& options = {});
    static ForceTable read(const std::filesystem::path& path, const std::string& quantity,
                           const FitOptions& options = {});
    /// A table that this program exported as CSV or JSON, as it was: not fitted again, whatever the kind. Nothing when
    /// it is none, or one of another quantity. Throws core::InputError when rows or numbers of it are missing.
    static std::optional<ForceTable> exported(const core::Table& table, const std::string& quantity,
                                              const FitOptions& options = {});

    [[nodiscard]] const std::string& quantity() const;
    [[nodiscard]] const std::string& unit() const;
    [[nodiscard]] const std::vector<TableAxis>& axes() const;
    [[nodiscard]] const std::string& kind()
        const;  ///< "monotone cubic, two axes", "Gaussian process", "exported grid", ...
    [[nodiscard]] const std::string& source() const;  ///< the file it came from
    /// Remarks of the fit for the user: choices made, kinks, duplicates merged.
    [[nodiscard]] const core::Problems& remarks() const;
    /// The points it was fitted to (SI).
    [[nodiscard]] const core::Table& points() const;

    /// `point` in SI, one value per axis, in the order of axes(). Outside an axis its policy (axes()[k].range) decides:
    /// refused points throw core::InputError that names the axis and its range; beyond extrapolated axes the function
    /// goes on along its tangent there (C1, and linear in each of these coordinates), so that the slopes are those of
    /// the value everywhere.
    [[nodiscard]] Evaluation at(std::span<const double> point) const;
    /// The hot path: value and slopes (`slope` has one entry per axis) held at the ends of all axes whatever their
    /// policies, no error, no allocation, never throws.
    [[nodiscard]] double value(const double* point, double* slope = nullptr) const noexcept;

    /// value() by the policies of the axes, as at() has it; throws as at() does where an axis refuses. Axes whose bit
    /// is set in `free` (those that a search moves along) are held at their ends. NaN in, NaN out.
    double value_by_policy(const double* point, double* slope = nullptr, unsigned free = 0) const;

    /// One standard deviation at a point; grows beyond the range whatever the policy. Never throws.
    [[nodiscard]] double sigma(const double* point) const noexcept;
    /// Grid lines of the piecewise cubic that value() evaluates along an axis: between two of them it is one cubic. For
    /// interpolated tables these are the axis's points.
    [[nodiscard]] const std::vector<double>& knots(std::size_t axis) const;
    /// Is value() the monotone interpolation of its values at the grid lines, so that a fit through these alone gives
    /// it back?
    [[nodiscard]] bool is_monotone_interpolation() const;
    /// Columns of the points that held one value throughout (name, SI value): the conditions the table was made under.
    [[nodiscard]] const std::vector<std::pair<std::string, double>>& conditions() const;

    /// Of a table that stands for a function known elsewhere (the forces of a model): its largest difference from that
    /// function, in unit(). 0 for others.
    [[nodiscard]] double sampling_error() const;
    /// Of points that state no errors: what they scatter by about the fit, on average, in unit(), where that is taken
    /// as their error. 0 where none is.
    [[nodiscard]] double point_scatter() const;

    /// Another table whose values are drawn from this one's error (correlated along the axes), for probability maps.
    [[nodiscard]] ForceTable drawn(std::uint64_t seed) const;

    struct Impl;
    explicit ForceTable(std::shared_ptr<const Impl> impl);
    [[nodiscard]] const Impl& impl() const { return *impl_; }

private:
    std::shared_ptr<const Impl> impl_;
};

}  // namespace underbody::tables
