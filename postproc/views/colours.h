// Colour maps and round numbers for scales.
#pragma once

#include <array>
#include <vector>

#include "postproc/views/views.h"

namespace underbody::postproc {

/// Colour (0..1 each) at a share 0..1 of a map.
std::array<double, 3> colour_at(ColourMap map, double share);

/// Round numbers (1, 2, 5 times a power of ten) within [low, high], about `count` of them.
std::vector<double> round_ticks(double low, double high, int count);

/// The longest round number not above `value`.
double round_below(double value);

/// Range as drawn: symmetric about zero for diverging maps, widened when it is empty.
std::pair<double, double> drawn_range(std::pair<double, double> range, ColourMap map);

}  // namespace underbody::postproc
