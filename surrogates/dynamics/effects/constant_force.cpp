// F = +force
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& constant_force_effect() {
    static const LawEffect effect{searched(EffectInfo{"constant_force",
                                                      "constant force (trim)",
                                                      "F = +force",
                                                      SeenIn::time_series,
                                                      {},
                                                      {{"force", "N", -100, 100, 0.01, 0, false, "up"}},
                                                      "definition"},
                                           {.kin = {"place"}}),
                                  {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                                      terms.constant += use.values[0];
                                  }}};
    return effect;
}

}  // namespace underbody::dynamics
