// reading = force + rate time
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"

namespace underbody::dynamics {

const Effect& drift_effect() {
    static const LawEffect effect{
        searched(of_the_rig({"drift",
                             "drift of the load cell",
                             "reading = force + rate time",
                             SeenIn::static_set,
                             {"time"},
                             {{"rate", "N/s", -10, 10, 1e-06, 0, false, "growth of the reading"}},
                             "definition",
                             true}),
                 {.needs = {"time"}}),
        {.after = [](const std::string& quantity, double value, const StaticPoint& /*seen*/,
                     const Conditions& set_point, const EffectUse& use) {
            return concerns(use, quantity) ? value + use.values[0] * set_point.get(Channel::time, 0) : value;
        }}};
    return effect;
}

}  // namespace underbody::dynamics
