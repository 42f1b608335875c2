// reading = gain force
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"

namespace underbody::dynamics {

const Effect& sensor_gain_effect() {
    static const LawEffect effect{searched(of_the_rig({"sensor_gain",
                                                       "scale of the load cell",
                                                       "reading = gain force",
                                                       SeenIn::static_set,
                                                       {"lift_force"},
                                                       {{"gain", "1", -5, 10, 0.05, 1, false, "one is a right scale"}},
                                                       "definition",
                                                       true}),
                                           {.scales_reading = true}),
                                  {.after = [](const std::string& quantity, double value, const StaticPoint& /*seen*/,
                                               const Conditions& /*set_point*/, const EffectUse& use) {
                                      return concerns(use, quantity) ? value * use.values[0] : value;
                                  }}};
    return effect;
}

}  // namespace underbody::dynamics
