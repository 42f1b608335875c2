// Drag laws as resistance: the sign of the velocity, subtracted from the equation of motion.
#pragma once

#include "surrogates/dynamics/model/mixed_drag.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// F(w), and its slope dF/dw when asked for.
double drag(const DragLaw& law, const Environment& environment, double w, double* slope = nullptr);

/// Equivalent linear damping of D w|w|: factor times D times w_rms.
inline constexpr double gaussian_drag_factor = 1.5957691216057308;  ///< sqrt(8/pi), w Gaussian
inline constexpr double harmonic_drag_factor = 1.2004217548761574;  ///< 8 sqrt(2)/(3 pi), w sinusoidal
/// The same for a sinusoid against its amplitude: 8/(3 pi).
inline constexpr double harmonic_drag_factor_of_amplitude = 0.8488263631567752;

}  // namespace underbody::dynamics
