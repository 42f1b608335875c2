// reading = h + bias
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& gap_sensor_bias_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"gap_sensor_bias",
                            "bias of the gap sensor",
                            "reading = h + bias",
                            SeenIn::time_series,
                            {"gap"},
                            {{"bias", "m", -1, 1, 0.002, 0, false, "reading too large when positive"}},
                            "definition"},
                 {.kin = {"place"}}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.sensor_bias += use.values[0];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
