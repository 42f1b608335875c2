// What the axes of a figure show. Only for draw.cpp.
#pragma once

#include "core/figure.h"

namespace underbody::studio {

struct AxisRange {
    double lower = 0;
    double upper = 1;
};

/// The figure's own range, or one that fits everything drawn, with a margin unless a map fills the box. Never empty,
/// positive on a logarithmic axis.
AxisRange x_range(const core::Figure& figure);
AxisRange y_range(const core::Figure& figure);

/// The colour range of a map: its own or from its data, symmetric about zero when diverging; never empty.
AxisRange colour_range(const core::FigureMap& map);

/// The names along the x axis of a bar chart, in order of their first appearance.
std::vector<std::string> bar_labels(const core::Figure& figure);

}  // namespace underbody::studio
