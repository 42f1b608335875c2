// F = -coefficient w/h^3
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& squeeze_film_damping_effect() {
    static const LawEffect effect{searched(EffectInfo{"squeeze_film_damping",
                                                      "squeeze film between base and ground",
                                                      "F = -coefficient w/h^3",
                                                      SeenIn::time_series,
                                                      {"gap", "heave_velocity"},
                                                      {{"coefficient", "N s m^2", 0, 0.01, 1e-06, 0, false,
                                                        "12 mu pi a^3 b^3/(4 (a^2 + b^2)) for a flat ellipse"}},
                                                      "Reynolds 1886; Stefan 1874 (circle: 3 pi mu R^4/2)"},
                                           {.adds_to = "drag.heave", .kin = {"damping"}, .one_sign = true}),
                                  {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                                      terms.film += use.values[0];
                                  }}};
    return effect;
}

}  // namespace underbody::dynamics
