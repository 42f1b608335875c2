// F = amplitude sin(2 pi frequency t + phase)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& periodic_disturbance_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"periodic_disturbance",
                            "periodic disturbance",
                            "F = amplitude sin(2 pi frequency t + phase)",
                            SeenIn::time_series,
                            {"time"},
                            {{"amplitude", "N", 0, 100, 0.01, 0, false, "of the force"},
                             {"frequency", "1/s", 0.001, 100, 0.5, 0.5, false, "cycles per second"},
                             {"phase", "rad", -6.3, 6.3, 1, 0, false, "at time zero of the record"}},
                            "definition"},
                 {.prior = 0.01, .scanned = true}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.waves.push_back({use.values[0], use.values[1], use.values[2]});
        }}};
    return effect;
}

}  // namespace underbody::dynamics
