// N = -coefficient r
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& yaw_damping_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"yaw_damping",
                            "drag of the turning body beside the declared",
                            "N = -coefficient r",
                            SeenIn::time_series,
                            {"yaw_rate"},
                            {{"coefficient", "N m s", -1000, 1000, 0.002, 0, false, "positive slows"}},
                            "definition"},
                 {.adds_to = "drag.yaw", .kin = {"turning"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.yaw += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
