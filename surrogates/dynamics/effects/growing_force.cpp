// F = +force + rate t
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& growing_force_effect() {
    static const LawEffect effect{
        searched(
            EffectInfo{"growing_force",
                       "force that grows in time",
                       "F = +force + rate t",
                       SeenIn::time_series,
                       {"time"},
                       {{"rate", "N/s", -10, 10, 1e-4, 0, false, "growth of the force, up; t on the record's clock"},
                        {"force", "N", -100, 100, 0.01, 0, false, "up, at time zero of the record"}},
                       "definition"},
            {.starts = {{1e-4, 0}, {-1e-4, 0}}, .kin = {"place"}}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.constant += use.values[1];
            terms.growth_of_force += use.values[0];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
