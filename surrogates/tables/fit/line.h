// A table along one of its axes, the others held: piecewise cubic, with exact integrals and all its zeros.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "surrogates/tables/fit/force_table.h"

namespace underbody::tables {

/// Values of the axes that are held, by name, SI.
using Held = std::vector<std::pair<std::string, double>>;

/// Index of the axis by name; throws core::UsageError with the nearest name.
std::size_t axis_index(const ForceTable& table, const std::string& name);

/// A point of the table with the held values filled in. The entry of `free_axis` is the middle of its range.
/// An axis that is not held takes 0 when it is a pitch and 0 lies in its range (the choice is added to `remarks`);
/// else throws core::UsageError that names it. Names that are no axis throw, unless they are conditions of the table
/// with that value; so does the free axis.
std::vector<double> held_point(const ForceTable& table, std::optional<std::size_t> free_axis, const Held& held,
                               core::Problems* remarks = nullptr);

/// C1 piecewise cubic in one variable.
class Line {
public:
    /// The table along an axis. Between the grid lines of the table it is one cubic, so nothing is lost. Held values
    /// outside their axes follow the axes' policies; throws core::InputError where one refuses.
    Line(const ForceTable& table, std::size_t axis, std::vector<double> point);
    /// Hermite data; at least two ascending points.
    Line(std::vector<double> x, std::vector<double> value, std::vector<double> slope);

    [[nodiscard]] double lower() const { return x_.front(); }
    [[nodiscard]] double upper() const { return x_.back(); }
    [[nodiscard]] const std::vector<double>& points() const { return x_; }

    /// Held at the ends.
    [[nodiscard]] double value(double x, double* slope = nullptr) const noexcept;
    /// Integral from lower() to x, x inside the range; exact.
    [[nodiscard]] double integral(double x) const noexcept;
    /// scale * this + shift.
    [[nodiscard]] Line scaled(double scale, double shift) const;

    struct Zero {
        double x = 0;
        double slope = 0;
        int before = 0;     ///< sign of the value just below (0 at the lower end of the range)
        int after = 0;      ///< sign just above (0 at the upper end)
        double extent = 0;  ///< > 0: the value is zero from x - extent/2 to x + extent/2
    };
    /// All of them, ascending, to rounding; touching ones (before == after) too.
    [[nodiscard]] std::vector<Zero> zeros() const;
    struct Extreme {
        double x = 0, value = 0;
        bool highest = false;  ///< else lowest
    };
    /// Inside the range, ascending: where the slope changes its sign.
    [[nodiscard]] std::vector<Extreme> extremes() const;
    /// Largest size of the value at the points: what rounding is measured by.
    [[nodiscard]] double size() const;

private:
    void prepare();
    [[nodiscard]] std::size_t cell(double x) const noexcept;
    std::vector<double> x_, value_, slope_, integral_;
};

}  // namespace underbody::tables
