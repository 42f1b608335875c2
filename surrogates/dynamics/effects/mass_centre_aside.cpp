// N = offset X, X all forces along the body
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& mass_centre_aside_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"mass_centre_aside",
                            "centre of gravity beside the declared one",
                            "N = offset X, X all forces along the body",
                            SeenIn::time_series,
                            {"speed"},
                            {{"offset", "m", -1, 1, 0.002, 0, false, "to starboard"}},
                            "rigid body: moment of a force about the centre of gravity"},
                 {.kin = {"turning"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.mass_aside += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
