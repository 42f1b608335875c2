// A declared value is off: Model::resolved() carries it out before anything is compiled.
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"

namespace underbody::dynamics {

const Effect& declared_parameter_effect() {
    static const LawEffect effect{searched(EffectInfo{"declared_parameter",
                                                      "a declared value is off",
                                                      "the declared value of `parameter` is replaced by `value`",
                                                      SeenIn::both,
                                                      {},
                                                      {{"value", "parameter", -1000000000000.0, 1000000000000.0, 1, 0,
                                                        false, "the corrected value, in the unit of the parameter"}},
                                                      "definition",
                                                      false,
                                                      false,
                                                      true},
                                           {.kin = {"place"}}),
                                  {}};
    return effect;
}

}  // namespace underbody::dynamics
