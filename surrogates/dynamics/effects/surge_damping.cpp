// X = -coefficient u
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& surge_damping_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"surge_damping",
                            "drag along the body beside the declared",
                            "X = -coefficient u",
                            SeenIn::time_series,
                            {"speed"},
                            {{"coefficient", "N s/m", -1000, 1000, 0.05, 0, false, "positive slows"}},
                            "definition"},
                 {.adds_to = "drag.surge", .kin = {"surge"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.surge += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
