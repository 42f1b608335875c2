// What an FMU has no code for.
#pragma once

#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

/// Throws core::InputError where an effect of the model acts on the pitch or, of the whole body, along and across it:
/// an FMU knows nothing of these, and would leave them out in silence.
void refuse_pitch_effects(const Model& model, const HeaveTerms& terms, bool whole_body);

}  // namespace underbody::dynamics
