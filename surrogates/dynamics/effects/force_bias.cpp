// reading = force + bias
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"

namespace underbody::dynamics {

const Effect& force_bias_effect() {
    static const LawEffect effect{
        of_the_rig({"force_bias",
                    "bias of the load cell",
                    "reading = force + bias",
                    SeenIn::static_set,
                    {},
                    {{"bias", "N", -1000.0, 1000.0, 0.01, 0, false, "reading too large when positive"}},
                    "definition",
                    true}),
        {.after = [](const std::string& quantity, double value, const StaticPoint& /*seen*/,
                     const Conditions& /*set_point*/,
                     const EffectUse& use) { return concerns(use, quantity) ? value + use.values[0] : value; }}};
    return effect;
}

}  // namespace underbody::dynamics
