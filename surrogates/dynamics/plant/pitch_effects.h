// Motions that have no effects on the pitch.
#pragma once

#include <string>

#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

/// Throws core::InputError where an effect of the model acts on the pitch, of which this motion ("the motion of the
/// whole body") knows nothing: it would be left out in silence.
void refuse_pitch_effects(const Model& model, const HeaveTerms& terms, const std::string& motion);

}  // namespace underbody::dynamics
