// time_constant du/dt = u_recorded - u
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& actuator_lag_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"actuator_lag",
                            "first-order lag of the actuator",
                            "time_constant du/dt = u_recorded - u",
                            SeenIn::time_series,
                            {"input_force", "time"},
                            {{"time_constant", "s", 0, 60, 0.3, 0, false, "63 % of a step are there after it"}},
                            "definition"},
                 {.kin = {"input"}}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.time_series) {
                     parameters.front().upper = std::min(parameters.front().upper, 5.0);  // later is no reading
                 }
                 return true;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.actuator.lag += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
