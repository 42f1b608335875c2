// The jets of a model as its effects have them act.
#pragma once

#include <vector>

#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/surface_terms.h"

namespace underbody::dynamics {

/// Turned about the vertical by jet_angle, and with thrust_gain in their directions.
std::vector<Jet> acting_jets(std::vector<Jet> jets, const SurfaceTerms& effects);

}  // namespace underbody::dynamics
