// Where a table has data: a yes or no for every cell of a coarse grid of its own, so that a controller can ask it too.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace underbody::tables {

/// Cells between ascending lines along one to four axes. A cell has data where a part of it lies among the points of
/// the table; only cells wholly without are marked, so that no point of the table itself ever counts as one without
/// data. Empty: data everywhere.
class Support {
public:
    Support() = default;
    /// One entry a cell, last axis fastest; at least two lines an axis.
    Support(std::vector<std::vector<double>> lines, std::vector<std::uint8_t> has_data);
    /// `has_data` is asked with the lower and the upper corner of every cell.
    Support(std::vector<std::vector<double>> lines, const std::function<bool(const double*, const double*)>& has_data);

    [[nodiscard]] bool empty() const { return has_data_.empty(); }
    /// Beyond the lines the nearest cell decides. Never throws; a NaN has no data.
    [[nodiscard]] bool no_data(const double* point) const noexcept;
    [[nodiscard]] const std::vector<std::vector<double>>& lines() const { return lines_; }
    [[nodiscard]] const std::vector<std::uint8_t>& has_data() const { return has_data_; }
    /// The axes whose bit is set turned round (x -> -x).
    [[nodiscard]] Support mirrored(unsigned axes) const;
    /// There is data where both have it. The same axes.
    [[nodiscard]] Support both(const Support& other) const;

private:
    std::vector<std::vector<double>> lines_;
    std::vector<std::uint8_t> has_data_;
};

}  // namespace underbody::tables
