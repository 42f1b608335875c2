// N = moment
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& yaw_moment_offset_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"yaw_moment_offset",
                            "constant yaw moment",
                            "N = moment",
                            SeenIn::time_series,
                            {},
                            {{"moment", "N m", -1000, 1000, 0.002, 0, false, "bow to starboard"}},
                            "definition"},
                 {.kin = {"turning"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.moment += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
