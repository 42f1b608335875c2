// reading = pitch + bias
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& pitch_sensor_bias_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"pitch_sensor_bias",
                            "bias of the pitch sensor",
                            "reading = pitch + bias",
                            SeenIn::time_series,
                            {},
                            {{"bias", "rad", -1, 1, 0.005, 0, false, "reading too large when positive"}},
                            "definition"},
                 {.kin = {"trim"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.pitches; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.pitch.sensor_bias += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
