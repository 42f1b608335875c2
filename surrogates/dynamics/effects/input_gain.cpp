// u = gain u_recorded
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& input_gain_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"input_gain",
                            "gain of the actuator",
                            "u = gain u_recorded",
                            SeenIn::time_series,
                            {"input_force"},
                            {{"gain", "1", -5, 10, 0.2, 1, false, "one is a healthy actuator"}},
                            "definition"},
                 {.kin = {"input"}}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.actuator.gain *= use.values[0];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
