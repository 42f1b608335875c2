// reading = h + bias + rate t
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& gap_sensor_drift_effect() {
    static const LawEffect effect{
        searched(
            EffectInfo{"gap_sensor_drift",
                       "drift of the gap sensor",
                       "reading = h + bias + rate t",
                       SeenIn::time_series,
                       {"time"},
                       {{"rate", "m/s", -0.1, 0.1, 1e-5, 0, false, "growth of the reading; t on the record's clock"},
                        {"bias", "m", -1, 1, 0.002, 0, false, "at time zero of the record"}},
                       "definition"},
            {.starts = {{1e-5, 0}, {-1e-5, 0}}, .kin = {"place"}}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.sensor_drift += use.values[0];
            terms.sensor_bias += use.values[1];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
