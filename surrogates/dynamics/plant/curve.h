// A force against the gap as piecewise cubics, for a tight loop.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surrogates/tables/fit/force_table.h"

namespace underbody::dynamics {

/// A piecewise cubic (C1) of the gap with an index for constant-time look-up. Holds its end value outside its knots.
/// A table with one axis becomes its own cubic pieces exactly; others are refined to 1e-10 of their range.
class Curve {
public:
    Curve() = default;
    /// Hermite data: ascending x (at least two), values and slopes.
    Curve(std::vector<double> x, std::vector<double> value, std::vector<double> slope);
    /// The table along `axis` with the other axes held at `held` (one entry per axis; the entry of `axis` is ignored).
    static Curve along(const tables::ForceTable& table, std::size_t axis, std::span<const double> held);

    [[nodiscard]] bool empty() const { return x_.empty(); }
    [[nodiscard]] double lower() const { return x_.front(); }
    [[nodiscard]] double upper() const { return x_.back(); }
    [[nodiscard]] const std::vector<double>& knots() const { return x_; }

    /// The value, and its slope and integral (from lower()) when asked for. At its ends the slope is that of the
    /// inside, as ForceTable has it; beyond them it is 0.
    [[nodiscard]] double operator()(double x) const noexcept {
        if (x <= x_.front()) {
            return end_[0];
        }
        if (x >= x_.back()) {
            return end_[1];
        }
        const Piece& p = pieces_[piece(x)];
        const double d = x - p.x;
        return p.c0 + d * (p.c1 + d * (p.c2 + d * p.c3));
    }
    [[nodiscard]] double value(double x, double& slope) const noexcept;
    [[nodiscard]] double value(double x, double& slope, double& curvature) const noexcept;
    [[nodiscard]] double integral(double x) const noexcept;
    /// a * this + b * other on the union of the knots (beyond a curve's end its end value).
    [[nodiscard]] Curve plus(double a, const Curve& other, double b) const;
    [[nodiscard]] Curve times(double factor) const;
    /// Zeros inside the knots, ascending, to machine precision.
    [[nodiscard]] std::vector<double> zeros(double level = 0) const;

private:
    struct Piece {
        double x, c0, c1, c2, c3;
    };
    void build_index();
    [[nodiscard]] std::size_t piece(double x) const noexcept {
        auto bucket = static_cast<std::size_t>((x - x_.front()) * per_bucket_);
        bucket = bucket < first_.size() ? bucket : first_.size() - 1;
        std::size_t i = first_[bucket];
        while (i + 1 < pieces_.size() && x >= pieces_[i + 1].x) {
            ++i;
        }
        return i;
    }
    std::vector<double> x_, value_, slope_, integral_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> first_;
    double per_bucket_ = 0;
    double end_[2] = {0, 0};
};

}  // namespace underbody::dynamics
