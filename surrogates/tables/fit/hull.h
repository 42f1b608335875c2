// How far a place is from where scattered points are: the distance from their convex hull. For the files of this room
// only.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "surrogates/tables/fit/support.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

/// Convex hull of points in one to four axes. Coordinates count in shares of each axis's range; a gap that spans a
/// factor of four or more counts by its logarithm.
class Hull {
public:
    Hull(const std::vector<TableAxis>& axes, const std::vector<std::vector<double>>& points);

    /// 0 inside, to rounding. Coordinates beyond an axis count as its end. (Wolfe 1976, Finding the nearest point in a
    /// polytope.)
    [[nodiscard]] double distance(const double* point) const { return distance(point, point); }
    /// Of a box with these corners: 0 where a part of it lies inside.
    [[nodiscard]] double distance(const double* low, const double* high) const;
    /// The cells of a coarse grid that have a part of the hull in them; made when it is first asked for.
    [[nodiscard]] const Support& support() const;
    /// The points that it was made of, SI.
    [[nodiscard]] const std::vector<std::vector<double>>& points() const { return made_of_; }

private:
    [[nodiscard]] double coordinate(std::size_t axis, double x) const;
    std::vector<TableAxis> axes_;
    std::vector<std::vector<double>> made_of_;
    std::vector<double> points_;  ///< [point * axes]
    struct Made {
        std::once_flag once;
        Support support;
    };
    std::shared_ptr<Made> made_ = std::make_shared<Made>();
};

}  // namespace underbody::tables
