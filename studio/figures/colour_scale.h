// The two colour scales of every value map and of the 3D views.
#pragma once

#include "core/figure.h"

namespace underbody::studio {

/// Viridis (van der Walt and Smith 2015): even steps to the eye, readable in grey and with any colour vision. t in [0,
/// 1].
core::Colour viridis(double t);

/// Blue over near-white to red (ColorBrewer RdBu, reversed): for values around zero. t in [0, 1], 0.5 is zero.
core::Colour diverging(double t);

}  // namespace underbody::studio
