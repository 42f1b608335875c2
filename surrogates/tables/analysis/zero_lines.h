// Where a function of two variables is zero. For the files of this room only.
#pragma once

#include <functional>
#include <vector>

#include "core/progress.h"

namespace underbody::tables {

using PlaneFunction = std::function<double(double x, double y)>;

struct ZeroPoint {
    double x = 0, y = 0;
};
/// Connected points, in order along the line.
using ZeroLine = std::vector<ZeroPoint>;

/// All lines by marching squares on the grid of `x` and `y` (ascending, two and more each); their points lie on its
/// edges, and are roots there to rounding.
std::vector<ZeroLine> zero_lines(const PlaneFunction& f, const std::vector<double>& x, const std::vector<double>& y,
                                 core::Progress& progress = core::Progress::none());

}  // namespace underbody::tables
