// u(t) = u_recorded(t - delay)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& input_delay_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"input_delay",
                            "delay of the actuator",
                            "u(t) = u_recorded(t - delay)",
                            SeenIn::time_series,
                            {"input_force", "time"},
                            {{"delay", "s", 0, 30, 0.2, 0, false, "the force comes later than recorded"}},
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
                      const Model& /*model*/) { terms.actuator.delay += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
