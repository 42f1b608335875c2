// reading = force + friction approach_direction
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"

namespace underbody::dynamics {

const Effect& guide_friction_effect() {
    static const LawEffect effect{
        searched(of_the_rig({"guide_friction",
                             "friction of the guide",
                             "reading = force + friction approach_direction",
                             SeenIn::static_set,
                             {"approach_direction"},
                             {{"friction", "N", -100, 100, 0.01, 0, false,
                               "sign follows the direction of approach (hysteresis of the slide)"}},
                             "Coulomb",
                             true}),
                 {.needs = {"approach_direction"}}),
        {.after = [](const std::string& quantity, double value, const StaticPoint& /*seen*/,
                     const Conditions& set_point, const EffectUse& use) {
            return concerns(use, quantity) ? value + use.values[0] * set_point.get(Channel::approach_direction, 0)
                                           : value;
        }}};
    return effect;
}

}  // namespace underbody::dynamics
