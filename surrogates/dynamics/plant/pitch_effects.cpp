#include "surrogates/dynamics/plant/pitch_effects.h"

#include "core/text.h"

namespace underbody::dynamics {

namespace {

bool acts(const PitchTerms& t) {
    return t.moment != 0 || t.linear != 0 || t.quadratic != 0 || t.stiffness != 0 || t.inertia != 0 ||
           t.input_arm != 0 || t.mass_forward != 0 || t.spring != 0;
}

}  // namespace

void refuse_pitch_effects(const Model& model, const HeaveTerms& terms, const std::string& motion) {
    if (!acts(terms.pitch)) {
        return;
    }
    std::string names;
    for (const EffectUse& use : model.effects) {
        HeaveTerms own;
        effect(use.name).add_to(own, use, model);
        names += acts(own.pitch) ? (names.empty() ? "" : ", ") + use.name : "";
    }
    throw core::InputError("motion", names + ": acts in heave with pitch, not in " + motion, {model.name, {}, {}, {}},
                           "leave it out of the model, or take heave with pitch");
}

}  // namespace underbody::dynamics
