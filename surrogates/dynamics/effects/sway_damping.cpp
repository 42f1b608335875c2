// Y = -coefficient v
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& sway_damping_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"sway_damping",
                            "drag across the body beside the declared",
                            "Y = -coefficient v",
                            SeenIn::time_series,
                            {"sway_velocity"},
                            {{"coefficient", "N s/m", -1000, 1000, 0.1, 0, false, "positive slows"}},
                            "definition"},
                 {.adds_to = "drag.sway", .kin = {"turning"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.sway += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
