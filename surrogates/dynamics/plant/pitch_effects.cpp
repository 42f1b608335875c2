#include "surrogates/dynamics/plant/pitch_effects.h"

namespace underbody::dynamics {

namespace {

bool acts(const HeaveTerms& terms, bool whole_body) {
    const PitchTerms& t = terms.pitch;
    return (whole_body && !(terms.surface == SurfaceTerms{})) || t.moment != 0 || t.linear != 0 || t.quadratic != 0 ||
           t.stiffness != 0 || t.inertia != 0 || t.input_arm != 0 || t.moment_gain != 1 || t.mass_forward != 0 ||
           t.spring != 0;
}

}  // namespace

void refuse_pitch_effects(const Model& model, const HeaveTerms& terms, bool whole_body) {
    if (!acts(terms, whole_body)) {
        return;
    }
    std::string names;
    for (const EffectUse& use : model.effects) {
        HeaveTerms own;
        effect(use.name).add_to(own, use, model);
        names += acts(own, whole_body) ? (names.empty() ? "" : ", ") + use.name : "";
    }
    throw core::InputError("motion", names + ": an FMU knows nothing of it", {model.name, {}, {}, {}},
                           "leave it out of the model; simulate and predict take it");
}

}  // namespace underbody::dynamics
