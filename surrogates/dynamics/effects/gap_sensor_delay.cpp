// reading(t) = h(t - delay)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& gap_sensor_delay_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"gap_sensor_delay",
                            "delay of the gap sensor",
                            "reading(t) = h(t - delay)",
                            SeenIn::time_series,
                            {"gap", "time"},
                            {{"delay", "s", 0, 30, 0.1, 0, false, "the reading comes later than the gap"}},
                            "definition"},
                 {.kin = {"input"}}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.time_series) {
                     parameters.front().upper = std::min(parameters.front().upper, 0.5);  // later is no reading
                 }
                 return true;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.sensor_delay += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
