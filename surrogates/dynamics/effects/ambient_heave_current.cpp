// drag acts on w - velocity
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& ambient_heave_current_effect() {
    static const LawEffect effect{searched(EffectInfo{"ambient_heave_current",
                                                      "water that moves in heave",
                                                      "drag acts on w - velocity",
                                                      SeenIn::time_series,
                                                      {"heave_velocity"},
                                                      {{"velocity", "m/s", -5, 5, 0.01, 0, false, "of the water, up"}},
                                                      "definition"},
                                           {.kin = {"damping"}}),
                                  {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                                      terms.current += use.values[0];
                                  }}};
    return effect;
}

}  // namespace underbody::dynamics
