// u = sgn(u_recorded) max(0, |u_recorded| - width)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& input_dead_zone_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"input_dead_zone",
                            "dead zone of the actuator",
                            "u = sgn(u_recorded) max(0, |u_recorded| - width)",
                            SeenIn::time_series,
                            {"input_force"},
                            {{"width", "N", 0, 100, 0.01, 0, false, "half width of the dead zone"}},
                            "definition"},
                 {.kin = {"input"}}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.actuator.dead_zone += use.values[0];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
