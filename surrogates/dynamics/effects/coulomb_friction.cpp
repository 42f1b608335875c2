// F = -force w/sqrt(w^2 + (0.1 mm/s)^2)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& coulomb_friction_effect() {
    static const LawEffect effect{
        searched(
            EffectInfo{"coulomb_friction",
                       "Coulomb friction",
                       "F = -force w/sqrt(w^2 + (0.1 mm/s)^2)",
                       SeenIn::time_series,
                       {"heave_velocity"},
                       {{"force", "N", 0, 100, 0.01, 0, false, "against the motion"}},
                       "Coulomb; the step smoothed over 0.1 mm/s"},
            {.kin = {"damping"}, .one_sign = true, .other_form = [](HeaveTerms& terms) { terms.friction_width *= 5; }}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.friction += use.values[0];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
